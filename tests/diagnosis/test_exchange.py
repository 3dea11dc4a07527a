"""What is exchanged for another form, and what is not."""

from dataclasses import replace
from types import SimpleNamespace

import pytest

import made_fits
import stage
from pzt_ident.diagnosis import exchange
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.exchange import exchange_limits, forms_instead, in_its_limit
from pzt_ident.diagnosis.fit import fit_at
from pzt_ident.diagnosis.limit import own_bounds
from pzt_ident.diagnosis.refit import refit
from pzt_ident.diagnosis.starts import first_fit


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


@pytest.mark.parametrize("on_bound", [True, False])
def test_a_drift_whose_time_is_on_its_bound_is_a_ramp_where_that_fits_as_well(on_bound, monkeypatch):
    made = stage.records({}, dt=5e-5)
    late = [replace(record, response=record.response + 1e-6 * record.time) for record in made]
    case = Case(("bouc_wen",), (), late, stage.specs({}))
    first, problem = first_fit(case, 0), case.problem(("drift",))
    now = fit_at(("drift",), problem, problem.unit_point(first.values | {"drift.tau": 1.0 if on_bound else 30.0}))
    resting = {"drift": ("drift.tau",)} if on_bound else {}
    monkeypatch.setattr(exchange, "own_bounds", lambda fit, effect: resting.get(effect, ()))
    steps = exchange_limits(case, first, now)
    assert [(step.added, step.removed) for step in steps] == ([("drift.ramp", "drift")] if on_bound else [])
    assert all(step.fit.total < 1.01 * now.total for step in steps)


@pytest.mark.parametrize(("share", "simpler"), [(0.8, True), (0.5, False)])
def test_a_filter_on_the_end_of_its_shapes_is_one_of_fewer_poles_where_that_fits_as_well(share, simpler):
    """It is in no limit there, and no form of more parameters takes its place."""
    case = stage.case({"sensor_lag.tau": 0.03})
    first, item = first_fit(case, 0), "sensor_lag.third_order"
    problem = case.problem((item,))
    values = {"sensor_lag.tau": 0.03, "sensor_lag.share": share, "sensor_lag.damping": 0.7}
    now = fit_at((item,), problem, problem.unit_point(first.values | values))
    assert not own_bounds(now, item)
    steps = exchange_limits(case, first, now)
    assert [step.added for step in steps] == (["sensor_lag"] if simpler else [])


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


@pytest.mark.parametrize(("left", "kept"), [(0.996, False), (0.99, True)])
def test_a_form_that_may_contain_an_effect_at_the_noise_is_its_rival_where_it_fits_better(left, kept, monkeypatch):
    """A reading of three poles may be all that a delay of one number stands for."""
    now = made_fits.fit(1.0, 1.0, ["cubic_stiffness", "delay"])
    rival = made_fits.fit(left, left, ["cubic_stiffness", "sensor_lag.third_order"], dimensions=6)
    monkeypatch.setattr(exchange, "look_alikes", lambda *arguments: ["sensor_lag"])
    monkeypatch.setattr(exchange, "fits_in_place", lambda *arguments, as_rivals: [rival])
    found = exchange.rivals_in_place(made_fits.CASE, now, "delay", (), in_every_form=True)
    assert found == ([rival] if kept else [])


@pytest.mark.parametrize(
    ("lower", "taken"),
    [
        ({}, True),
        ({"total": 1.1}, False),
        ({"freedom": 3}, False),
        ({"validate": 2.0}, False),
        ({"effects": ("creep", "drift")}, False),
    ],
)
@pytest.mark.parametrize("bound", ["adequate", "limit", None])
def test_a_look_alike_takes_the_place_only_where_it_could_have_been_added(monkeypatch, lower, taken, bound):
    """Not where it rests in a limit or leaves a model above the noise, whose ties an error of a fit may tell from."""
    now = SimpleNamespace(effects=("creep", "amplifier_lag"), total=1.16, identify=1.16, validate=1.16, freedom=2)
    other = SimpleNamespace(**vars(now) | {"effects": ("creep", "delay"), "total": 0.98, "validate": 0.98} | lower)
    monkeypatch.setattr(exchange, "adequate", lambda *arguments: bound != "adequate")
    monkeypatch.setattr(exchange, "in_its_limit", lambda *arguments: bound == "limit")
    found = exchange.lower_rival(SimpleNamespace(floor=1.0), None, now, "amplifier_lag", [other])
    assert (found is other) == (taken and bound is None)


@pytest.mark.parametrize("floors", [27.0, 1800.0])
def test_far_above_the_noise_what_a_rounding_tells_apart_is_no_better(monkeypatch, floors):
    now = SimpleNamespace(effects=("amplifier_lag",), total=floors, identify=floors, validate=floors, freedom=2)
    other = SimpleNamespace(**vars(now) | {"effects": ("delay",), "total": 0.9998 * floors, "validate": 0.99 * floors})
    monkeypatch.setattr(exchange, "adequate", lambda *arguments: True)
    monkeypatch.setattr(exchange, "in_its_limit", lambda *arguments: False)
    assert exchange.lower_rival(SimpleNamespace(floor=1.0), None, now, "amplifier_lag", [other]) is None
