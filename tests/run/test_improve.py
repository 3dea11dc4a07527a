"""diagnose and improve from the command line: what they write, say and refuse."""

import json
import re
from html import unescape
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from click.testing import CliRunner

import stage
from pzt_ident.cli.commands import main
from pzt_ident.diagnosis import staircase as stairs
from pzt_ident.diagnosis.budget import sensible
from pzt_ident.diagnosis.fit import fit_at
from pzt_ident.diagnosis.verdict import Diagnosis
from pzt_ident.job.schema import load_job
from pzt_ident.run import improve as improvement
from pzt_ident.run.statement import Statement

LINEAR = {"bouc_wen.alpha": 0.0, "bouc_wen.beta": 0.01, "bouc_wen.gamma": 0.0}
KNOWN = "parameters: {" + ", ".join(f"{name}: {{value: {value}}}" for name, value in LINEAR.items()) + "}\n"
CANDIDATE = {"effect", "class", "explained", "expected", "visibility", "rmse", "decision"}
DECISIONS = {"missing", "not missing", "cannot be seen", "too small"}


def call(*arguments):
    return CliRunner().invoke(main, list(map(str, arguments)))


def read(path):
    return json.loads(path.read_text(encoding="utf-8"))


def plain_text(page):
    return unescape(re.sub(r"<[^>]+>", "", page))


@pytest.fixture(scope="module")
def lagging(tmp_path_factory):
    """A job whose records cannot tell a lag ahead of the stage from one behind it."""
    made = stage.case(stage.EFFECTS["sensor_lag"] | LINEAR)
    return stage.write(tmp_path_factory.mktemp("lagging"), made.records, stage.JOB + KNOWN)


@pytest.fixture(scope="module")
def bent(tmp_path_factory):
    made = stage.case(stage.EFFECTS["quadratic_gain"])
    return stage.write(tmp_path_factory.mktemp("bent"), made.records)


@pytest.fixture(scope="module")
def improved(bent, tmp_path_factory):
    out = tmp_path_factory.mktemp("out") / "results" / "one"
    answer = call("improve", bent, "--out", out)
    assert answer.exit_code == 0, answer.output
    return answer, out


@pytest.fixture(scope="module")
def diagnosed(lagging, tmp_path_factory):
    out = tmp_path_factory.mktemp("out") / "tie"
    answer = call("diagnose", lagging, "--out", out)
    assert answer.exit_code == 0, answer.output
    return answer, out


class TestDiagnose:
    def test_the_file_has_what_was_agreed(self, diagnosed):
        content = read(diagnosed[1] / "diagnosis.json")
        assert {"verdict", "reason", "unit", "noise_floor", "rmse", "candidates", "next_experiment"} <= set(content)
        assert content["unit"] == "um"
        assert content["noise_floor"] == {"x": pytest.approx(0.005, rel=0.1)}
        assert set(content["rmse"]) == {"identify", "validate"}
        for candidate in content["candidates"]:
            assert set(candidate) >= CANDIDATE
            assert candidate["decision"] in DECISIONS
            assert candidate["effect"] in candidate["class"]
            assert candidate["rmse"] is None or set(candidate["rmse"]) == {"identify", "validate"}
            assert all(isinstance(value, float) for value in candidate["expected"].values())

    def test_a_tie_is_a_class_and_is_said(self, diagnosed):
        content = read(diagnosed[1] / "diagnosis.json")
        assert content["verdict"] == "inconclusive"
        best = content["candidates"][0]
        assert best["decision"] == "missing"
        assert {"amplifier_lag", "sensor_lag"} <= set(best["class"])
        assert {
            candidate["effect"] for candidate in content["candidates"] if set(candidate["class"]) == set(best["class"])
        } == set(best["class"])
        assert "cannot tell them apart" in diagnosed[0].stdout

    def test_the_drive_to_run_next_stays_within_the_limits(self, diagnosed):
        answer, out = diagnosed
        proposal = read(out / "diagnosis.json")["next_experiment"]
        assert set(proposal) == {"splits", "file", "why"}
        assert {"amplifier_lag", "sensor_lag"} <= set(proposal["splits"])
        assert f"apply the drive in {out / proposal['file']}" in answer.stdout
        path = out / proposal["file"]
        assert path.read_text(encoding="utf-8").splitlines()[0] == "time [s],u_x [V]"
        time, drive = np.loadtxt(path, delimiter=",", skiprows=1).T
        assert time[0] == 0 and time[-1] <= 30
        assert np.allclose(np.diff(time), time[1], rtol=1e-4)
        assert drive.min() >= 0 and drive.max() <= 120
        assert np.abs(np.diff(drive)).max() / time[1] <= 300 * 1.001

    def test_the_page_has_every_candidate_with_its_physics(self, diagnosed):
        page = unescape((diagnosed[1] / "report.html").read_text(encoding="utf-8"))
        content = read(diagnosed[1] / "diagnosis.json")
        assert all(sentence in plain_text(page) for sentence in content["reason"].split(". "))
        assert all(candidate["physics"] in page for candidate in content["candidates"])
        assert f"apply the drive in {content['next_experiment']['file']}" in page

    def test_says_what_to_do_on_the_rig(self, diagnosed):
        assert "on the rig: " in diagnosed[0].stdout
        assert f"diagnosis: {diagnosed[1] / 'diagnosis.json'}" in diagnosed[0].stdout

    def test_the_folder_holds_the_job_and_where_it_ran(self, diagnosed, lagging):
        assert load_job(diagnosed[1] / "job.yaml").model == load_job(lagging).model
        assert read(diagnosed[1] / "environment.json")["job_name"] == "small"

    def test_its_events_are_lines_as_those_of_a_run(self, diagnosed):
        lines = [json.loads(line) for line in (diagnosed[1] / "events.jsonl").read_text().splitlines()]
        content = read(diagnosed[1] / "diagnosis.json")
        scored = [line for line in lines if line["event"] == "scored"]
        assert {line["effect"] for line in scored} == {candidate["effect"] for candidate in content["candidates"]}
        assert [line["done"] for line in scored] == list(range(1, scored[0]["of"] + 1))
        refitted = {tuple(line["effects"]): line["identify"] for line in lines if line["event"] == "refitted"}
        best = content["candidates"][0]
        assert refitted[(best["effect"],)] == pytest.approx(best["rmse"]["identify"])
        assert all(line["said"] for line in lines[:-1]) and lines[-1]["event"] == "done"

    def test_json_is_all_there_is(self, bent, tmp_path):
        answer = call("diagnose", bent, "--out", tmp_path / "out", "--json")
        assert answer.stderr == ""
        content = json.loads(answer.stdout)
        assert content == {"folder": str(tmp_path / "out"), "diagnosis": read(tmp_path / "out" / "diagnosis.json")}
        assert content["diagnosis"]["verdict"] == "missing"
        assert content["diagnosis"]["next_experiment"] is None
        assert content["diagnosis"]["candidates"][0]["expected"] == {
            "quadratic_gain.curvature": pytest.approx(3e-4, rel=0.1)
        }

    def test_what_nothing_explains_is_said_to_lie_somewhere(self, tmp_path):
        def knocked(record):
            moving = (np.gradient(record.drive[0]) != 0) & (record.time > record.time[-1] / 2)
            return 30 * stage.NOISE * np.sin(np.arange(record.samples) ** 1.5) * moving

        made = stage.with_response(stage.case(), knocked)
        assert call("diagnose", stage.write(tmp_path, made.records), "--out", tmp_path / "out").exit_code == 0
        content = read(tmp_path / "out" / "diagnosis.json")
        assert content["verdict"] == "unexplained"
        assert re.search(
            r"the remaining error, an RMSE of .* on the validation records\. \d+ % of the misfit lies ",
            content["reason"],
        )


class TestImprove:
    def test_the_file_has_what_was_agreed(self, improved):
        content = read(improved[1] / "improvement.json")
        assert {"steps", "verdict", "effects", "noise_floor", "unit"} <= set(content)
        assert (content["verdict"], content["effects"], content["unit"]) == ("adequate", ["quadratic_gain"], "um")
        for step in content["steps"]:
            assert {"added", "removed", "class", "rmse", "explained"} <= set(step)
            assert set(step["rmse"]) == {"identify", "validate"}
            for record in step["records"]:
                assert record["rmse"] == {"x": pytest.approx(step["rmse"][record["use"]])}
        assert [step["added"] for step in content["steps"]] == [None, "quadratic_gain"]
        assert content["steps"][0]["class"] == [] and content["steps"][0]["removed"] is None
        floor = content["noise_floor"]["x"]
        assert content["floor"] == pytest.approx(floor)
        assert content["steps"][0]["rmse"]["validate"] > 3 * floor
        assert content["steps"][1]["rmse"]["validate"] == pytest.approx(floor, rel=0.1)

    def test_a_tie_is_said_and_the_drive_that_tells_is_proposed(self, lagging, tmp_path):
        answer = call("improve", lagging, "--out", tmp_path / "out")
        content = read(tmp_path / "out" / "improvement.json")
        assert content["verdict"] == "adequate"
        step = next(step for step in content["steps"] if step["added"])
        assert {"amplifier_lag", "sensor_lag"} <= set(step["class"])
        assert f"These data cannot tell {' from '.join(step['class'])}." in content["reason"]
        assert content["next_experiment"]["splits"] == step["class"]
        path = tmp_path / "out" / content["next_experiment"]["file"]
        assert path.exists() and f"apply the drive in {path}" in answer.stdout

    def test_the_noise_is_told_with_what_it_was_taken_from(self, improved):
        assert read(improved[1] / "improvement.json")["noise_floor_source"] == {"x": "rest segments"}
        assert [axis["noise_source"] for axis in read(improved[1] / "residuals.json")["axes"].values()] == [
            "rest segments"
        ]

    def test_the_diagnosis_is_of_the_last_model(self, improved):
        content = read(improved[1] / "diagnosis.json")
        last = read(improved[1] / "improvement.json")["steps"][-1]
        assert content["verdict"] == "adequate"
        assert content["rmse"] == last["rmse"]
        assert "quadratic_gain" not in [candidate["effect"] for candidate in content["candidates"]]

    def test_the_improved_job_checks(self, improved):
        path = improved[1] / "improved.yaml"
        assert load_job(path).effects == ("quadratic_gain",)
        text = path.read_text(encoding="utf-8")
        assert text.startswith("# nested loops\nname: small\n")
        assert "effects: [quadratic_gain] # none yet" in text
        answer = call("check", path)
        assert answer.exit_code == 0, answer.output
        assert "quadratic_gain.curvature" in answer.stdout

    def test_the_terminal_shows_the_staircase(self, improved):
        answer, out = improved
        assert "+ quadratic_gain: RMSE 0.00" in answer.stderr
        assert [
            line["added"] for line in map(json.loads, (out / "events.jsonl").open()) if line["event"] == "stair"
        ] == [
            None,
            "quadratic_gain",
        ]
        lines = answer.stdout.splitlines()
        assert any(line.startswith("as given") for line in lines)
        assert any(line.startswith("+ quadratic_gain") and "100 %" in line for line in lines)
        assert "adequate: " in answer.stdout
        assert f"improved job: {out / 'improved.yaml'}" in answer.stdout

    def test_the_page_shows_it_too(self, improved):
        page = (improved[1] / "report.html").read_text(encoding="utf-8")
        assert "Added: quadratic_gain." in plain_text(page)
        content = json.loads(re.search(r'id="content">(.*?)</script>', page, re.S)[1])
        (stairs,) = content["stairs"]
        assert [step["name"] for step in stairs["steps"]] == ["as given", "+ quadratic_gain"]
        assert {model["name"] for record in content["records"] for model in record["models"]} == {
            "improved",
            "as given",
        }
        assert {path.stem for path in (improved[1] / "tables").glob("*.tex")} == {"candidates", "steps", "changes"}

    def test_quiet_says_nothing_and_the_folder_has_a_name(self, bent, tmp_path, monkeypatch):
        monkeypatch.chdir(tmp_path)
        answer = call("improve", bent, "--quiet")
        assert (answer.exit_code, answer.output) == (0, "")
        (folder,) = Path("results/small").iterdir()
        assert load_job(folder / "improved.yaml").effects == ("quadratic_gain",)
        assert call("check", folder / "improved.yaml").exit_code == 0


COUPLED = """\
name: coupled
records:
  - {file: one.csv, use: identify}
  - {file: two.csv, use: validate, settle: 0.1 s}
channels:
  time: "t [s]"
  axes:
    x: {drive: "u_x [V]", response: "x [um]"}
    y: {drive: "u_y [V]"}
model: [bouc_wen, lumped]
effects: [kinematic_coupling]
parameters:
  lumped.mass: {value: 0.15}
  lumped.damping: {value: 70}
  lumped.stiffness: {value: 7e+7}
"""


@pytest.fixture
def coupled(tmp_path):
    """x and y are driven by ramps between chance levels, x alone is measured."""
    rng = np.random.default_rng(3)
    time = 5e-3 * np.arange(300)
    for name in ("one", "two"):
        u, v = (np.interp(np.arange(300), np.arange(0, 301, 25), rng.uniform(0, 100, 13)) for _ in "xy")
        table = np.column_stack([time, u, v, 0.1 * u + 0.03 * v])
        np.savetxt(tmp_path / f"{name}.csv", table, delimiter=",", header="t [s],u_x [V],u_y [V],x [um]", comments="")
    (tmp_path / "job.yaml").write_text(COUPLED, encoding="utf-8")
    return load_job(tmp_path / "job.yaml")


@pytest.mark.parametrize("alone", [True, False])
@pytest.mark.parametrize("steps", [(1, 1), (1, 3), (2, 1)])
def test_the_improved_job_is_the_model_that_was_told_of(coupled, tmp_path, monkeypatch, alone, steps):
    """A lag on both axes or on the measured one alone, at chance parameters and any steps: the job that is written
    gives the RMSE that is written, for both uses, with the parameters that are written."""
    effects, out = ("kinematic_coupling", "amplifier_lag"), tmp_path / "deep" / "out"

    def climbed(case, first, tell):
        problem = case.problem(effects, steps, alone)
        point = np.random.default_rng(5).uniform(0.3, 0.9, problem.dimensions)
        end = fit_at(effects, problem, point, measured_only=alone)
        climbed = [stairs.Step(first), stairs.Step(end, "amplifier_lag")]
        return stairs.Staircase(climbed, Diagnosis("adequate", "Said.", end, [], []))

    def as_given(case, seed, known):
        problem = case.problem(case.effects)
        return fit_at(case.effects, problem, np.full(problem.dimensions, 0.5))

    monkeypatch.setattr(improvement, "first_fit", as_given)
    monkeypatch.setattr(improvement.stairs, "improve", climbed)
    improvement.improve(coupled, out)
    step, job = read(out / "improvement.json")["steps"][-1], load_job(out / "improved.yaml")
    problem = Statement(job).problem
    assert job.effects == effects
    assert tuple(record.steps for record in problem.records) == steps
    assert problem.names == tuple(step["parameters"])
    assert ("y.amplifier_lag.tau" in job.parameters) == alone
    point = problem.unit_point({name: parameter["value"] for name, parameter in step["parameters"].items()})
    for use in ("identify", "validate"):
        assert 1e6 * problem.loss(point, use)[0] == pytest.approx(step["rmse"][use], rel=1e-6)


@pytest.mark.parametrize("command", ["diagnose", "improve"])
class TestRefusals:
    def test_a_folder_with_something_in_it(self, command, bent, tmp_path):
        (tmp_path / "mine.txt").write_text("mine")
        answer = call(command, bent, "--out", tmp_path)
        assert answer.exit_code == 2
        assert f"{tmp_path}: this folder is not empty" in answer.stderr
        assert answer.stdout == ""
        assert [path.name for path in tmp_path.iterdir()] == ["mine.txt"]

    def test_no_job(self, command, tmp_path):
        answer = call(command, tmp_path / "job.yaml", "--out", tmp_path / "out")
        assert answer.exit_code == 2
        assert "no such file" in answer.stderr
        assert not list(tmp_path.iterdir())

    def test_a_wrong_job(self, command, tmp_path):
        path = tmp_path / "job.yaml"
        path.write_text(stage.JOB.replace("effects: []", "effects: [crep]"), encoding="utf-8")
        answer = call(command, path, "--out", tmp_path / "out")
        assert answer.exit_code == 2
        assert "unknown effect 'crep'\n  did you mean 'creep'" in answer.stderr
        assert list(tmp_path.iterdir()) == [path]

    def test_missing_data(self, command, tmp_path):
        path = tmp_path / "job.yaml"
        path.write_text(stage.JOB, encoding="utf-8")
        answer = call(command, path, "--out", tmp_path / "out", "--json")
        assert answer.exit_code == 2
        assert "identify.csv" in answer.stderr and "Traceback" not in answer.output
        assert answer.stdout == ""
        assert list(tmp_path.iterdir()) == [path]


def test_a_diagnosis_that_is_killed_leaves_the_best_account_so_far(bent, tmp_path, monkeypatch):
    def killed(*arguments):
        raise KeyboardInterrupt

    monkeypatch.setattr(improvement, "diagnosis_of", killed)
    assert call("improve", bent, "--out", tmp_path / "out").exit_code == 130
    content = read(tmp_path / "out" / "improvement.json")
    assert (content["verdict"], content["effects"]) == ("unfinished", ["quadratic_gain"])
    assert "best account so far" in content["reason"]
    assert load_job(tmp_path / "out" / "improved.yaml").effects == ("quadratic_gain",)


def test_mechanics_that_the_last_model_does_without_are_not_in_the_improved_job(bent, tmp_path):
    parameters = "parameters: {lumped.mass: {bounds: [0.01, 1]}, bouc_wen.alpha: {bounds: [0, 1]}}\n"
    path = bent.with_name("mechanics.yaml")
    path.write_text(stage.JOB.replace("[bouc_wen]", "[bouc_wen, lumped]") + parameters, encoding="utf-8")
    job = load_job(path)
    case = improvement.case_of(Statement(job))
    lean = case.with_words(("bouc_wen",))
    problem = lean.problem(())
    end = fit_at((), problem, np.full(problem.dimensions, 0.5))
    text = improvement.improved(job, case, end, tmp_path)
    (tmp_path / "improved.yaml").write_text(text, encoding="utf-8")
    better = load_job(tmp_path / "improved.yaml")
    assert (better.model, list(better.parameters)) == (("bouc_wen",), ["bouc_wen.alpha"])


def test_the_best_account_so_far_goes_on_through_wider_bounds(monkeypatch):
    written = []
    monkeypatch.setattr(improvement, "announce", lambda case, step, path: None)
    monkeypatch.setattr(improvement, "improvement_of", lambda job, case, staircase, last: {"steps": staircase.steps})
    monkeypatch.setattr(improvement, "improved", lambda job, case, end, folder: end)
    monkeypatch.setattr(improvement, "write_improvement", lambda *content: written.append(content[1:]))
    so_far = improvement.SoFar(None, None, None)
    fits = [SimpleNamespace(total=total) for total in (9.0, 5.0, 1.0, 0.5)]
    given, added = stairs.Step(fits[0]), stairs.Step(fits[1], "creep")
    wider = stairs.Step(fits[2], change="wider bounds", case=object())
    for step in (given, added, wider, stairs.Step(fits[3])):
        so_far(step)
    assert [(len(content["steps"]), job) for content, job in written] == [*zip((1, 2, 3, 1), fits, strict=True)]


def test_a_budget_that_is_too_small_says_what_was_not_tried(bent, tmp_path):
    answer = call("improve", bent, "--out", tmp_path / "out", "--budget", "1us", "--no-report")
    assert answer.exit_code == 0
    content = read(tmp_path / "out" / "improvement.json")
    assert content["effects"] == []
    assert "The budget of 1e-06 s did not suffice for " in content["reason"] and "more effects" in content["reason"]


@pytest.mark.parametrize("command", ["improve", "diagnose"])
def test_a_model_that_cannot_be_simulated_is_not_diagnosed(bent, tmp_path, command):
    path = bent.with_name("overflowing.yaml")
    bounds = "parameters: {bouc_wen.beta: {bounds: [-400, -300]}, bouc_wen.gamma: {bounds: [-1, 1]}}\n"
    path.write_text(stage.JOB + bounds, encoding="utf-8")
    answer = call(command, path, "--out", tmp_path / "out")
    assert answer.exit_code == 1
    assert answer.stderr == "Error: the simulation of the model failed from each of its starts: narrow the bounds\n"
    assert not [*(tmp_path / "out").glob("*nosis.json")]


@pytest.mark.parametrize("budget", ["0s", "soon", "5 V", "-3s", "3 xyz"])
def test_a_budget_is_a_time(bent, budget):
    answer = call("improve", bent, "--budget", budget)
    assert answer.exit_code == 2
    assert f"{budget!r} is no time above zero: write it as 60s, 5min or 1h" in answer.stderr


@pytest.mark.parametrize(("samples", "seconds"), [(10, 60), (60_000, 60), (1_000_000, 1000)])
def test_without_one_there_is_a_millisecond_a_sample(samples, seconds):
    assert sensible(samples) == seconds
