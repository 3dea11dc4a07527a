"""Refits that are good enough to blame what is left on the model, and the steps of which they consist."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import stage
from pzt_ident.diagnosis import refit
from pzt_ident.diagnosis.budget import Budget
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.fit import fit_at
from pzt_ident.diagnosis.starts import first_fit
from pzt_ident.engine.simulator import simulate
from pzt_ident.model.block import Block, Place
from pzt_ident.model.parameter import Parameter
from pzt_ident.model.registry import blocks
from pzt_ident.search.descent import descend


def test_a_descent_ends_with_the_budget(plain):
    problem, budget = plain.problem(()), Budget(0.0)
    start = np.full(problem.dimensions, 0.5)
    assert (descend(problem, start, going=budget.lasts) == start).all()
    assert budget.untried == ["settled fits"]


@pytest.mark.parametrize("arrives", [True, False])
def test_behind_a_refit_at_the_noise_no_other_guess_is_tried(creeping, monkeypatch, arrives):
    before, made = first_fit(creeping, 0), refit.refit
    guesses = [{"creep.ratio": 0.05, "creep.tau": 2.0}, {"creep.ratio": 0.01, "creep.tau": 0.5}]
    tried = []

    def noted(case, before, effects, guess, rival=np.inf, other=None):
        tried.append((guess, rival))
        fit = made(case, before, effects, guess, rival, other)
        return fit if arrives else replace(fit, identify=2 * fit.identify, validate=2 * fit.validate)

    monkeypatch.setattr(refit, "refit", noted)
    fit = refit.refit_from(creeping, before, ("creep",), guesses)
    assert [guess for guess, _ in tried] == (guesses[:1] if arrives else guesses)
    assert arrives or tried[1][1] == pytest.approx(fit.identify, rel=0.01)


def test_a_refit_goes_on_from_what_was_found(creeping):
    before = first_fit(creeping, 0)
    after = refit.refit(creeping, before, ("creep",), {"creep.ratio": 0.05, "creep.tau": 2.0})
    assert after.effects == ("creep",)
    assert after.values["creep.ratio"] == pytest.approx(0.08, rel=0.15)
    assert after.identify == pytest.approx(stage.NOISE, rel=0.1)
    assert before.identify > 3 * after.identify
    back = refit.refit(creeping, after, (), {})
    assert back.identify == pytest.approx(before.identify, rel=1e-3)


@pytest.mark.parametrize("guess", [{"creep.ratio": 0.4, "creep.tau": 0.01}, {"creep.ratio": 0.4, "creep.tau": 0.5}])
def test_a_model_with_an_effect_fits_no_worse_than_without_it_wherever_a_guess_leads(creeping, monkeypatch, guess):
    """A descent rests where it starts; from there it goes on on the way to the fit without the effect."""
    before = first_fit(creeping, 0)
    monkeypatch.setattr(Case, "descend", lambda case, problem, start, rival=np.inf: start)
    problem = creeping.problem(("creep",))
    astray = fit_at(("creep",), problem, refit.start_of(problem, before, guess))
    found = refit.refit(creeping, before, ("creep",), guess)
    assert astray.identify > 1.5 * before.identify
    assert found.identify <= (1 + 1e-6) * before.identify
    assert found.values["creep.tau"] == pytest.approx(guess["creep.tau"])


@pytest.mark.parametrize("times", [2.0, 5.0, 10.0])
def test_a_payload_begins_where_the_resonance_is_that_it_moves(times):
    """Not at a guess that is too large, nor at nothing, where no slope leads to it."""
    known = {"lumped.mass": 0.15, "lumped.stiffness": 7e7}
    ringing = np.repeat([0.0, 40.0, 10.0, 60.0, 0.0], 200)
    made = {"model": ("bouc_wen", "lumped"), "drives": [ringing, 0.8 * ringing], "dt": 2e-5, "steps": 1}
    case = stage.case({"lumped.load": 0.03}, known, **made)
    before, problem = first_fit(case, 0), case.problem(("load_mass",))
    start = refit.start_on_the_way(problem, before, {"lumped.load": times * 0.03})
    load = dict(zip(problem.names, problem.physical(start)[0], strict=True))["lumped.load"]
    assert load == pytest.approx(0.03, rel=0.2)


@pytest.mark.parametrize("form", ["lag", "soft"])
def test_a_limit_that_no_slope_leads_to_begins_where_the_model_fits_best(form):
    """Beside a lag that is guessed already: below a limit nothing tells that there is one."""
    known, word = {"slew_limit.slowness": 1.6e-3, "slew_limit.tau": 4e-3}, f"slew_limit.{form}"
    case = Case(("bouc_wen",), (), stage.records(known, dt=1e-3, forms=[word], effects=["slew_limit"]), {})
    fit = refit.refit(case, first_fit(case, 0), (word,), known | {"slew_limit.slowness": 0.0})
    assert fit.values["slew_limit.slowness"] == pytest.approx(1.6e-3, rel=0.1)
    assert fit.identify == pytest.approx(stage.NOISE, rel=0.1)


def test_a_refit_without_an_effect_starts_with_what_it_adds_to_another_parameter():
    """Without the payload the moving mass has both, and the same resonance."""
    loaded = stage.case(model=("bouc_wen", "lumped"))
    problem = loaded.problem(("load_mass",))
    names = dict.fromkeys(problem.names, 0.5)
    point = problem.unit_point(names | {"lumped.mass": 0.2, "lumped.load": 1.5})
    before = fit_at(("load_mass",), problem, point)
    without = loaded.problem(())
    start = without.physical(refit.start_of(without, before, {}))[0]
    assert dict(zip(without.names, start, strict=True))["lumped.mass"] == pytest.approx(1.7)


@settings(max_examples=30, deadline=None)
@given(st.lists(st.floats(-0.2, 1.2), min_size=4, max_size=4))
def test_descent_stays_in_the_cube_and_never_climbs(creeping, start):
    problem = creeping.problem(())
    ahead = np.clip(start, 0, 1)
    end = descend(problem, np.array(start), most=6)
    assert np.all((end >= 0) & (end <= 1))
    assert problem.loss(end)[0] <= problem.loss(ahead)[0]


def test_descent_comes_to_rest(creeping):
    problem = creeping.problem(())
    end = first_fit(creeping, 0).point
    gradient = problem.jacobian(end).T @ problem.residuals(end)[0]
    inside = (end > 0) & (end < 1)
    assert np.abs(gradient[inside]).max() < 1e-4 * problem.loss(end)[0] ** 2 / 1e-2


class Failing(Block):
    """Fails above a half."""

    name = "failing"
    place = Place.OUTPUT
    share = Parameter("1", (0, 1), "What it takes to fail.", null=0)
    remedy = separate_by = "none"

    def prepare(share):
        return (share if share < 0.5 else float("nan"),)

    def start(u, share):
        return ()

    def step(u, share):
        return u + share * u


def test_a_descent_from_where_the_simulation_fails_is_no_success(plain, monkeypatch):
    monkeypatch.setitem(blocks._items, "failing", Failing)
    problem = plain.problem(("failing",))
    start = np.array([0.5, 0.5, 0.5, 0.5, 0.9])
    with np.errstate(invalid="ignore"):
        assert problem.loss(descend(problem, start))[0] == np.inf
        inside = descend(problem, np.array([0.5, 0.5, 0.5, 0.5, 0.49]))
    assert np.isfinite(problem.loss(inside)[0])
    assert inside[4] < 0.5


class Coarse(Block):
    """A lag of two samples by Euler's step, which is of first order only."""

    name = "coarse"
    place = Place.SENSOR
    tau = Parameter("s", (0.008, 0.012), "Two samples of the stage.")

    def prepare(tau, dt):
        return (dt / tau,)

    def start(u, share):
        return (u,)

    def step(x, u, share):
        x = x + share * (u - x)
        return x, x


def test_a_finer_step_changes_nothing_of_what_is_exact(plain):
    fit = first_fit(plain, 0)
    assert refit.step_errors(plain, fit).max() < 1e-9 * plain.floor
    assert fit.steps == (1, 1)


def test_a_solver_too_coarse_for_what_is_left_is_blamed_on_no_effect(plain, monkeypatch):
    monkeypatch.setitem(blocks._items, "coarse", Coarse)
    case = Case((*plain.words, "coarse"), (), plain.records, {})
    fit = first_fit(case, 0)
    problem = fit.problem
    response = simulate(problem.model, problem.records[0], problem.parameters(fit.point))[0, 0]
    half_a_step = np.gradient(response) / 2 / refit.FINEST  # by which Euler's lag is too short
    errors = refit.step_errors(case, fit)
    assert fit.steps[0] == refit.FINEST or errors[0] < 0.1 * fit.identify
    assert errors[0] == pytest.approx(np.std(half_a_step), rel=0.1)


def test_a_ripple_between_samples_is_followed_by_finer_steps():
    """43 Hz at 200 Hz: the hysteresis turns at peaks that no sample shows."""
    clean, finer, turn = stage.loops(), 8, 2 * np.pi * 43 * 5e-3 / 8
    between = [np.interp(np.arange(finer * (u.size - 1) + 1) / finer, np.arange(u.size), u) for u in clean]
    drives = [u + 8 * np.sin(turn * np.arange(u.size) + phase) for phase, u in zip((1, 4), between, strict=True)]
    made = zip(stage.records({}, drives, dt=5e-3 / finer), clean, strict=True)
    records = [replace(one, dt=5e-3, drive=u[None], response=one.response[:, ::finer]) for one, u in made]
    case = Case(("bouc_wen",), (), records, {})
    ripple = "periodic_disturbance.ripple"
    fit = refit.refit(case, first_fit(case, 0), (ripple,), {"periodic_disturbance.frequency": 43.0})
    assert fit.identify < 1.05 * stage.NOISE
    assert min(fit.steps) > 1


def test_a_step_that_is_short_for_what_a_fit_leaves_is_kept_until_it_leaves_less(monkeypatch):
    """The second record would change by a 20th of what the fit leaves, several times as much as of the noise."""
    creeping = stage.case(stage.EFFECTS["creep"])
    fit, asked, share = first_fit(creeping, 0), [], 0.05

    def errors(case, fit, numbers):
        asked.append(tuple(numbers))
        return np.array([share * fit.identify if number == 1 else 0.0 for number in asked[-1]])

    monkeypatch.setattr(refit, "step_errors", errors)
    assert share * fit.identify > 2 * refit.STEP_TOLERANCE * creeping.floor
    assert refit.refine_steps(creeping, fit) is fit
    share = 0.15
    assert refit.refine_steps(creeping, fit).steps == (1, refit.FINEST)
    assert asked == [(0, 1), (0, 1), (1,), (1,), ()]  # what has been short enough is not asked about again
    creeping.budget = Budget(0.0)
    monkeypatch.setattr(refit, "step_errors", lambda case, fit, numbers: np.full(len(numbers), fit.identify))
    assert refit.refine_steps(creeping, fit) is fit, "the budget is spent"


def test_no_step_is_refined_of_a_fit_that_stays_far_above_a_rival(monkeypatch):
    creeping = stage.case(stage.EFFECTS["creep"])
    fit = first_fit(creeping, 0)
    monkeypatch.setattr(refit, "step_errors", lambda case, fit, numbers: np.full(len(numbers), 0.2 * fit.identify))
    assert refit.refine_steps(creeping, fit, 0.3 * fit.identify) is fit
    assert refit.refine_steps(creeping, fit, 0.5 * fit.identify) is not fit


@pytest.mark.parametrize(("shares", "refined"), [((0.5, 0.6), 1), ((0.6, 0.5), 2)])
def test_steps_are_refined_of_no_guess_that_leads_no_lower_than_another(monkeypatch, shares, refined):
    """Before either is: the share of what the model as given leaves to which the guesses lead in the first steps."""
    creeping, made = stage.case(stage.EFFECTS["creep"]), []
    before = first_fit(creeping, 0)

    def finer(case, fit, *_):
        made.append(fit)
        return replace(fit, identify=1.1 * fit.identify, validate=1.1 * fit.validate, coarse=fit.identify)

    led = iter(shares)
    monkeypatch.setattr(refit, "refine_steps", finer)
    monkeypatch.setattr(
        refit,
        "fit_at",
        lambda *more, **_: replace(before, identify=(share := next(led)) * before.identify, validate=share),
    )
    monkeypatch.setattr(creeping, "descend", lambda problem, start, rival: start)
    fit = refit.refit_from(creeping, before, (), [{}, {"bouc_wen.gain": before.values["bouc_wen.gain"] * 1.1}])
    assert len(made) == refined
    assert fit.identify == pytest.approx(1.1 * min(shares) * before.identify)


def test_a_lag_within_the_sample_is_told_from_a_delay_by_finer_steps():
    """The voltage between samples, which the mechanics ring with: a lag rounds it, a delay does not."""
    time = 1e-4 * np.arange(2500)
    drives = [50 * (1 - np.cos(2 * np.pi * start * time)) + 3 * np.sin(5e4 * time**2) for start in (10, 13)]
    known = {name: value for name, value in stage.STAGE.items() if name.startswith("lumped")}
    model = ("bouc_wen", "lumped")
    case = stage.case({"amplifier_lag.tau": 2e-5}, known, model=model, drives=drives, dt=1e-4, noise=2e-9, steps=32)
    first = first_fit(case, 0)
    lag, delay = (refit.refit(case, first, (word,), {}) for word in ("amplifier_lag", "delay"))
    assert min(lag.steps) > 1
    assert lag.identify == pytest.approx(2e-9, rel=0.1)
    assert lag.values["amplifier_lag.tau"] == pytest.approx(2e-5, rel=0.02)
    assert delay.total > 1.5 * lag.total
