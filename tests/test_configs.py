"""Every job that ships reads its data and searches, here with a tiny budget."""

import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from pzt_ident.data.record import Record
from pzt_ident.job.schema import Job, Stopping, load_job
from pzt_ident.run.identify import tasks_of
from pzt_ident.run.statement import Statement, read
from pzt_ident.run.task import read_result, search
from pzt_ident.search import uncertainty

ROOT = Path(__file__).parents[1]
CONFIGS = sorted(ROOT.glob("configs/*.yaml"))
EXPERIMENTS = sorted(ROOT.glob("experiments/*/*.yaml"))
SAMPLES = 300  # of a record, behind what is not scored
TINY = {"stop": Stopping(evaluations=24), "repeats": 1, "polish": False}


@pytest.fixture(autouse=True)
def no_profiles(monkeypatch):
    """Intervals are those about a minimum, which a tiny budget does not reach."""
    monkeypatch.setattr(uncertainty, "intervals", lambda problem, point, *_: np.column_stack([point, point]))


def tiny(path: Path) -> Job:
    if "${PZT_IDENT_DATA}" in path.read_text(encoding="utf-8") and "PZT_IDENT_DATA" not in os.environ:
        pytest.skip("PZT_IDENT_DATA is not set: the measurement of this job is not there")
    return load_job(path).model_copy(update=TINY)


def shortened(record: Record) -> Record:
    """The whole file was read; its beginning is enough to search on."""
    samples = slice(0, record.settle + SAMPLES)
    return replace(record, drive=record.drive[:, samples], response=record.response[:, samples])


def check(job: Job, folder: Path) -> None:
    records = [shortened(record) for record in read(job)]
    assert {record.use for record in records} <= {"identify", "validate"}
    statement = Statement(job, records)
    for task in tasks_of(statement, folder):
        search(task, statement, lambda event: None)
        found = read_result(task)
        assert found["evaluations"] <= 24
        assert 0 < found["rmse"]["identify"] < float("inf")


@pytest.mark.parametrize("path", CONFIGS, ids=lambda path: path.stem)
def test_a_shipped_job_runs_with_every_optimizer(path, tmp_path):
    check(tiny(path), tmp_path)


@pytest.mark.parametrize("path", EXPERIMENTS, ids=lambda path: f"{path.parent.name}-{path.stem}")
def test_the_job_of_an_experiment_runs(path, tmp_path):
    job = tiny(path)
    check(job.model_copy(update={"optimizers": job.optimizers[:1]}), tmp_path)


def test_there_are_jobs_to_test():
    assert {path.stem for path in CONFIGS} >= {"x_axis", "lin_lin_x", "lin_lin_y", "picma", "bender"}
    assert {path.stem for path in CONFIGS} >= {"homogenized_energy", "free_density", "rod", "shell"}
    assert EXPERIMENTS
