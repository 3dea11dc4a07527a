"""Mechanics that do not ring in an adequate model stand in for a lag."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import stage
from pzt_ident.diagnosis import damped
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.criteria import adequate
from pzt_ident.diagnosis.damped import exchange_damped
from pzt_ident.diagnosis.fit import fit_at
from pzt_ident.diagnosis.refit import refit
from pzt_ident.diagnosis.staircase import improve
from pzt_ident.diagnosis.starts import first_fit
from pzt_ident.diagnosis.undetermined import mode_that_is_silent
from pzt_ident.model.registry import blocks

BLOCKS = ("bouc_wen", "lumped")
MOST = blocks["resonance"].parameters()["damping"].bounds[1]
RINGING = np.repeat([0.0, 40.0, 10.0, 60.0, 0.0], 200)


def stiff(parameters, fixed=None):
    """A stage without mechanics, and a model that has some."""
    return stage.case(parameters, fixed).with_words(BLOCKS)


@pytest.mark.parametrize("effect", ["sensor_lag", "amplifier_lag"])
def test_a_lag_is_named_in_the_place_of_mechanics_that_do_not_ring(effect):
    case = stiff(stage.EFFECTS[effect])
    first = first_fit(case, 0)
    mode = mode_that_is_silent(first)
    assert adequate(case, first, first) and mode.damping > MOST
    found = improve(case, first)
    assert found.last.verdict == "adequate" and [step.change for step in found.steps] == ["", "without lumped", ""]
    assert effect in {item.partition(".")[0] for item in found.steps[-1].tied}
    assert [suspect.effect for suspect in found.suspects] == ["lumped"]
    assert (
        f"at {mode.frequency:.3g} Hz with a damping ratio of {mode.damping:.2g} rings in no record"
        in found.suspects[0].why_not
    )
    assert found.case.words == ("bouc_wen",)


@pytest.mark.parametrize(("share", "ratio", "silent"), [(0.4, 0.25, False), (0.4, 0.35, True), (0.6, 0.25, True)])
def test_a_mode_that_is_damped_or_faster_than_all_samples_rings_in_no_record(share, ratio, silent):
    """share: of the sampling rate."""
    case = stiff({})
    problem, mass = case.problem(()), 0.1
    stiffness = mass * (2 * np.pi * share / case.records[0].dt) ** 2
    lumped = {"mass": mass, "stiffness": stiffness, "damping": 2 * ratio * np.sqrt(stiffness * mass)}
    values = stage.STAGE | {f"lumped.{word}": value for word, value in lumped.items()}
    there = fit_at((), problem, problem.unit_point(values))
    assert bool(mode_that_is_silent(there)) == silent


def test_a_lag_in_their_place_is_joined_with_one_that_was_there():
    """An amplifier of two poles is no lag of one pole and a delay."""
    values = {"amplifier_lag.tau": 0.03, "amplifier_lag.damping": 1.0}
    made = stage.records(values, model=("bouc_wen", "amplifier_lag.two_poles"), noise=stage.NOISE / 2, effects={})
    case = Case(BLOCKS, (), made, {})
    first = first_fit(case, 0)
    end = refit(case, first, ("amplifier_lag",), {"amplifier_lag.tau": 0.03})
    assert adequate(case, first, end) and mode_that_is_silent(end)
    steps, mechanics = exchange_damped(case, first, end)
    assert mechanics.effect == "lumped" and steps[-1].fit.effects == ("amplifier_lag.two_poles",)
    assert steps[-1].fit.total < end.total


def test_mechanics_that_ring_are_kept():
    case = stage.case(model=BLOCKS, drives=[RINGING, 0.8 * RINGING], dt=2e-5)
    first = first_fit(case, 0)
    assert adequate(case, first, first) and mode_that_is_silent(first) is None
    assert exchange_damped(case, first, first) is None


@pytest.mark.parametrize("fixed", ["lumped.mass", "lumped.damping", "lumped.stiffness"])
def test_mechanics_of_which_the_job_knows_something_are_kept(fixed):
    case = stiff(stage.EFFECTS["sensor_lag"])
    first = first_fit(case, 0)
    known = stiff(stage.EFFECTS["sensor_lag"], {fixed: first.values[fixed]})
    assert mode_that_is_silent(first_fit(known, 0)) is None


def test_mechanics_that_an_effect_acts_in_are_kept():
    case = stiff(stage.EFFECTS["sensor_lag"])
    first = first_fit(case, 0)
    damping = replace(first, effects=("viscous_damping",))
    assert mode_that_is_silent(damping) and exchange_damped(case, first, damping) is None


def test_mechanics_that_take_up_nothing_are_kept():
    case = stiff({})
    first = first_fit(case, 0)
    assert exchange_damped(case, first, first) is None


@pytest.mark.parametrize(("times", "exchanged"), [(1.05, True), (1.15, False)])
def test_mechanics_are_kept_where_an_effect_in_their_place_fits_worse_though_adequately(monkeypatch, times, exchanged):
    """As a mode above half of the sampling rate in the place of one."""
    case = stiff(stage.EFFECTS["sensor_lag"])
    first = first_fit(case, 0)
    worse = replace(first, effects=("resonance",), identify=times * first.identify, validate=times * first.validate)
    assert adequate(case, first, worse)
    monkeypatch.setattr(damped, "fits_like_a_damper", lambda lean, start: [worse])
    assert bool(exchange_damped(case, first, first)) == exchanged


def test_a_mode_is_no_account_of_mechanics_that_do_not_ring(monkeypatch):
    scored = []
    scores = lambda word: scored.append(word) or []  # noqa: E731
    monkeypatch.setattr(damped, "scorer_of", lambda case, fit: SimpleNamespace(scores=scores))
    case = stiff({})
    assert list(damped.fits_like_a_damper(case, SimpleNamespace(effects=()))) == []
    assert {*scored} == {*blocks["viscous_damping"].look_alikes} - {"resonance"}
