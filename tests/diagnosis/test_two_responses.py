"""Two responses of one drive: a ferroelectric's polarization and displacement, whose loops depend on the rate."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.next_experiment import DriveLimits, drives_of, propose
from pzt_ident.diagnosis.refit import refit
from pzt_ident.diagnosis.starts import first_fit
from pzt_ident.diagnosis.verdict import diagnose
from pzt_ident.engine.simulator import Simulator
from pzt_ident.model.registry import blocks
from rig import path, record

FIXED = {"remanence": 5000.0, "spread": 0.3, "interaction": 200.0, "bias": 0.0, "poled": -3000.0}
SHARED = tuple(f"homogenized_energy.{word}" for word in (*FIXED, "coercive", "fluctuation"))
TRUE = {"coercive": 900.0, "fluctuation": 45.0}
OWN = {"p": {"gain": 4e-7, "quadratic": 0.0}, "d": {"gain": 1e-9, "quadratic": 5e-14}}
LEFT = {"thermal_relaxation", "creep", "amplifier_lag", "quadratic_gain"}


@pytest.fixture(scope="module")
def case():
    """1 and 0.1 Hz to identify, 0.01 Hz to validate; noise of 1/1000 of each response."""
    known = {f"homogenized_energy.{word}": value for word, value in FIXED.items()}
    known |= {"p.homogenized_energy.quadratic": 0.0, "d.homogenized_energy.quadratic": 5e-5}  # nm/V^2
    specs = {name: SimpleNamespace(bounds=None, value=value) for name, value in known.items()}
    specs["homogenized_energy.coercive"] = SimpleNamespace(bounds=(300.0, 3000.0), value=None)
    ruled_out = [word for word in blocks.effects() if word not in LEFT]
    blank_case = Case(["homogenized_energy"], (), [blank(hertz) for hertz in (1, 0.1, 0.01)], specs, ruled_out, SHARED)
    problem, rng = blank_case.problem(("thermal_relaxation",)), np.random.default_rng(3)
    theta = [(FIXED | TRUE | OWN["pd"[entry.axis]])[entry.word] for entry in problem.model.entries]
    records = []
    for blank_record in blank_case.records:
        clean = Simulator(problem.model, blank_record).simulate(np.array(theta))[0]
        noise = 1e-3 * np.ptp(clean, axis=1, keepdims=True) * rng.normal(size=clean.shape)
        records.append(replace(blank_record, response=clean + noise))
    return Case(blank_case.words, (), records, specs, ruled_out, SHARED)


@pytest.fixture(scope="module")
def first(case):
    return first_fit(case, 1)


def blank(hertz):
    drive = path(0, 1500, -1500, 0, points=40)
    one = record(drive, drive, dt=1 / (hertz * drive.size), run_in=1)
    use = "validate" if hertz == 0.01 else "identify"
    return replace(one, use=use, axes=("p", "d"), response_units=("uC/cm2", "nm"))


def test_thermal_relaxation_is_named_and_the_rate_left_out_foreseen(case, first):
    diagnosis = diagnose(case, first)
    assert (diagnosis.verdict, diagnosis.best.score.effect) == ("missing", "thermal_relaxation")
    assert diagnosis.best.fit.values["homogenized_energy.fluctuation"] == pytest.approx(45, rel=0.05)
    assert diagnosis.best.fit.validate < 0.05 * first.validate


def test_what_moves_two_responses_is_proposed_as_one_drive(case, first):
    assert drives_of(case.records).tolist() == [0, 0]
    rivals = {"as given": first, "thermal_relaxation": refit(case, first, ("thermal_relaxation",), {})}
    proposal = propose(case, rivals, [DriveLimits(-1500.0, 1500.0, 6000.0, 0.4)] * 2)
    assert np.array_equal(*proposal.drive)
    assert 1 < proposal.separation < 1e4
