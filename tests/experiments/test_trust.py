"""A slice of each campaign of trust."""

import numpy as np
import pytest

from experiments.trust import kills, numerics, surroundings, versions
from experiments.trust.bench import Bench, Ended
from experiments.trust.good import measurement
from experiments.trust.judge import faults_of
from experiments.trust.malformed import file_cases, job_cases
from experiments.trust.oversampled import coupled_record
from experiments.trust.tellings import AXES_BACKWARDS, OTHERWISE, Telling


def wrong(cases):
    return [(case.how, case.faults, case.message) for case in cases if case.faults]


def test_malformed_jobs(tmp_path):
    assert not wrong(job_cases(range(15), 77, tmp_path))


def test_malformed_files(tmp_path):
    assert not wrong(file_cases(range(25), 77, tmp_path))


def test_power_cuts(tmp_path):
    cases = list(kills.cuts(range(1), 77, tmp_path))
    assert not wrong(cases)
    assert [case.came for case in cases] == ["resumed"] * len(kills.COMMANDS)


def test_the_same_measurement_in_other_words(tmp_path):
    with Bench() as bench:
        told = [
            *numerics.told_otherwise(bench, tmp_path / "one", 77, measurement, numerics.SINGLE, OTHERWISE),
            *numerics.told_otherwise(bench, tmp_path / "two", 77, coupled_record, numerics.COUPLED, [AXES_BACKWARDS]),
            numerics.thinned(bench, tmp_path / "thinned", 77),
        ]
        wholly = Telling("wholly", ("ms", "kV", "m"), {"u": "drive"}, {"x": "piezo"}, "records", clock=-7200.0)
        (diagnosis,) = numerics.diagnosed_otherwise(bench, tmp_path, 77, [wholly])
    assert not wrong([*told, diagnosis]) and diagnosis.came == "missing"


def test_a_full_disk(tmp_path, monkeypatch):
    full = [around for around in surroundings.SURROUNDINGS if around.name == "full disk"]
    monkeypatch.setattr(surroundings, "SURROUNDINGS", full)
    assert not wrong(surroundings.in_all("fleet", 77, tmp_path))


@pytest.mark.parametrize(
    ("code", "message", "fault"),
    [
        (2, "Error: a.csv: row 3 holds 'x'\n  delete it", None),
        (1, "Error: a.csv: row 3 holds 'x'\n  delete it", "exit code 1"),
        (2, "Error: a.csv: KeyError: 'x'\n  delete it", "Python: KeyError"),
        (2, "Error: row 3 holds 'x'\n  delete it", "names no file"),
        (2, "Error: a.csv: row 3\n  delete it", "does not show \"'x'\""),
        (2, "Error: a.csv: row 3 holds 'x'", "names no remedy"),
        (None, "hangs", "hangs"),
    ],
)
def test_a_refusal_is_judged(code, message, fault):
    assert list(faults_of(Ended(code, message), ["a.csv"], "'x'")) == ([fault] if fault else [])


def slow(seconds):
    import os
    import time

    time.sleep(seconds)
    os._exit(3)


def test_what_hangs_or_dies_is_told():
    with Bench(patience=1.0) as bench:
        assert bench.call(slow, 9) == Ended(None, "hangs")
    with Bench() as bench:
        assert bench.call(slow, 0) == Ended(None, "its process died")


def test_every_dependency_has_an_oldest_version():
    lines = list(versions.oldest())
    assert "numpy==2.0" in lines and len(lines) > 20
    assert all(np.prod([part.isdigit() for part in line.partition("==")[2].split(".")]) for line in lines)
