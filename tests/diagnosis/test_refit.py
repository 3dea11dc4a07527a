"""Fits that are good enough to blame what is left on the model, and the steps of which they consist."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import rig
import stage
from pzt_ident.diagnosis import refit, starts
from pzt_ident.diagnosis.budget import Budget
from pzt_ident.diagnosis.caveats import bounds_sentence, measured_only_sentence
from pzt_ident.diagnosis.refit import Case, fit_at, side_by_side
from pzt_ident.diagnosis.starts import first_fit, restart
from pzt_ident.engine.simulator import simulate
from pzt_ident.model.block import Addition, Block, Coupling, Place
from pzt_ident.model.chain import Chain
from pzt_ident.model.parameter import Parameter
from pzt_ident.model.registry import blocks
from pzt_ident.search.descent import descend
from pzt_ident.search.problem import Problem


@pytest.fixture(scope="module")
def plain():
    return stage.case()


@pytest.fixture(scope="module")
def creeping():
    return stage.case(stage.EFFECTS["creep"])


def test_the_floor_is_the_noise(plain):
    assert plain.floor == pytest.approx(stage.NOISE, rel=0.1)


def test_the_first_fit_finds_the_stage(plain):
    fit = first_fit(plain, 0)
    assert fit.converged
    assert fit.identify == pytest.approx(stage.NOISE, rel=0.1)
    assert fit.validate == pytest.approx(stage.NOISE, rel=0.1)
    assert fit.values["bouc_wen.gain"] == pytest.approx(0.082, rel=0.01)
    assert fit.values["bouc_wen.alpha"] == pytest.approx(0.55, rel=0.05)


def test_the_first_fit_is_a_function_of_its_seed(creeping):
    assert np.array_equal(first_fit(creeping, 3).point, first_fit(creeping, 3).point)


def test_a_fit_whose_starts_end_apart_has_not_converged(plain, monkeypatch):
    monkeypatch.setattr(Case, "descend", lambda case, problem, point, rival=np.inf: point)
    assert first_fit(plain, 0).converged  # no restart leads lower
    monkeypatch.setattr(starts, "restart", lambda case, fit: replace(fit, identify=0.9 * fit.identify))
    assert not first_fit(plain, 0).converged


def test_more_starts_are_refined_until_two_agree(plain, monkeypatch):
    """Of each four of the first twenty all but the first get nowhere."""
    points = []

    def lame(case, problem, point, rival=np.inf):
        points.append(point)
        return descend(problem, point, rival=rival) if len(points) in (1, 21) else point

    monkeypatch.setattr(Case, "descend", lame)
    assert first_fit(plain, 0).converged
    assert len(points) == 24


def test_a_block_is_found_elsewhere_and_a_fit_at_the_noise_stays(plain):
    soft = {"lumped.mass": 1.0, "lumped.stiffness": 1e5, "lumped.damping": 100.0}  # 50 Hz, 16 %
    ringing = stage.case(soft, model=("bouc_wen", "lumped"), noise=1e-9)
    problem = ringing.problem(())
    stiff = stage.STAGE | {"bouc_wen.gain": 0.082, "lumped.mass": 0.01, "lumped.stiffness": 9e8, "lumped.damping": 50.0}
    stuck = fit_at((), problem, problem.unit_point(stiff))
    assert stuck.identify > 3e-9
    assert restart(ringing, stuck).identify == pytest.approx(1e-9, rel=0.1)
    fit = first_fit(plain, 0)
    assert restart(plain, fit).identify == pytest.approx(fit.identify, rel=1e-3)


def test_a_descent_ends_with_the_budget(plain):
    problem, budget = plain.problem(()), Budget(0.0)
    start = np.full(problem.dimensions, 0.5)
    assert (descend(problem, start, going=budget.lasts) == start).all()
    assert budget.untried == ["settled fits"]


def test_without_records_to_validate_there_is_no_error_of_them(plain):
    without_validation = refit.Case(plain.words, (), plain.records[:1], {})
    assert first_fit(without_validation, 0).validate is None


def test_a_refit_goes_on_from_what_was_found(creeping):
    before = first_fit(creeping, 0)
    after = refit.refit(creeping, before, ("creep",), {"creep.ratio": 0.05, "creep.tau": 2.0})
    assert after.effects == ("creep",)
    assert after.values["creep.ratio"] == pytest.approx(0.08, rel=0.15)
    assert after.identify == pytest.approx(stage.NOISE, rel=0.1)
    assert before.identify > 3 * after.identify
    back = refit.refit(creeping, after, (), {})
    assert back.identify == pytest.approx(before.identify, rel=1e-3)


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


def test_halving_the_step_changes_nothing_of_what_is_exact(plain):
    fit = first_fit(plain, 0)
    assert refit.step_errors(plain, fit).max() < 1e-9 * plain.floor
    assert fit.steps == (1, 1)


def test_a_solver_too_coarse_for_what_is_left_is_blamed_on_no_effect(plain, monkeypatch):
    monkeypatch.setitem(blocks._items, "coarse", Coarse)
    case = refit.Case((*plain.words, "coarse"), (), plain.records, {})
    fit = first_fit(case, 0)
    problem = fit.problem
    response = simulate(problem.model, problem.records[0], problem.parameters(fit.point))[0, 0]
    half_a_step = np.gradient(response) / 2 / refit.FINEST  # by which Euler's lag is too short
    assert fit.steps == (refit.FINEST, refit.FINEST)
    assert refit.step_errors(case, fit)[0] == pytest.approx(np.std(half_a_step), rel=0.1)


def test_a_step_that_is_short_for_what_a_fit_leaves_is_kept_until_it_leaves_less(creeping, monkeypatch):
    """The second record would change by a 25th of what the fit leaves, several times as much as of the noise."""
    fit, asked = first_fit(creeping, 0), []

    def errors(case, fit, numbers):
        asked.append(tuple(numbers))
        return np.array([0.04 * fit.identify if number == 1 else 0.0 for number in asked[-1]])

    monkeypatch.setattr(refit, "step_errors", errors)
    assert 0.04 * fit.identify > refit.STEP_TOLERANCE * creeping.floor
    assert refit.refine_steps(creeping, fit) is fit
    assert refit.refine_steps(creeping, fit, fine=True).steps == (1, refit.FINEST)
    assert asked == [(0, 1), (0, 1), (1,), (1,), ()]  # what has been short enough is not asked about again


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


def test_a_shape_whose_range_ends_of_itself_is_not_on_a_bound(creeping):
    """0 decades are one Kelvin-Voigt element, 7 are all that the bounds allow."""
    fit = refit.refit(creeping, first_fit(creeping, 0), ("creep",), {})
    places = np.where([name == "creep.decades" for name in fit.problem.names], 1.0, 0.5)
    assert replace(fit, point=places).on_bounds == ("creep.decades",)
    assert replace(fit, point=places * (places < 1)).on_bounds == ()


def test_a_parameter_that_is_worse_on_its_bound_is_not_on_it():
    """A damping of 0.4 N s/m within [0, 5000] is as near to zero as the digits of a search, and determined."""
    ringing = np.where(np.arange(2000) % 1000 < 20, 0.0, 10.0)
    made, theta = rig.model("lumped"), np.array([[0.2, 0.4, 8e4]])
    response = simulate(made, rig.record(ringing, dt=2e-4), theta)[0]
    bounds = SimpleNamespace(bounds=(0.0, 5000.0), value=None)
    problem = Problem(made, [rig.record(ringing, dt=2e-4, response=response)], {"lumped.damping": bounds})
    point = problem.unit_point(dict(zip(made.names, theta[0], strict=True)))
    fit = refit.fit_at((), problem, point)
    assert 0 < point[problem.names.index("lumped.damping")] < refit.EDGE
    assert "lumped.damping" not in fit.on_bounds
    nearer = np.where(np.array(problem.names) == "lumped.damping", 1e-9, point)
    assert "lumped.damping" in refit.fit_at((), problem, nearer).on_bounds


def test_a_parameter_on_a_bound_is_told_unless_it_is_its_null(creeping):
    fit = refit.refit(creeping, first_fit(creeping, 0), ("amplifier_lag",), {})
    place = {name: i for i, name in enumerate(fit.problem.names)}
    point = np.full(fit.problem.dimensions, 0.5)
    point[place["bouc_wen.gamma"]] = 1.0
    point[place["amplifier_lag.tau"]] = 0.0
    assert replace(fit, point=point).on_bounds == ("bouc_wen.gamma",)
    point[place["amplifier_lag.tau"]] = 1.0
    assert set(replace(fit, point=point).on_bounds) == {"bouc_wen.gamma", "amplifier_lag.tau"}
    sentence = bounds_sentence(replace(fit, point=point))
    assert "amplifier_lag.tau and bouc_wen.gamma ended on their bounds of 0.05 s and 0.5 1/V" in sentence


COUPLED = ("bouc_wen", "lumped", "kinematic_coupling")
MECHANICS = {name: value for name, value in stage.STAGE.items() if name.startswith("lumped")}


def seen_through_a_coupling(response=None):
    """x and y are driven, only x is measured."""
    rng = np.random.default_rng(3)
    drive = [np.interp(np.arange(600), np.arange(0, 601, 25), rng.uniform(0, 100, 25)) for _ in "xy"]
    record = rig.record(
        *drive, response=[drive[0] * 1e-7 if response is None else response, 0 * drive[1]], measured=[0]
    )
    return refit.Case(COUPLED, (), [replace(record, response_units=("um", None))], stage.specs(MECHANICS))


ON_AXES = [word for word in blocks.effects() if not issubclass(blocks[word], Coupling | Addition)]


@pytest.mark.parametrize("effect", ON_AXES)
def test_an_effect_kept_off_an_axis_leaves_it_as_it_is_without(effect):
    """x reads what it would of a stage whose y, measured as well, has the effect at its null."""
    case = seen_through_a_coupling()
    nulls = case.unmeasured_nulls((effect,))
    assert nulls
    chain = blocks.chain((*COUPLED, effect))
    one, both = Chain(chain, "xy", (0,), given=nulls), Chain(chain, "xy", (0, 1))
    known = dict(zip(one.names, rig.candidates(one, case.records[0].drive, 4, 1).T, strict=True)) | nulls
    apart = {name: known.get(name, known.get(name.partition(".")[2])) for name in both.names}
    responses = [
        simulate(model, case.records[0], np.stack([np.broadcast_to(values[name], 4) for name in model.names], axis=1))
        for model, values in ((one, known), (both, apart))
    ]
    rig.assert_close(responses[0][:, 0], responses[1][:, 0])


def test_what_keeps_an_effect_off_is_its_null_on_the_axes_without_a_response():
    """Where nothing couples them there is nothing to keep off, and what the job has or says of is left to it."""
    case = seen_through_a_coupling()
    assert case.unmeasured_nulls(("amplifier_lag",)) == {"y.amplifier_lag.tau": 0.0}
    assert case.unmeasured_nulls(()) == {}
    assert refit.Case(COUPLED, ("amplifier_lag",), case.records, case.specs).unmeasured_nulls(("amplifier_lag",)) == {}
    specified = case.specs | stage.specs({"amplifier_lag.tau": 1.0})
    assert refit.Case(COUPLED, (), case.records, specified).unmeasured_nulls(("amplifier_lag",)) == {}
    assert refit.Case(("bouc_wen", "lumped"), (), case.records, case.specs).unmeasured_nulls(("amplifier_lag",)) == {}


@pytest.mark.parametrize("measured_only", [True, False])
def test_an_axis_without_response_has_an_effect_where_that_fits_better(measured_only):
    blank, effects = seen_through_a_coupling(), ("amplifier_lag",)
    stage_of = blank.problem(effects, measured_only=measured_only)
    known = stage.STAGE | {"kinematic_coupling.ratio": 0.3, "amplifier_lag.tau": 3e-3, "y.amplifier_lag.tau": 0.0}
    theta = np.array([[known[name] for name in stage_of.model.names]])
    noise = np.random.default_rng(4).normal(0, stage.NOISE, 600)
    case = seen_through_a_coupling(simulate(stage_of.model, blank.records[0], theta)[0, 0] + noise)
    refitted = refit.refit(case, first_fit(case, 0), effects, {"amplifier_lag.tau": 1.0})
    assert refitted.measured_only == measured_only
    assert refitted.identify == pytest.approx(stage.NOISE, rel=0.1)
    assert refitted.values["amplifier_lag.tau"] == pytest.approx(3e-3, rel=0.02)
    assert ("`y.amplifier_lag.tau: {value: 0}`" in measured_only_sentence(case, refitted)) == measured_only


def test_threads_are_as_silent_about_floating_point_as_the_caller(recwarn):
    with np.errstate(all="ignore"):
        quotients = list(side_by_side(lambda divisor: np.ones(1) / divisor, [0.0, 2.0]))
    assert quotients == [np.inf, 0.5]
    assert not recwarn.list


def test_where_half_of_all_starts_agree_the_search_ends(plain, monkeypatch):
    """By their number, whatever they took."""
    fitted, astray = [], np.full(plain.problem(()).dimensions, 0.6)
    monkeypatch.setattr(Case, "descend", lambda case, problem, point, rival=np.inf: astray)
    monkeypatch.setattr(plain, "on_event", lambda event: fitted.append(event["done"]) if "done" in event else None)
    first_fit(plain, 0)
    assert fitted == list(range(1, 13))


def test_two_starts_that_agree_far_from_the_noise_do_not_end_the_search(plain, monkeypatch):
    """Of the first eight points all end in one side minimum."""
    points = []
    astray = descend(plain.problem(()), np.full(plain.problem(()).dimensions, 0.9), most=1)

    def lame(case, problem, point, rival=np.inf):
        points.append(point)
        return descend(problem, point, rival=rival) if len(points) > 8 else astray

    monkeypatch.setattr(Case, "descend", lame)
    fit = first_fit(plain, 0)
    assert fit.converged and fit.identify < 1.1 * plain.floor
    assert len(points) == 12


def test_amounts_of_each_record_count_among_the_parameters(plain):
    """A ripple has four of them, and a frequency as a hum, which has two."""
    numbers = {}
    for effect in ("periodic_disturbance", "periodic_disturbance.ripple", "drift"):
        problem = plain.problem((effect,))
        numbers[effect] = fit_at((effect,), problem, np.full(problem.dimensions, 0.5)).freedom
    free = plain.problem(()).dimensions
    assert numbers == {"periodic_disturbance": free + 3, "periodic_disturbance.ripple": free + 5, "drift": free + 2}
