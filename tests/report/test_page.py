import base64
import hashlib
import json
import re
import shutil
from dataclasses import replace
from html.parser import HTMLParser
from types import SimpleNamespace

import pytest

from pzt_ident.data.notation import listed
from pzt_ident.data.over_axes import together, weighed
from pzt_ident.model.parameter import NOTHING_BEYOND
from pzt_ident.model.registry import blocks
from pzt_ident.report.page import write_report
from pzt_ident.report.sentences import (
    findings,
    headline,
    next_step,
    over_noise,
    printed_reason,
    remaining_error,
    verdict,
)
from pzt_ident.run.misfit import compare
from pzt_ident.run.results import read_results
from run_folders import WEIRD, make_run

SECTIONS = [
    "staircase",
    "model",
    "parameters",
    "residuals",
    "convergence",
    "league",
    "intervals",
    "correlations",
    "noise",
    "records",
    "run",
    "words",
]


class Page(HTMLParser):
    """What a browser would see: tags with attributes, the text, and whatever it would load."""

    def __init__(self, text):
        super().__init__()
        self.tags, self.words, self.loads = [], [], []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.tags.append((tag, dict(attributes)))
        for key, value in attributes:
            if key in ("src", "srcset", "href", "xlink:href", "action", "data", "poster"):
                self.loads.append(value)
            self.loads += re.findall(r"url\(([^)]*)\)", value or "")

    def handle_data(self, data):
        self.words.append(data)

    @property
    def text(self):
        return " ".join("".join(self.words).split())


@pytest.fixture(scope="module")
def plain_page(plain):
    return Page(write_report(plain).read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def weird_page(weird):
    return Page(write_report(weird).read_text(encoding="utf-8"))


@pytest.mark.parametrize("name", ["plain_page", "weird_page"])
def test_nothing_is_loaded(name, request):
    page = request.getfixturevalue(name)
    assert page.loads
    assert all(re.match(r"#|data:image/png;base64,", reference) for reference in page.loads)
    assert not {"iframe", "link", "object", "embed", "img"} & {tag for tag, _ in page.tags}
    assert not [key for _, attributes in page.tags for key in attributes if key.startswith("on")]
    style = next(words for words in page.words if "color-scheme" in words)
    assert "@import" not in style and "url(" not in style


def test_only_the_scripts_of_the_package_may_run(weird, weird_page):
    text = (weird / "report.html").read_text(encoding="utf-8")
    found = re.findall(r"<script(?: type=.module.)?>(.*?)</script>", text, re.S)
    hashes = [base64.b64encode(hashlib.sha256(script.encode()).digest()).decode() for script in found]
    policy = re.search(r'Content-Security-Policy" content="([^"]*)"', text)[1]
    assert policy.startswith("default-src 'none'; ")
    assert policy.endswith("script-src " + " ".join(f"'sha256-{value}'" for value in hashes))
    assert "import " not in found[0].partition("\n")[0] and not re.search(r"^(import|export) ", found[0], re.M)


def test_a_script_cannot_be_ended_by_a_name(weird, weird_page):
    text = (weird / "report.html").read_text(encoding="utf-8")
    content = re.search(r'<script type="application/json" id="content">(.*?)</script>', text, re.S)[1]
    assert {record["name"] for record in json.loads(content)["records"]} == {WEIRD}


@pytest.mark.parametrize("name", ["plain_page", "weird_page"])
def test_every_section_is_there_and_every_link_leads_somewhere(name, request):
    page = request.getfixturevalue(name)
    assert [attributes["id"] for tag, attributes in page.tags if tag == "section"] == SECTIONS
    ids = [attributes["id"] for _, attributes in page.tags if "id" in attributes]
    assert len(ids) == len(set(ids))
    targets = {reference[1:] for reference in page.loads if reference.startswith("#")}
    targets |= {attributes["aria-labelledby"] for _, attributes in page.tags if "aria-labelledby" in attributes}
    assert targets <= set(ids)


def test_markup_in_names_is_text(weird_page):
    assert WEIRD in weird_page.text
    assert "worker killed by <signal> 9" in weird_page.text
    assert "# <script>alert(1)</script>" in weird_page.text


def test_parameters_that_are_not_found_are_named(plain_page):
    assert "The data do not determine lumped.mass and lumped.damping" in plain_page.text
    assert "bouc_wen.gamma is on its lower bound" in plain_page.text
    marked = [words for words in plain_page.words if words in ("not determined", "on its lower bound")]
    assert sorted(marked) == ["not determined", "not determined", "on its lower bound"]


@pytest.mark.parametrize(
    ("note", "said"), [(NOTHING_BEYOND, ", where the range ends"), ("", ": the best fit may lie outside")]
)
def test_a_bound_is_told_with_what_lies_beyond(plain, note, said):
    results = read_results(plain)
    results.best["parameters"]["bouc_wen.gamma"]["note"] = note
    assert f"bouc_wen.gamma is on its lower bound{said}." in findings(results)


def test_what_was_run_is_reported(plain, plain_page):
    result = json.loads((plain / "result.json").read_text())
    for record in result["records"]:
        assert record["sha256"] in plain_page.text
    for words in ("pzt-ident run job.yaml", "numpy 2.0.0", "3.12.1", "rest segments", result["created"]):
        assert words in plain_page.text


def test_verdict_on_unseen_records(plain):
    assert verdict(read_results(plain)).replace("\u00a0", " ") == (
        "The RMSE is 0.375 µm on the validation records, 7.7 times the noise floor of 0.049 µm."
    )


def test_verdict_without_validation_and_noise(weird):
    assert verdict(read_results(weird)).replace("\u00a0", " ") == (
        "The RMSE is 0.302 µm (x and y together) on the identification records, and there is no validation record; "
        "the noise floor is not known."
    )
    assert "1 run did not finish: rga-0." in findings(read_results(weird))


def test_verdict_of_two_axes_gives_the_range(tmp_path):
    results = read_results(make_run(tmp_path, axes=("x", "y"), samples=60))
    assert "7.7 to 7.9 times the noise floor" in verdict(results)


def test_verdict_of_two_axes_that_are_alike_gives_no_range():
    errors = [{"use": "validate", "rmse": {"x": 1.01, "y": 0.99}}, {"use": "identify", "rmse": {"x": 9.0, "y": 9.0}}]
    alike = SimpleNamespace(floors={"x": 1.0, "y": 1.0}, share_of_noise=0.1, records=errors)
    assert "depending on axis and record, 0.99 to 1.0 times" in over_noise(alike, "validate")
    errors[0]["rmse"]["y"] = 1.012
    assert over_noise(alike, "validate") == ", 1.0\u00a0times the noise floor on every axis in every record"


def test_failed_simulations_are_counted(plain):
    assert findings(read_results(plain))[-1].replace("\u202f", " ") == (
        "27 of 39 060 simulations failed and were scored as infinitely bad."
    )


def test_what_is_special_about_a_record_is_reported(plain):
    assert "Record multisine.csv: decimated by 4." in findings(read_results(plain))


@pytest.mark.parametrize(("names", "text"), [("a", "a"), ("ab", "a and b"), ("abc", "a, b and c")])
def test_names_are_listed(names, text):
    assert listed(names) == text


def test_a_job_of_20_000_samples_stays_small(long):
    compare(long, long)
    page = write_report(long)
    assert page.stat().st_size < 300_000
    assert 'id="misfit-shares-x-caption"' in page.read_text(encoding="utf-8")


def test_a_perfect_fit_of_fixed_parameters_is_drawn(plain, tmp_path):
    folder = shutil.copytree(plain, tmp_path / "perfect", ignore=shutil.ignore_patterns("figures", "tables"))
    perfect(folder)
    page = Page(write_report(folder).read_text(encoding="utf-8"))
    assert "No figure: the results for it are missing." in page.text
    assert "The RMSE is 0 µm " in page.text.replace("\u00a0", " ")
    assert sorted(path.name for path in folder.iterdir() if path.name.startswith(".")) == []


def perfect(folder):
    import h5py

    with h5py.File(folder / "signals.nc", "a") as file:
        for group in file.values():
            group["model_x"][...] = group["response_x"][...]
            group["residual_x"][...] = 0.0
    result = json.loads((folder / "result.json").read_text())
    result["noise_floor"] = {"x": 0.0}
    for run in [*result["runs"], result["best"]]:
        run["rmse"] = {"identify": 0.0, "validate": 0.0}
        for entry in run["parameters"].values():
            entry["verdict"] = "fixed"
    result["best"]["correlation"] = None
    (folder / "result.json").write_text(json.dumps(result))


def test_of_a_response_without_noise_errors_are_not_counted_in_floors(tmp_path):
    folder = make_run(tmp_path / "run", noise_floor=1e-9)
    results = read_results(folder)
    assert verdict(results).endswith("; the response contains almost no noise, as if it were simulated.")
    text = "The RMSE falls from 3e6 to 1171.2 noise floors. It leaves 2000 noise floors."
    assert printed_reason(text.replace("3e6", "3000000.0"), results) == (
        "The RMSE falls from 0.00300 µm to 1.17 × 10⁻⁶ µm. It leaves 2.00 × 10⁻⁶ µm.".replace(" µm", "\u00a0µm")
    )
    assert printed_reason(text, read_results(make_run(tmp_path / "noisy"))) == text


def test_what_is_over_axes_says_so_and_what_it_counts():
    assert (together({"x": "um"}), weighed({"x": "um"}), weighed({"x": "um", "y": "nm"})) == ("", [], [])
    assert together({"x": "um", "y": "nm", "z": "m"}) == " (x, y and z together)"
    assert weighed({"p": "uC/cm2", "d": "nm"}) == [
        "An RMSE of p and d together weights each by its noise floor, or by 0.5\u00a0% of its span where that is more."
    ]


def test_the_headline_names_the_form_of_what_was_added():
    steps = [{"added": None}, {"added": "creep", "form": "voltage"}, {"added": "delay", "form": None}]
    improvement = {"effects": ["creep", "delay"], "verdict": "adequate", "steps": steps, "reason": "All said."}
    said = verdict(SimpleNamespace(improvement=improvement, share_of_noise=1.0, result=None, diagnosis=None))
    assert said.startswith("Added: creep (voltage) and delay. All said.")


@pytest.mark.parametrize(
    ("text", "first", "others"),
    [
        ("The model is adequate.", "The model is adequate.", []),
        ("Added: creep. The model is adequate, eq. 3. Said.", "Added: creep. The model is adequate, eq. 3.", ["Said."]),
        ("Nothing explains 0.1 um. 8 % is a form. lumped.mass is 3 kg.", "Nothing explains 0.1 um.", 2),
    ],
)
def test_the_head_of_the_page_is_one_sentence_and_the_others_are_listed(text, first, others):
    head, rest = headline(text)
    assert (head, rest if isinstance(others, list) else len(rest)) == (first, others)
    assert " ".join([head, *rest]) == text


@pytest.mark.parametrize(
    ("verdict", "decision", "sentence"),
    [
        ("missing", "missing", "Add creep to the model"),
        ("adequate", "not missing", "Put the model to work"),
        ("refused", "not missing", "See below where the model fails"),
    ],
)
def test_the_next_step_follows_from_the_verdict(plain, verdict, decision, sentence):
    results = read_results(plain)
    diagnosis = {"verdict": verdict, "candidates": [{"effect": "creep", "decision": decision}], "next_experiment": None}
    assert sentence in next_step(replace(results, diagnosis=diagnosis))
    assert "Diagnose the model" in next_step(replace(results, diagnosis={}))


@pytest.mark.parametrize("word", blocks.faults())
def test_the_next_step_is_to_mend_a_fault_of_the_set_up(plain, word):
    results = read_results(plain)
    found = {"verdict": "unexplained", "candidates": [], "faults": [word]}
    sentence = next_step(replace(results, diagnosis=found))
    assert blocks[word].remedy.removesuffix(".") in sentence and f"that of a {word}" in sentence


@pytest.mark.parametrize("use", ["identify", "validate"])
def test_a_model_that_no_record_kept_back_can_judge_is_not_put_to_work(plain, use):
    results = read_results(plain)
    last = {"rmse": {"identify": 1e-3, "validate": None}, "records": [{"name": "chirp", "use": use, "rmse": {}}]}
    diagnosis = {"verdict": "adequate", "candidates": [], "next_experiment": None}
    results = replace(results, diagnosis=diagnosis, improvement={"steps": [last]})
    kept = use == "validate"
    assert next_step(results).startswith("Measure a record to identify" if kept else "Put the model to work")
    assert ("none of those kept back can judge it" if kept else "no validation record") in remaining_error(results)


def test_what_a_sentence_marks_as_code_stays_marked(plain):
    results = read_results(plain)
    reason = "give the records more `steps`: 3\u00a0um are left"
    for known in ({"diagnosis": {"reason": reason}}, {"improvement": {"reason": reason, "effects": [], "steps": [{}]}}):
        assert verdict(replace(results, **known)) == reason.replace("um", "µm")
