"""What two effects leave is not given to one that contains the other."""

from dataclasses import replace

import pytest

import made_fits
import stage
from pzt_ident.diagnosis import exchange
from pzt_ident.diagnosis import refit as refitting
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.exchange import (
    exchange_limits,
    forms_instead,
    in_its_limit,
    join_look_alikes,
    parts_of,
    separate_accounts,
)
from pzt_ident.diagnosis.fit import fit_at
from pzt_ident.diagnosis.refit import refit
from pzt_ident.diagnosis.starts import first_fit
from pzt_ident.model.registry import blocks, word_of

RUBBING = {"friction.force": 0.6e-6, "friction.reach": 0.4e-6, "friction.stiction": 0.3, "friction.stribeck": 20e-6}
VISCOUS = "friction.lugre_viscous"


def with_viscous_friction(late):
    """A case of a stage that rubs, with what `late` says, its first fit, and that with viscous friction."""
    effects = ("friction", "delay") if "delay.time" in late else (VISCOUS,)
    made = stage.records(RUBBING | late, model=("bouc_wen", *effects), noise=stage.NOISE / 2)
    case = Case(("bouc_wen",), (), made, {})
    problem = case.problem(())
    first = fit_at((), problem, case.descend(problem, problem.unit_point(stage.STAGE)))
    return case, first, refit(case, first, (VISCOUS,), {"friction.viscous": 0.01} | RUBBING)


def test_a_delay_that_viscous_friction_stood_in_for_is_told_beside_friction():
    case, first, now = with_viscous_friction({"delay.time": 0.012})
    steps = separate_accounts(case, first, now)
    assert [(step.added, step.removed) for step in steps] == [("friction", VISCOUS), ("delay", None)]
    end = steps[-1].fit
    assert end.values["delay.time"] == pytest.approx(0.012, rel=0.05)
    assert end.identify < now.identify / 2


@pytest.mark.parametrize("tau", [3e-3, 3e-4])
def test_a_form_that_holds_a_lag_begins_with_it(tau, monkeypatch):
    """To a factor of three, however small the lag is beside what the catalogue has for friction."""
    values = stage.STAGE | RUBBING | {"sensor_lag.tau": tau}
    made = stage.records(values, model=("bouc_wen", "friction", "sensor_lag"), dt=1e-4, effects={})
    case = Case(("bouc_wen",), (), made, {})
    problem, begun = case.problem(("friction", "sensor_lag")), {}
    now = fit_at(("friction", "sensor_lag"), problem, problem.unit_point(values))
    monkeypatch.setattr(refitting, "refit", lambda case, now, effects, guess: begun.update(guess))
    refitting.refit_holding(case, now, (VISCOUS,))
    assert tau / 3 <= begun["friction.viscous"] <= 3 * tau


def test_viscous_friction_is_one_effect():
    case, first, now = with_viscous_friction({"friction.viscous": 0.02})
    assert separate_accounts(case, first, now) == []


@pytest.mark.parametrize(
    ("stage_has", "values", "joined"),
    [
        (("amplifier_lag.two_poles",), {"amplifier_lag.tau": 0.03, "amplifier_lag.damping": 1.0}, True),
        (("amplifier_lag", "delay"), {"amplifier_lag.tau": 0.01, "delay.time": 0.03}, False),
    ],
)
def test_a_lag_of_two_poles_is_one_effect_and_a_lag_behind_a_delay_is_two(stage_has, values, joined):
    made = stage.records(values, model=("bouc_wen", *stage_has), noise=stage.NOISE / 2, effects={})
    case = Case(("bouc_wen",), (), made, {})
    problem = case.problem(())
    first = fit_at((), problem, case.descend(problem, problem.unit_point(stage.STAGE)))
    now = refit(case, first, ("amplifier_lag", "delay"), {"amplifier_lag.tau": 0.02, "delay.time": 0.01})
    steps = join_look_alikes(case, first, now)
    told = [(None, "delay"), ("amplifier_lag.two_poles", "amplifier_lag")]
    assert [(step.added, step.removed) for step in steps] == (told if joined else [])
    assert not joined or steps[-1].fit.total < now.total


@pytest.mark.parametrize(
    ("stage_has", "values", "instead"),
    [
        (("amplifier_lag.two_poles",), {"amplifier_lag.tau": 0.03, "amplifier_lag.damping": 1.0}, True),
        (("amplifier_lag", "quadratic_gain"), {"amplifier_lag.tau": 0.03, "quadratic_gain.curvature": 3e-4}, False),
    ],
)
def test_what_made_up_for_a_form_is_taken_out_where_that_form_does_as_well(stage_has, values, instead):
    made = stage.records(values, model=("bouc_wen", *stage_has), effects={})
    case = Case(("bouc_wen",), (), made, {})
    problem = case.problem(())
    first = fit_at((), problem, case.descend(problem, problem.unit_point(stage.STAGE)))
    found = refit(case, first, ("amplifier_lag", "quadratic_gain"), {"amplifier_lag.tau": 0.03})
    steps = forms_instead(case, first, replace(found, identify=case.floor, validate=case.floor))
    told = [(None, "quadratic_gain"), ("amplifier_lag.two_poles", "amplifier_lag")]
    assert [(step.added, step.removed) for step in steps] == (told if instead else [])
    assert not instead or steps[-1].fit.total < 1.1 * case.floor


@pytest.fixture(scope="module")
def rubbing_late():
    return with_viscous_friction({"delay.time": 0.012})


@pytest.mark.parametrize("item", [item for word in blocks.effects() for item in blocks.forms(word)])
def test_the_parts_of_a_form_are_what_it_contains_and_look_alikes_of_that_and_nothing_the_model_has(rubbing_late, item):
    case, _, now = rubbing_late
    parts = parts_of(case, now, item)
    assert bool(parts) == bool(blocks[item].contains)
    assert not {*parts} & {*map(word_of, now.effects)}


@pytest.mark.parametrize("on_bound", [True, False])
def test_a_drift_whose_time_is_on_its_bound_is_a_ramp_where_that_fits_as_well(on_bound, monkeypatch):
    made = stage.records({}, dt=5e-5)
    late = [replace(record, response=record.response + 1e-6 * record.time) for record in made]
    case = Case(("bouc_wen",), (), late, stage.specs({}))
    first, problem = first_fit(case, 0), case.problem(("drift",))
    now = fit_at(("drift",), problem, problem.unit_point(first.values | {"drift.tau": 1.0}))
    resting = {"drift": ("drift.tau",)} if on_bound else {}
    monkeypatch.setattr(exchange, "own_bounds", lambda fit, effect: resting.get(effect, ()))
    steps = exchange_limits(case, first, now)
    assert [(step.added, step.removed) for step in steps] == ([("drift.ramp", "drift")] if on_bound else [])
    assert all(step.fit.total < 1.01 * now.total for step in steps)


@pytest.mark.parametrize(("place", "worse", "in_limit"), [(1.0, 1.09, True), (1.0, 1.11, False), (0.5, 1.09, False)])
def test_nothing_is_exchanged_for_an_effect_on_its_own_bound_that_is_hardly_better(place, worse, in_limit):
    """A cyclic error whose pitch is the stroke is a bend."""
    bend, encoder = (
        made_fits.fit(4.0 * worse, 4.0 * worse, ["quadratic_gain"]),
        made_fits.fit(4.0, 4.0, ["encoder_cyclic_error"], own=[place]),
    )
    assert in_its_limit(bend, encoder) == in_limit


def test_nothing_is_exchanged_for_an_effect_in_a_declared_limit():
    bend, friction = (
        made_fits.fit(6.0, 6.0, ["quadratic_gain"]),
        made_fits.fit(2.0, 2.0, ["friction"], own=[0.0], limit="a play"),
    )
    assert in_its_limit(bend, friction)
