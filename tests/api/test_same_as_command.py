"""The library and the command are one: the same data, seed and settings give the same numbers."""

import json

import numpy as np
import pytest
from click.testing import CliRunner

import pzt_ident as pzt
from pzt_ident.cli.commands import main
from pzt_ident.job.demo import write_demo

JOB = """\
name: fit
records:
  - {file: identify.csv, use: identify, settle: 0.1 s}
  - {file: validate.csv, use: validate}
channels:
  time: "time [s]"
  axes:
    x: {drive: "u_x [V]", response: "x [um]"}
model: [bouc_wen, lumped]
parameters:
  bouc_wen.alpha: {bounds: [0, 1]}
  lumped.mass: {value: 0.157}
optimizers:
  - {name: pso, population: 20, generations: 20}
repeats: 2
seed: 7
"""


def command(*words):
    answer = CliRunner().invoke(main, [*map(str, words)])
    assert answer.exit_code == 0, answer.output


@pytest.fixture(scope="module")
def stated(demo):
    """What the job above says, said in arguments."""
    return pzt.identify(
        pzt.Model("bouc_wen", "lumped"),
        pzt.Record(*demo[0], name="identify", settle="0.1 s"),
        validate=pzt.Record(*demo[1], name="validate"),
        bounds={"bouc_wen.alpha": (0, 1)},
        fixed={"lumped.mass": 0.157},
        optimizer={"name": "pso", "population": 20, "generations": 20},
        repeats=2,
        seed=7,
    )


@pytest.fixture(scope="module")
def run_folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("command")
    write_demo(folder)
    (folder / "job.yaml").write_text(JOB, encoding="utf-8")
    command("run", folder / "job.yaml", "--out", folder / "run", "--no-report")
    return folder / "run"


def assert_same(parameters, listed):
    assert parameters.keys() == listed.keys()
    for name, item in listed.items():
        assert parameters[name].value == pytest.approx(item["value"], rel=1e-9)
        assert parameters[name].unit == item["unit"]
        if "verdict" in item:
            assert parameters[name].verdict == item["verdict"]
            error = item["standard_error"]
            assert parameters[name].stderr == (error if error is None else pytest.approx(error, rel=1e-6))


def test_a_fit_is_that_of_the_command(stated, run_folder):
    best = json.loads((run_folder / "result.json").read_text(encoding="utf-8"))["best"]
    assert stated.rmse == pytest.approx(best["rmse"], rel=1e-9)
    assert_same(stated.parameters, best["parameters"] | best["fixed"])
    assert stated.parameters["lumped.mass"] == pzt.Parameter("lumped.mass", 0.157, None, "kg", None, "fixed")


def test_the_folder_of_a_run_is_a_fit(stated, run_folder):
    loaded = pzt.load(run_folder)
    assert str(loaded) == str(stated)
    for name, residual in stated.residuals.items():
        np.testing.assert_allclose(loaded.residuals[name], residual, rtol=0, atol=1e-9)


def test_commands_go_on_from_a_saved_fit(stated, tmp_path):
    folder = stated.save(tmp_path / "saved")
    command("resume", folder, "--no-report")
    listed = json.loads((folder / "result.json").read_text(encoding="utf-8"))["best"]
    assert_same(stated.parameters, listed["parameters"] | listed["fixed"])


def test_the_staircase_is_that_of_the_command(improvement, commanded):
    content = json.loads((commanded / "improvement.json").read_text(encoding="utf-8"))
    assert improvement.effects == content["effects"]
    assert improvement.verdict == content["verdict"]
    for step, listed in zip(improvement.steps, content["steps"], strict=True):
        assert step.rmse == pytest.approx(listed["rmse"], rel=1e-4)
