"""The command line: answers, exit codes, and one clear line for whatever goes wrong."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from dataclasses import fields
from pathlib import Path

import click
import numpy as np
import pytest
from click.testing import CliRunner, Result

import pzt_ident.report.page
import pzt_ident.run.identify
from pzt_ident.cli.commands import main
from pzt_ident.errors import InputError, RunError
from pzt_ident.job.schema import Job
from pzt_ident.model.description import description_of
from pzt_ident.model.registry import blocks, optimizers
from pzt_ident.run.place import Local

JOB = """\
name: small
records:
  - {file: identify.csv, use: identify}
  - {file: validate.csv, use: validate, settle: 0.1 s}
channels:
  time: "time [s]"
  axes:
    x: {drive: "u_x [V]", response: "x [um]"}
model: [bouc_wen]
parameters:
  bouc_wen.gamma: {value: 0.01}
optimizers:
  - {name: pso, population: 20, generations: 40}
repeats: 2
"""

RESULT = {
    "unit": "um",
    "units": {"x": "um"},
    "floor": 0.0289,
    "league": [
        {
            "optimizer": "pso",
            "runs": 2,
            "rmse_best": 0.1234567,
            "rmse_median": 0.2,
            "polished_rmse_best": 0.11,
            "polished_rmse_median": 0.12,
        }
        | {"seconds_median": 0.5}
    ],
    "best": {
        "run": "pso-1",
        "rmse": {"identify": 0.12, "validate": None},
        "parameters": {
            "bouc_wen.gain": {"value": 0.0819, "unit": "um/V", "standard_error": 0.0002, "verdict": "determined"},
            "lumped.mass": {"value": 0.3, "unit": "kg", "standard_error": None, "verdict": "not determined"},
        },
    },
    "noise_floor": {"x": 0.0289},
    "records": [{"name": "slow", "notes": ["decimated by 4"]}],
    "failed_runs": [{"run": "pso-0", "reason": "its process was killed by signal 9"}],
}


def write_table(path: Path, header: str = "time [s],u_x [V],x [um]", edit=lambda table: table, rows: int = 300) -> None:
    t = np.arange(rows) / 1000
    u = 50 * (1 - np.cos(20 * t))
    table = edit(np.column_stack([t, u, 0.08 * np.convolve(u, np.ones(30) / 30)[:rows]]))
    np.savetxt(path, table, delimiter=",", header=header, comments="", fmt="%.9g")


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A job beside its data, and the working directory."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "job.yaml").write_text(JOB)
    for name in ("identify", "validate"):
        write_table(tmp_path / f"{name}.csv")
    return tmp_path


@pytest.fixture
def quick(monkeypatch):
    """A run that takes no time; what it was called with is collected."""
    calls = []

    def start(source, *arguments, listen, **options):
        calls.append((source, *arguments, options))
        out = Path("out")
        out.mkdir(exist_ok=True)
        listen(
            {
                "event": "start",
                "runs": ["pso-0", "pso-1"],
                "budget": 1600,
                "unit": "um",
                "together": "",
                "folder": "out",
            }
        )
        listen({"event": "failed", "run": "pso-0", "reason": "its process was killed by signal 9"})
        (out / "result.json").write_text(json.dumps(RESULT))
        return out

    monkeypatch.setattr(pzt_ident.run.identify, "run", start)
    monkeypatch.setattr(pzt_ident.run.identify, "resume", start)
    monkeypatch.setattr(pzt_ident.report.page, "write_report", lambda folder: (folder / "report.html").touch())
    return calls


def call(*arguments: str) -> Result:
    return CliRunner().invoke(main, arguments)


def files(folder: Path) -> set[str]:
    return {str(path.relative_to(folder)) for path in folder.rglob("*")}


class TestRun:
    def test_prints_the_result(self, folder, quick):
        result = call("run", "job.yaml")
        assert result.exit_code == 0
        assert "pso        2     0.1235" in result.stdout
        assert "bouc_wen.gain  0.0819  0.0002          um/V  determined" in result.stdout
        assert "lumped.mass    0.3     -               kg    not determined" in result.stdout
        assert "RMSE [um]: 0.12 on the identification records (pso-1)" in result.stdout
        assert "noise floor of x [um]: 0.0289" in result.stdout
        assert "slow: decimated by 4" in result.stdout
        assert "pso-0 failed: its process was killed by signal 9" in result.stdout
        assert f"report: {Path('out') / 'report.html'}" in result.stdout
        assert "pso-0 failed" in result.stderr

    def test_hands_its_options_on(self, folder, quick):
        call("run", "job.yaml", "--out", "there", "--workers", "3", "--no-report")
        ((job, out, options),) = quick
        assert (job.name, out, options) == (
            "small",
            Path("there"),
            {"place": Local(3), "start": None, "only_start": False},
        )
        assert not (Path("out") / "report.html").exists()

    def test_json_is_all_there_is(self, folder, quick):
        result = call("run", "job.yaml", "--json")
        assert json.loads(result.stdout) == {"folder": "out", "result": RESULT}
        assert result.stderr == ""

    def test_quiet_says_nothing(self, folder, quick):
        result = call("run", "job.yaml", "--quiet")
        assert (result.exit_code, result.output) == (0, "")

    def test_resume(self, folder, quick):
        result = call("resume", "out", "--workers", "1")
        assert result.exit_code == 0
        assert quick == [(Path("out"), {"place": Local(1), "plugins": False, "start": None})]
        assert (Path("out") / "report.html").exists()

    def test_resume_without_a_run(self, folder):
        result = call("resume", str(folder))
        assert result.exit_code == 2
        assert "Error:" in result.stderr
        assert result.stdout == ""


DATA_FAULTS = {
    "no such file": lambda folder: (folder / "identify.csv").unlink(),
    "empty": lambda folder: (folder / "identify.csv").write_text(""),
    "u_x": lambda folder: write_table(folder / "identify.csv", header="time [s],ux,x [um]"),
    "constant": lambda folder: write_table(folder / "identify.csv", edit=lambda t: t * [1, 1, 0]),
    "samples": lambda folder: write_table(folder / "identify.csv", rows=2),
    "scored samples": lambda folder: write_table(folder / "identify.csv", rows=3),
    "identify.csv": lambda folder: write_table(folder / "identify.csv", edit=with_gap),
    "time": lambda folder: write_table(folder / "identify.csv", edit=lambda t: np.delete(t, 100, axis=0)),
    "0.1 V cannot be an RMSE of a response in um": lambda folder: (folder / "job.yaml").write_text(
        JOB + "stop: {target: 0.1 V}\n"
    ),
    "NOWHERE": lambda folder: (folder / "job.yaml").write_text(JOB.replace("identify.csv", '"${NOWHERE}/a.csv"')),
    "job.yaml:1:1: nmae: unknown key": lambda folder: (folder / "job.yaml").write_text(JOB.replace("name", "nmae", 1)),
    "job.yaml: no such file": lambda folder: (folder / "job.yaml").unlink(),
}


def with_gap(table):
    table[50, 2] = np.nan
    return table


@pytest.mark.parametrize(
    ("word", "remedy"),
    [("effects", "Write `pzt-ident list effects`."), ("improv", "Did you mean 'improve'"), ("xyz", "Known: add, ")],
)
def test_a_word_that_is_no_command_has_a_remedy(word, remedy):
    result = call(word)
    assert result.exit_code == 2 and f"No such command '{word}'. {remedy}" in result.stderr


@pytest.mark.parametrize("command", ["run", "check"])
@pytest.mark.parametrize("message", DATA_FAULTS)
def test_bad_input_ends_with_2_and_writes_nothing(folder, command, message):
    DATA_FAULTS[message](folder)
    before = files(folder)
    result = call(command, "job.yaml", "--json")
    assert result.exit_code == 2
    assert message in result.stderr
    assert "Traceback" not in result.output
    error, remedy = result.stderr.rstrip().rsplit("\n", 1)
    assert error.startswith("Error: ")
    assert remedy.startswith("  ")
    assert result.stdout == ""
    assert files(folder) == before


class TestCheck:
    def test_says_what_a_run_would_do(self, folder):
        before = files(folder)
        result = call("check", "job.yaml")
        assert result.exit_code == 0
        assert result.stdout.startswith("small (")
        assert "validate  validation      300      1000       0.3         0.1" in result.stdout
        assert "x     0 to 100 V" in result.stdout
        assert "bouc_wen.gamma  1/V" in result.stdout
        assert "fixed at 0.01" in result.stdout
        assert "runs: pso-0 pso-1, 1600 evaluations in all" in result.stdout
        assert files(folder) == before

    def test_json(self, folder):
        facts = json.loads(call("check", "job.yaml", "--json").stdout)
        assert [record["samples"] for record in facts["records"]] == [300, 300]
        assert facts["axes"][0]["drive_range"] == pytest.approx([0, 100], abs=1)
        assert facts["axes"][0]["response_unit"] == "um"
        named = {row["name"]: row for row in facts["parameters"]}
        assert named["bouc_wen.gamma"]["value"] == pytest.approx(0.01)
        low, high = named["bouc_wen.gain"]["bounds"]
        assert (low, named["bouc_wen.gain"]["unit"]) == (0, "um/V")
        assert 0.1 < high < 1

    def test_says_that_validation_is_none(self, folder):
        (folder / "job.yaml").write_text(JOB.replace("validate.csv", "identify.csv"))
        message = "identify_2: rows 100 to 300 are fitted in 'identify_1', so they validate nothing"
        assert message in call("check", "job.yaml").stdout

    def test_quiet(self, folder):
        result = call("check", "job.yaml", "--quiet")
        assert (result.exit_code, result.output) == (0, "")


class TestWords:
    def test_every_word_is_listed_once(self):
        listed = {kind: json.loads(call("list", kind, "--json").stdout) for kind in ("blocks", "effects", "optimizers")}
        assert set(blocks.words()) == (set(listed["blocks"]) | set(listed["effects"])) & set(blocks.words())
        assert not set(listed["blocks"]) & set(listed["effects"])
        assert sorted(listed["optimizers"]) == optimizers.words()
        assert all(line for kind in listed.values() for line in kind.values())
        assert json.loads(call("list", "--json").stdout) == listed
        assert all(word in call("list").stdout for kind in listed.values() for word in kind)

    def test_every_key_of_a_job_is_listed(self):
        listed, printed = json.loads(call("list", "keys", "--json").stdout), call("list", "keys").stdout
        assert listed["The file"].keys() == Job.model_fields.keys()
        assert listed["each item of records"]["settle"]["default"] == "0.0"
        for section, keys in listed.items():
            assert f"{section}. " in printed
            assert all(key in printed and row["doc"] in printed for key, row in keys.items())

    def test_a_word_that_only_a_description_has_leads_to_it(self):
        result = call("show", "preisach")
        assert result.exit_code != 0 and "homogenized_energy" in result.stderr and "of it" in result.stderr

    def test_settings_are_shown_as_a_job_may_have_them(self, folder):
        shown = {word: json.loads(call("show", word, "--json").stdout).get("in_a_job") for word in blocks.words()}
        written = {word: item for word, item in shown.items() if item}
        assert {"homogenized_energy", "domain_wall", "modal", "history"} <= set(written)
        for word, item in written.items():
            chain = f"[{item}]" if blocks.kind_of(word) == "hysteresis" else f"[bouc_wen, {item}]"
            model = item.removeprefix("model: ") if item.startswith("model: ") else chain
            job = JOB.replace("model: [bouc_wen]", f"model: {model}").replace("  bouc_wen.gamma: {value: 0.01}\n", "")
            (folder / "job.yaml").write_text(job.replace("parameters:\n", ""))
            assert call("check", "job.yaml", "--quiet").exit_code == 0, item
            assert f"In a job: {item}" in call("show", word).stdout

    def test_every_word_is_shown_with_all_that_it_declares(self):
        for word in blocks.words():
            shown = call("show", word).stdout
            for name, declared in blocks[word].parameters().items():
                assert f"\n{word}.{name} " in shown or name.rpartition("_")[2].isdigit()
                assert declared.doc in shown
        for word in optimizers.words():
            shown = call("show", word).stdout
            assert all(f"\n{field.name} " in shown for field in fields(optimizers[word]))

    def test_every_word_says_where_it_acts_in_the_chain(self):
        shown = {word: " ".join(call("show", word).stdout.split()) for word in blocks.words()}
        for word, text in shown.items():
            items = blocks.forms(word) if blocks.is_effect(word) else [word]
            places = [getattr(blocks[item], "place", None) for item in items]
            assert all(f"at {place.name.lower()}" in text for place in places if place is not None)
            assert ("The chain goes from the drive through delay, slew" in text) is any(
                place is not None for place in places
            )

    def test_an_operator_says_where_its_memory_begins(self):
        operators = [word for word in blocks.words() if blocks.kind_of(word) == "hysteresis"]
        for word in [*operators, "bouc_wen_oscillator"]:
            assert "A record begins" in " ".join(call("show", word).stdout.split())

    def test_a_parameter_that_has_to_be_above_zero_says_so(self):
        for word in blocks.words():
            shown = call("show", word).stdout
            for name, declared in blocks[word].parameters().items():
                rows = [row for row in shown.splitlines() if row.startswith(f"{word}.{name} ")]
                assert all((" Above 0." in row) is (declared.scale == "log") for row in rows if declared.doc in row)

    def test_it_says_with_which_forms_of_an_effect_a_parameter_is_searched_for(self):
        shown = call("show", "bouc_wen").stdout
        assert "With `asymmetry` in its first form only." in shown and "With `asymmetry.constant` only." in shown
        assert "With `rate_dependence`, in any of its forms, only." in shown
        assert "asymmetry.voltage" not in shown + call("show", "asymmetry").stdout

    def test_a_key_of_a_job_is_shown_where_it_stands(self):
        shown = json.loads(call("show", "settle", "--json").stdout)
        assert [*shown] == ["each item of records"] and [*shown["each item of records"]] == ["settle"]
        assert "simulated but not scored" in call("show", "settle").stdout
        for word in ("delay", "pso", "bouc_wen"):  # a word is none
            assert json.loads(call("show", word, "--json").stdout)["name"] == word

    def test_effects_are_listed_by_the_alphabet(self):
        listed = [*json.loads(call("list", "effects", "--json").stdout)]
        assert listed == sorted(listed)

    def test_another_form_is_shown_with_what_it_has_beside(self):
        shown = call("show", "homogenized_energy").stdout
        assert "\ndensity " in shown and "lognormal or free" in shown and "\nnodes " in shown
        assert (
            "Fixed at 0.001 unless the job gives bounds or another value. With `density: free` or `density: shared`"
            in shown
        )
        assert "Median of the coercive fields. Above 0. With `density: lognormal` only." in shown
        assert "\nhomogenized_energy.weight_1 to weight_22 " in shown and ".weight_2 " not in shown

    def test_block(self):
        result = call("show", "bouc_wen", "--json")
        facts = json.loads(result.stdout)
        assert facts["kind"] == "hysteresis"
        assert facts["doc"].startswith("y = ")
        assert facts["parameters"][0] | {"doc": ""} == {
            "name": "gain",
            "form": "",
            "unit": "response/drive",
            "bounds": list(blocks["bouc_wen"].gain.bounds),
            "null": None,
            "value": None,
            "scale": "linear",
            "effects": [],
            "per_later_axis": False,
            "per_record": False,
            "adds_to": None,
            "doc": "",
        }

    def test_effect_inside_a_block(self, monkeypatch):
        from pzt_ident.model.block import Block, Place
        from pzt_ident.model.parameter import Parameter

        class Skewed(Block):
            """y = u + skew u^2."""

            name = "skewed"
            place = Place.OPERATOR
            skew = Parameter("1/drive", (-1, 1), "Skew.", null=0, effect="skewness")

        monkeypatch.setitem(blocks._items, "skewed", Skewed)
        assert json.loads(call("list", "effects", "--json").stdout)["skewness"] == "a term of skewed"
        shown = call("show", "skewness").stdout
        assert re.search(r"skewed\.skew +1/drive  -1 to 1  0     Skew\. With `skewness` only\.", shown)

    def test_effect_says_what_to_do(self):
        for word in ("creep", "drift", "load_mass"):
            effect, shown = blocks[word], call("show", word).stdout
            alike = description_of(word)["look_alikes"]
            assert f"\nLeaves much the same trace as: {', '.join(alike)}\n" in shown
            assert f"\nTo tell: {effect.separate_by}\n" in shown
            assert f"\nTo do: {effect.remedy}\n" in shown
        assert re.search(r"\nlumped\.load +kg", shown)

    def test_unknown(self):
        result = call("show", "bouc_wenn")
        assert result.exit_code == 2
        assert "unknown word 'bouc_wenn'\n  did you mean 'bouc_wen'" in result.stderr

    def test_unknown_words_are_listed_once(self):
        known = call("show", "zzzz").stderr.partition("known: ")[2].strip().split(", ")
        assert "load_mass" in known and len(known) == len(set(known))

    def test_a_headline_goes_on_to_its_full_stop(self):
        for kind in ("blocks", "effects", "optimizers"):
            for word, said in json.loads(call("list", kind, "--json").stdout).items():
                assert said.endswith(".") and "\n" not in said, word

    def test_unknown_kind(self):
        result = call("list", "effect")
        assert result.exit_code == 2
        assert "'effects'" in result.stderr


class TestInit:
    def test_writes_a_job_that_checks(self, tmp_path):
        folder = tmp_path / "new" / "folder"
        result = call("init", str(folder))
        assert result.exit_code == 0
        assert f"next: pzt-ident run {folder / 'job.yaml'}" in result.stdout
        assert files(folder) == {"job.yaml", "x_identify.csv", "x_validate.csv"}
        assert call("check", str(folder / "job.yaml")).exit_code == 0

    def test_says_what_to_type_next(self, folder):
        assert "next: pzt-ident run 'my stage/job.yaml'\n" in call("init", "my stage").stdout

    def test_overwrites_nothing(self, tmp_path):
        (tmp_path / "x_validate.csv").write_text("mine")
        result = call("init", str(tmp_path))
        assert result.exit_code == 2
        assert f"{tmp_path / 'x_validate.csv'}: exists already" in result.stderr
        assert files(tmp_path) == {"x_validate.csv"}
        assert (tmp_path / "x_validate.csv").read_text() == "mine"

    def test_a_file_is_no_folder(self, tmp_path):
        (tmp_path / "file").touch()
        result = call("init", str(tmp_path / "file"))
        assert result.exit_code == 2
        assert "is not a folder" in result.stderr


class TestErrors:
    @pytest.fixture
    def failing(self, folder, monkeypatch):
        def set_error(error):
            def start(*arguments, listen, **options):
                listen(
                    {"event": "start", "runs": ["pso-0"], "budget": 10, "unit": "um", "together": "", "folder": "out"}
                )
                raise error

            monkeypatch.setattr(pzt_ident.run.identify, "run", start)

        return set_error

    def test_input_error(self, failing):
        failing(InputError("too short", where="a.csv:3", remedy="measure longer"))
        result = call("run", "job.yaml")
        assert (result.exit_code, result.stderr) == (2, "Error: a.csv:3: too short\n  measure longer\n")

    def test_interrupt(self, failing):
        failing(KeyboardInterrupt())
        result = call("run", "job.yaml")
        assert result.exit_code == 130
        assert result.stderr == "`pzt-ident resume out` goes on from here\nError: interrupted\n"

    def test_full_disk(self, failing):
        failing(OSError(28, "No space left on device", "out/history.csv"))
        result = call("run", "job.yaml")
        assert result.exit_code == 1
        assert result.stderr == (
            "`pzt-ident resume out` goes on from here\nError: out/history.csv: No space left on device\n"
        )

    def test_a_run_that_came_to_nothing(self, failing):
        failing(RunError("every run failed: narrow the bounds"))
        result = call("run", "job.yaml")
        assert (result.exit_code, result.stderr) == (1, "Error: every run failed: narrow the bounds\n")

    def test_unexpected(self, failing):
        failing(ZeroDivisionError("by zero"))
        result = call("run", "job.yaml")
        assert result.exit_code == 1
        assert result.stderr == "Error: ZeroDivisionError: by zero (`pzt-ident --debug ...` shows where)\n"

    def test_unexpected_in_full(self, failing):
        failing(ZeroDivisionError("by zero"))
        assert isinstance(call("--debug", "run", "job.yaml").exception, ZeroDivisionError)

    def test_a_report_of_no_run(self, folder):
        result = call("report", "nowhere")
        assert result.exit_code == 2
        assert result.stderr == (
            f"Error: {Path('nowhere') / 'result.json'}: file is missing\n  give the folder of a finished run\n"
        )

    def test_out_that_cannot_be_written(self, folder):
        (folder / "file").touch()
        result = call("run", "job.yaml", "--out", "file/out")
        assert result.exit_code == 2
        assert result.stderr == f"Error: {Path('file/out')}: Not a directory\n  give another folder with --out\n"

    @pytest.mark.parametrize(
        ("arguments", "message"),
        [
            (["chek", "job.yaml"], "Did you mean 'check'?"),
            (["run"], "Missing argument 'JOB'"),
            (["run", "job.yaml", "--workers", "0"], "0 is not in the range"),
            (["run", "job.yaml", "--quite"], "--quiet"),
            (["report"], "Missing argument 'DIR...'"),
        ],
        ids=" ".join,
    )
    def test_usage(self, folder, arguments, message):
        result = call(*arguments)
        assert result.exit_code == 2
        assert message in result.stderr

    @pytest.mark.parametrize("name", main.commands)
    def test_what_is_missing_is_said_with_where_it_comes_from(self, name):
        """A stranger asked `show` without a word, and read that NAME is missing."""
        needed = [item for item in main.commands[name].params if isinstance(item, click.Argument) and item.required]
        for number, argument in enumerate(needed):
            result = call(name, *["given"] * number)
            assert result.exit_code == 2
            missing = f"Missing argument '{argument.human_readable_name}'. "
            assert missing in result.stderr and result.stderr.split(missing)[1].strip().endswith(".")


def start(*arguments: str, **options) -> subprocess.CompletedProcess:
    command = [sys.executable, "-m", "pzt_ident", *arguments]
    return subprocess.run(command, capture_output=True, text=True, timeout=60, **options)


def imported(done: subprocess.CompletedProcess) -> set[str]:
    """The modules that a process with PYTHONPROFILEIMPORTTIME imported."""
    return {line.rpartition("|")[2].strip() for line in done.stderr.splitlines()}


class TestProcess:
    def test_help_imports_nothing_heavy(self):
        done = start("--help", env=os.environ | {"PYTHONPROFILEIMPORTTIME": "1"})
        assert done.returncode == 0
        assert done.stdout.startswith("Usage: pzt-ident")
        heavy = {"numpy", "numba", "scipy", "pandas", "matplotlib", "pydantic", "ruamel", "rich", "h5py"}
        assert "click" in imported(done)
        assert not imported(done) & heavy

    def test_run_imports_no_package_for_a_part_of_it(self, folder):
        done = start("run", "job.yaml", "--no-report", env=os.environ | {"PYTHONPROFILEIMPORTTIME": "1"})
        heavy = {"scipy.linalg", "scipy.optimize", "scipy.signal", "scipy.interpolate", "pandas", "matplotlib"}
        heavy |= {"pyswarms.utils", "yaml", "tqdm"}
        assert done.returncode == 0
        assert "numpy" in imported(done)
        assert not imported(done) & heavy

    def test_a_command_that_waited_has_imported_what_searches_and_writes(self, folder):
        code = """if True:
            import sys
            from pzt_ident.cli import child_process

            def arguments():
                global before
                before = set(sys.modules)
                return ["run", "job.yaml", "--no-report", "--quiet"]

            child_process.arguments = arguments
            try:
                child_process.main()
            finally:
                print(*sys.modules.keys() - before)
        """
        with subprocess.Popen(
            [sys.executable, "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        ) as waiting:
            later = waiting.stdout.read().split()
        assert waiting.returncode == 0
        needed = {"numpy.linalg", "pydantic", "llvmlite", "h5py", "ruamel.yaml", "pzt_ident.run.identify"}
        assert "pzt_ident.data.formats.text" in later
        assert not needed & set(later)

    def test_a_command_that_ends_looks_for_no_garbage(self):
        code = """if True:
            import gc
            from pzt_ident.cli.commands import main

            class Ring:
                def __del__(self):
                    print("found")

            gc.disable()
            ring = Ring()
            ring.of = ring
            del ring
            main(["show", "pso", "--quiet"])
        """
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
        assert (done.returncode, done.stdout, done.stderr) == (0, "", "")

    def test_bad_job_ends_with_2(self, folder):
        (folder / "job.yaml").write_text(JOB.replace("[bouc_wen]", "[bouc_wenn]"))
        done = start("run", "job.yaml")
        assert (done.returncode, done.stdout) == (2, "")
        assert "job.yaml:9:9: model[0]: unknown block 'bouc_wenn'\n  did you mean 'bouc_wen'" in done.stderr
        assert files(folder) == {"job.yaml", "identify.csv", "validate.csv"}

    @pytest.mark.skipif(os.name == "nt", reason="needs a POSIX pipe")
    def test_a_closed_pipe_is_silent(self):
        reading, writing = os.pipe()
        os.close(reading)
        command = [sys.executable, "-m", "pzt_ident", "show", "pso"]
        done = subprocess.run(command, stdout=writing, stderr=subprocess.PIPE, text=True, timeout=60)
        os.close(writing)
        assert done.stderr == ""

    @pytest.mark.skipif(os.name == "nt", reason="needs a POSIX shell")
    def test_no_stdout_and_no_stderr(self, folder):
        command = f"{sys.executable} -m pzt_ident check job.yaml >&- 2>&-"
        assert subprocess.run(command, shell=True, timeout=60).returncode == 0

    def test_letters_that_the_terminal_lacks(self, folder):
        (folder / "job.yaml").write_text(JOB.replace("{file: identify.csv,", "{file: identify.csv, name: πρώτη,"))
        done = start("check", "job.yaml", env=os.environ | {"PYTHONIOENCODING": "cp1252"})
        assert (done.returncode, done.stderr) == (0, "")
        assert "?????" in done.stdout

    @pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs /dev/full")
    def test_a_full_disk_is_one_line(self):
        with open("/dev/full", "w") as full:
            command = [sys.executable, "-m", "pzt_ident", "show", "pso"]
            done = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True, timeout=60)
        assert done.returncode == 1
        assert done.stderr == "Error: No space left on device\n"
