"""Searches in the process that asks for them, and where they are left to others."""

import json

import pytest

import measured
from pzt_ident.job.schema import load_job
from pzt_ident.run import here, place
from pzt_ident.run.identify import run

JOB = """\
name: small
records: [{file: data.csv, use: identify}]
channels: {time: "time [s]", axes: {x: {drive: "u_x [V]", response: "x [um]"}}}
model: [bouc_wen]
optimizers: [{name: rga, population: 10, generations: 20}, {name: pso, population: 10, generations: 20}]
repeats: 2
"""


@pytest.fixture
def job(tmp_path):
    measured.write_raised(tmp_path / "data.csv", 300)
    (tmp_path / "job.yaml").write_text(JOB)
    return load_job(tmp_path / "job.yaml")


def test_what_takes_long_goes_on_in_processes_to_the_same_result(job, tmp_path, monkeypatch):
    begun, run_all = [], place.run_all

    def noted(entry, common, tasks, *more):
        begun.append([name for name, _ in tasks])
        return run_all(entry, common, tasks, *more)

    monkeypatch.setattr(place, "run_all", noted)
    results = []
    for seconds in (60.0, 0.0):
        monkeypatch.setattr(here, "SECONDS", seconds)
        out = run(job, tmp_path / f"out-{seconds}")
        result = json.loads((out / "result.json").read_text())
        results.append([(item["run"], item["rmse"], item["parameters"]) for item in result["runs"]])
    assert begun == [["rga-0", "rga-1", "pso-0", "pso-1"]]
    assert results[0] == results[1]


def test_a_search_that_fails_is_named_and_the_others_finish(job, tmp_path, monkeypatch):
    search = here.search
    monkeypatch.setattr(here, "search", lambda task, *given: 1 / 0 if task.run == "rga-1" else search(task, *given))
    out = run(job, tmp_path / "out")
    result = json.loads((out / "result.json").read_text())
    assert [item["run"] for item in result["runs"]] == ["rga-0", "pso-0", "pso-1"]
    assert result["failed_runs"] == [{"run": "rga-1", "reason": "ZeroDivisionError: division by zero"}]
