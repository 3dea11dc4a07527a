"""Modes that rest elsewhere: where the samples look alike, or where the mechanics stand in for something."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import stage
from pzt_ident.diagnosis import exchange, forms
from pzt_ident.diagnosis.bounds import Widened
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.fit import fit_at
from pzt_ident.diagnosis.modes import (
    mechanics_at_main_mode,
    mechanics_at_second_mode,
    with_aliases,
    with_modes_exchanged,
)
from pzt_ident.diagnosis.refit import refit, start_of
from pzt_ident.diagnosis.score import Score
from pzt_ident.diagnosis.second_mode import exchange_main_mode, exchange_second_mode
from pzt_ident.diagnosis.staircase import improve
from pzt_ident.diagnosis.starts import best_alias
from pzt_ident.job.sections import Choice
from pzt_ident.search.cube import FixedValue

SECOND = {"resonance.share": 0.8, "resonance.frequency": 300.0, "resonance.damping": 0.02}
SLOW = {"lumped.mass": 0.1, "lumped.damping": 3e3, "lumped.stiffness": 1e6}
MODE = 2 * np.pi * 300
STIFFNESS = (1e5, 1e9)  # its bounds
MODAL = Choice("modal", {"modes": 2})


def fit_with(case, values, form="resonance"):
    problem = case.problem((form,))
    middle = dict(zip(problem.names, problem.physical(np.full(problem.dimensions, 0.5))[0], strict=True))
    known = {name: value for name, value in (stage.STAGE | values).items() if name in problem.names}
    return fit_at((form,), problem, problem.unit_point(middle | known))


@pytest.mark.parametrize("form", ["resonance", "resonance.series"])
@pytest.mark.parametrize(
    ("fixed", "before", "mass"),
    [
        ({}, 0.1, 0.1),
        ({"lumped.stiffness": 1e6}, 0.1, 1e6 / MODE**2),
        ({}, 0.02, STIFFNESS[0] / MODE**2),
    ],
)
def test_a_refit_without_the_main_mode_starts_with_the_mechanics_there(form, fixed, before, mass):
    free = stage.case(model=("bouc_wen", "lumped"))
    case = free.with_specs({"lumped.stiffness": Widened(STIFFNESS)} | stage.specs(fixed))
    problem = case.problem(())
    start = problem.physical(start_of(problem, fit_with(case, SLOW | SECOND | {"lumped.mass": before}, form), {}))[0]
    found = fixed | dict(zip(problem.names, start, strict=True))
    assert found["lumped.mass"] == pytest.approx(mass)
    assert found["lumped.stiffness"] == pytest.approx(mass * MODE**2)
    assert found["lumped.damping"] == pytest.approx(2 * 0.02 * mass * MODE)


@pytest.mark.parametrize(("frequency", "number"), [(430.0, 1), (1200.0, 2)])
def test_a_second_mode_of_a_model_without_mechanics_is_the_nearest_of_these(frequency, number):
    """A saturation beside a mode that the job has was a saturation and a second mode of a model without any: with two
    modes as given, of which one rested on bounds, nothing had fitted."""
    case = Case(("bouc_wen", MODAL), (), stage.records({}), stage.specs({"bouc_wen.gain": 0.08}))
    modes = {"frequency_1": 400.0, "frequency_2": 1600.0, "damping_1": 0.02, "damping_2": 0.3}
    given = fit_with(case, {f"modal.{word}": value for word, value in modes.items()}, "saturation")
    without = fit_with(stage.case(), {"resonance.frequency": frequency, "resonance.damping": 0.05})
    effects, there = mechanics_at_second_mode(without, given)
    assert effects == ()
    assert there == pytest.approx({f"modal.frequency_{number}": frequency, f"modal.damping_{number}": 0.05})


@pytest.mark.parametrize("share", [0.5, -0.8])
def test_a_mode_that_carries_less_is_no_main_mode(share):
    case = stage.case(model=("bouc_wen", "lumped"))
    assert mechanics_at_main_mode(fit_with(case, SLOW | SECOND | {"resonance.share": share})) == {}


def test_a_mode_that_stays_leaves_the_mechanics_where_they_are():
    case = stage.case(model=("bouc_wen", "lumped"))
    fit = fit_with(case, SLOW | SECOND)
    assert mechanics_at_main_mode(fit, fit.problem.names) == {}


def test_what_the_mechanics_stood_in_for_takes_the_place_of_the_main_mode():
    """A slow sensor on a stage that rings: overdamped mechanics have its lag, and a second mode rings."""
    drives = [np.random.default_rng(seed).normal(0, 12, 120).repeat(25) + 50 for seed in (1, 2)]
    lag = {"sensor_lag.tau": 4e-4}
    free = stage.case(lag, model=("bouc_wen", "lumped"), drives=drives, dt=4e-5, steps=1)
    case = free.with_specs({"lumped.stiffness": Widened(STIFFNESS)})
    ringing = {"resonance.share": 0.8, "resonance.frequency": 3438.0, "resonance.damping": 0.0108}
    slow = {"lumped.mass": 0.02, "lumped.stiffness": 1e7, "lumped.damping": 4e-4 * 1e7}
    first = refit(case, fit_with(case, slow | ringing), (), {})
    found = fit_with(case, slow | ringing, "resonance.series")
    now = replace(found, identify=1.3 * stage.NOISE, validate=1.3 * stage.NOISE)  # as if nothing else fitted as well
    (step,) = exchange_main_mode(case, first, now)
    assert (step.removed, step.added) == ("resonance.series", "sensor_lag")
    assert step.fit.identify < 1.3 * stage.NOISE < 0.2 * first.identify


def test_a_second_mode_that_is_the_mode_of_the_mechanics_is_taken_out():
    """641 Hz, sampled at 500 Hz: the mechanics rest elsewhere, and a second mode where the samples look alike."""

    def at(frequency, damping):
        pace = 2 * np.pi * frequency
        return {"lumped.mass": 1e6 / pace**2, "lumped.damping": 2 * damping * 1e6 / pace, "lumped.stiffness": 1e6}

    drives = [np.random.default_rng(seed).normal(0, 12, 60).repeat(25) + 50 for seed in (1, 2)]
    fixed = {"lumped.stiffness": 1e6}
    case = stage.case(at(641, 0.01), fixed, model=("bouc_wen", "lumped"), drives=drives, dt=2e-3, steps=16)
    second = {"resonance.share": -0.15, "resonance.frequency": 359.0, "resonance.damping": 0.02}
    found = fit_with(case, {"bouc_wen.gain": 0.082} | at(499, 0.03) | second)  # um/V
    now = replace(found, identify=case.floor, validate=case.floor)  # as if it fitted as well
    (step,) = exchange_second_mode(case, replace(now, effects=()), now)
    assert (step.removed, step.added) == ("resonance", None)
    assert step.fit.values["lumped.mass"] == pytest.approx(at(641, 0.01)["lumped.mass"], rel=0.02)


@pytest.mark.parametrize("rest", [415.0, 585.0, 1085.0])
def test_a_mode_that_rests_where_the_samples_look_alike_is_found_where_it_is(rest):
    """85 Hz, sampled at 500 Hz."""
    stage_of_85 = {"lumped.mass": 1e6 / (2 * np.pi * 85) ** 2, "lumped.damping": 40.0, "lumped.stiffness": 1e6}
    case = stage.case(stage_of_85, model=("bouc_wen", "lumped"), fixed={"lumped.stiffness": 1e6}, dt=2e-3, steps=1)
    problem, mass = case.problem(()), 1e6 / (2 * np.pi * rest) ** 2
    values = stage.STAGE | {"lumped.mass": mass, "lumped.damping": 0.01 * 2 * np.sqrt(1e6 * mass)}
    point = problem.unit_point({name: values[name] for name in problem.names})
    found = best_alias(case, fit_at((), problem, point))
    assert found.identify == pytest.approx(stage.NOISE, rel=0.1)
    assert found.values["lumped.mass"] == pytest.approx(stage_of_85["lumped.mass"], rel=0.01)


@pytest.mark.parametrize(("frequency", "others"), [(146.8, [53.2, 253.2, 346.8]), (20.0, [])])
def test_a_mode_has_aliases_where_it_has_few_samples_a_period(frequency, others):
    """At 200 Hz; of modes that many samples show none is looked for."""
    values = {"modal.frequency_1": 12.0, "modal.frequency_2": frequency, "modal.damping_1": 0.05}
    case = Case(("bouc_wen", MODAL), (), stage.records({}, dt=5e-3), stage.specs({"bouc_wen.gain": 0.08}))
    fit = fit_with(case, values | {"modal.shape_1": 1.1, "modal.shape_2": -0.1}, "creep")
    found = with_aliases(fit)
    assert sorted(point["modal.frequency_2"] for point in found) == pytest.approx(others)
    assert all(point["modal.frequency_1"] == pytest.approx(12.0) for point in found)


SOFT = {"lumped.mass": 0.3, "lumped.stiffness": 0.3 * (2 * np.pi * 60) ** 2, "lumped.damping": 2 * 0.03 * 0.3 * 377}


def ringing():
    """A stage of a known mass whose resonance two chirps cross."""
    t = np.arange(3000) * 1e-3
    chirps = [50 + reach * np.sin(2 * np.pi * (10 + 20 * t) * t) for reach in (30, 20)]
    fixed = {"lumped.mass": SOFT["lumped.mass"]}
    return stage.case(SOFT, fixed, model=("bouc_wen", "lumped"), drives=chirps, dt=1e-3, steps=1)


@pytest.mark.parametrize("mass", [FixedValue(SOFT["lumped.mass"]), Widened((0.25, 0.5))])
def test_a_payload_on_a_mass_that_is_known_or_bounded_is_a_softer_stage(mass):
    case = ringing().with_specs({"lumped.mass": mass})
    heavy = SOFT | {"lumped.load": 2.7, "lumped.stiffness": 10 * SOFT["lumped.stiffness"], "lumped.damping": 68.0}
    fit = fit_with(case, heavy, "load_mass")
    problem = case.problem(())
    start = start_of(problem, fit, {})
    assert problem.loss(start)[0] == pytest.approx(fit.identify, rel=1e-9)


def test_what_leads_out_of_a_side_minimum_is_no_payload():
    case = stage.considering(ringing(), "load_mass", "viscous_damping", "quadratic_gain")
    problem = case.problem(())
    overdamped = problem.unit_point(stage.STAGE | {"lumped.damping": 9e3, "lumped.stiffness": 1e6})
    first = fit_at((), problem, case.descend(problem, overdamped))
    assert first.identify > 10 * stage.NOISE
    found = improve(case, first)
    assert found.last.verdict == "adequate" and [step.added for step in found.steps] == [None]
    assert found.steps[-1].fit.values["lumped.stiffness"] == pytest.approx(SOFT["lumped.stiffness"], rel=0.01)


TWO = {"lumped.mass": 0.1, "lumped.stiffness": 0.1 * (2 * np.pi * 140) ** 2, "lumped.damping": 2.0}
OTHER = {"resonance.share": 0.6, "resonance.frequency": 260.0, "resonance.damping": 0.03}


def struck(values, form):
    """A stage of two modes, which ring in two records of steps."""
    drives = [np.random.default_rng(seed).normal(0, 12, 60).repeat(50) + 50 for seed in (1, 2)]
    return stage.case(values, model=("bouc_wen", "lumped", form), drives=drives, dt=2e-4, effects={}).with_words(
        ("bouc_wen", "lumped")
    )


def test_modes_in_parallel_that_are_exchanged_respond_alike():
    case = struck(TWO | OTHER, "resonance")
    fit = fit_with(case, TWO | OTHER)
    (exchanged,) = with_modes_exchanged(fit)
    assert exchanged.values["resonance.frequency"] == pytest.approx(140)
    assert exchanged.values["resonance.share"] == pytest.approx(0.4)
    there, here = (each.problem.residuals(each.point)[0] for each in (exchanged, fit))
    assert np.abs(there - here).max() < 1e-6 * np.abs(fit.problem.swing)
    assert with_modes_exchanged(refit(case, fit, (), {})) == []


def test_modes_are_exchanged_only_within_their_bounds():
    case = struck(TWO | OTHER, "resonance").with_specs({"resonance.frequency": Widened((200.0, 300.0))})
    assert with_modes_exchanged(fit_with(case, TWO | OTHER)) == []


@pytest.mark.parametrize(("item", "starts"), [("resonance.series", 2), ("sensor_lag", 1)])
def test_another_form_of_a_second_mode_is_tried_with_modes_exchanged(monkeypatch, item, starts):
    """In parallel either may be the second one; in series, the one that the force passes."""
    begun = []

    def refit_from(case, start, effects, *more):
        begun.append(start.values["resonance.frequency"])
        return replace(start, effects=effects)

    fit = fit_with(struck(TWO | OTHER, "resonance"), TWO | OTHER)
    monkeypatch.setattr(forms, "refit", refit_from)
    forms.from_where(None, fit, replace(fit, effects=(item,)), {})
    assert sorted(begun) == pytest.approx([140.0, 260.0][-starts:])


def test_a_form_in_the_place_of_another_is_tried_with_modes_exchanged(monkeypatch):
    tried, fit = [], fit_with(struck(TWO | OTHER, "resonance"), TWO | OTHER)
    scorer = SimpleNamespace(score=lambda item: Score(item, 0.5))
    monkeypatch.setattr(exchange, "refit", lambda case, start, effects, guess: start)
    monkeypatch.setattr(exchange, "refit_beside", lambda case, fits, effects, *more: replace(fit, effects=effects))
    monkeypatch.setattr(exchange, "scorer_of", lambda case, fit: scorer)
    monkeypatch.setattr(exchange, "from_modes_exchanged", lambda case, now, fit: tried.append(fit.effects[-1]) or fit)
    exchange.fits_in_place(None, fit, "resonance", ["resonance.series", "load_mass"])
    assert tried == ["resonance.series"]
