"""A fit from elsewhere: polished as a row of its own, better or equal, and the same each time."""

import json

import numpy as np
import pytest

import measured
from pzt_ident.errors import InputError
from pzt_ident.job import edit
from pzt_ident.job.schema import load_job
from pzt_ident.run.identify import resume, run
from pzt_ident.run.improve import diagnose
from pzt_ident.run.place import Local
from pzt_ident.run.start import Starts, read_start, start_values
from pzt_ident.run.statement import Statement

JOB = """\
records:
  - {file: data.csv, use: identify, rows: [0, 900]}
  - {file: data.csv, use: validate, settle: 9 s}
channels:
  time: time [s]
  axes: {x: {drive: "u_x [V]", response: "x [um]"}}
model: [bouc_wen]
effects: []
optimizers: [{name: pso, population: 6, generations: 4}, {name: cma_es, budget: 30}]
seed: 3
"""


def read(path):
    return json.loads(path.read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """A loop with a creep that a Bouc-Wen model misses, run and diagnosed."""
    folder = tmp_path_factory.mktemp("start")
    t = np.arange(1400) / 100
    u = 50 + 50 * np.sin(2 * np.pi * 0.5 * t) * np.where(t % 4 < 2.5, 1, 0.4)
    x = measured.creeping(u, 0.01, ratio=0.1, tau=1.2, width=3, height=0.3)
    measured.write(folder / "data.csv", t, u, x + np.random.default_rng(0).normal(0, 0.01, t.size))
    (folder / "job.yaml").write_text(JOB)
    job = load_job(folder / "job.yaml")
    run(job, folder / "run", place=Local(1))
    diagnose(job, folder / "diagnosis", start=folder / "run")
    return folder


def test_the_diagnosis_has_the_fit_of_the_run_or_a_better_one(place):
    one, other = read(place / "run/result.json")["best"]["rmse"], read(place / "diagnosis/diagnosis.json")["rmse"]
    assert other["identify"] <= one["identify"] * (1 + 1e-9)


def test_and_gives_a_better_one_back(place, tmp_path):
    poor = tmp_path / "poor.json"
    poor.write_text(json.dumps({"parameters": {"bouc_wen.alpha": {"value": 0.9, "unit": "1"}}}))
    folder = run(load_job(place / "job.yaml"), tmp_path / "run", place=Local(1), start=poor, only_start=True)
    before = read(folder / "result.json")
    assert (before["league"], [row["run"] for row in before["runs"]]) == ([], ["start-0"])
    resume(folder, place=Local(1), start=place / "diagnosis")
    after, diagnosis = read(folder / "result.json"), read(place / "diagnosis/diagnosis.json")
    assert [row["run"] for row in after["runs"]] == ["start-0", "start-1"]
    assert after["best"]["rmse"]["identify"] <= diagnosis["rmse"]["identify"] * (1 + 1e-9)
    assert [start for start, _ in Starts.kept(folder).given] == [str(poor), str(place / "diagnosis")]


def test_a_step_gives_what_the_diagnosis_promised(place, tmp_path):
    candidates = read(place / "diagnosis/diagnosis.json")["candidates"]
    fitted = next(candidate for candidate in candidates if candidate.get("parameters"))
    out = tmp_path / "job.yaml"
    edit.add(place / "job.yaml", fitted["item"], out, start=place / "diagnosis")
    folder = run(load_job(out), tmp_path / "run", place=Local(1), start=place / "diagnosis", only_start=True)
    gave = read(folder / "result.json")["best"]["rmse"]
    assert gave["identify"] <= fitted["rmse"]["identify"] * (1 + 1e-9)


def test_no_optimizer_is_given_it(place, tmp_path):
    job = load_job(place / "job.yaml")
    without = read(place / "run/result.json")
    folder = run(job, tmp_path / "run", place=Local(1), start=place / "diagnosis")
    beside = read(folder / "result.json")
    assert {row["optimizer"] for row in beside["league"]} == {"pso", "cma_es"}
    by_run = {row["run"]: row for row in beside["runs"]}
    for row in without["runs"]:
        assert by_run[row["run"]]["rmse_before_polish"] == row["rmse_before_polish"]
    assert "start-0" in by_run and "start" not in (folder / "history.csv").read_text()


def test_it_is_the_same_each_time(place, tmp_path):
    folders = [
        run(load_job(place / "job.yaml"), tmp_path / name, place=Local(1), start=place / "diagnosis", only_start=True)
        for name in "ab"
    ]
    one, other = (read(folder / "result.json")["best"] for folder in folders)
    assert one["point"] == other["point"] and one["parameters"] == other["parameters"]


def test_units_are_those_of_the_file(place, tmp_path):
    file = tmp_path / "start.json"
    file.write_text(json.dumps({"parameters": {"bouc_wen.gain": {"value": 90.0, "unit": "nm/V"}}}))
    job = load_job(place / "job.yaml")
    problem = Statement(job).problem
    assert start_values(problem, read_start(file, job))["bouc_wen.gain"] == pytest.approx(0.09)


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        ("{", "is not JSON"),
        ("{}", "holds no fit"),
        ('{"parameters": {"a.b": {"value": 1, "unit": "1"}}}', "has no parameter"),
    ],
)
def test_what_is_no_fit_is_refused(place, tmp_path, content, sentence):
    (tmp_path / "start.json").write_text(content)
    with pytest.raises(InputError, match=sentence):
        read_start(tmp_path / "start.json", load_job(place / "job.yaml"))
