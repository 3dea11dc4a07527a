"""Standard errors against closed forms, and against the scatter of estimates under repeated noise."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.signal import lfilter

from pzt_ident.model.chain import Chain
from pzt_ident.model.parameter import NOTHING_BEYOND, Parameter
from pzt_ident.model.registry import blocks
from pzt_ident.search.cube import FixedValue
from pzt_ident.search.descent import polish
from pzt_ident.search.problem import Problem
from pzt_ident.search.sandwich import Lags, Sandwich, autoregression
from pzt_ident.search.uncertainty import caution, ends_at_bound, estimates, interval_of, verdict_of
from rig import record, response

BLOCKS, LENGTH = 40, 10
ALTERNATING = np.repeat(np.resize([1.0, -1.0], BLOCKS), LENGTH)
CAMPAIGNS = 400
SCATTER = 4 / np.sqrt(2 * CAMPAIGNS)  # four standard errors of a standard deviation from so many estimates


def covariance_of(jacobian, residual):
    """Covariance from the derivatives of one series of samples, (samples, free), and its residual, (samples,)."""
    return Sandwich(lambda: [(0, np.vstack([residual, jacobian.T]))]).covariance


def errors(covariance):
    return np.sqrt(np.diag(covariance))


def test_what_stays_the_same_over_a_block_counts_once_a_block():
    """The mean of 40 blocks of 10 equal residuals +-3 is known to 3 / sqrt(40), not to 3 / sqrt(400)."""
    (found,) = errors(covariance_of(np.ones((BLOCKS * LENGTH, 1)), 3 * ALTERNATING))
    assert found == pytest.approx(3 / np.sqrt(BLOCKS), rel=1e-12)


@pytest.mark.parametrize("size", [1.0, 50.0])
def test_what_cancels_within_a_block_counts_as_white_noise(size):
    residual = 3 * np.resize([1.0, -1.0], BLOCKS * LENGTH)
    (found,) = errors(covariance_of(np.full((residual.size, 1), size), residual))
    assert found == pytest.approx(3 / np.sqrt(residual.size - 1) / size, rel=1e-12)


def test_parameters_that_share_samples_have_the_errors_of_the_means_that_they_stand_for():
    """One is the mean of the quiet half, the other what the loud half has more: half the blocks hold +-3, half +-1."""
    loud = np.repeat([1.0, 0.0], BLOCKS * LENGTH // 2)
    found = covariance_of(np.column_stack([loud, np.ones_like(loud)]), (1 + 2 * loud) * ALTERNATING)
    each = BLOCKS / 2
    np.testing.assert_allclose(found, np.array([[9 + 1, -1], [-1, 1]]) / each, rtol=1e-9)


def test_a_direction_that_no_sample_shows_is_unknown_and_spoils_no_other():
    ones = np.ones(BLOCKS * LENGTH)
    found = errors(covariance_of(np.column_stack([ones, 0 * ones]), 3 * ALTERNATING))
    assert found[0] == pytest.approx(3 / np.sqrt(BLOCKS), rel=1e-9)
    assert found[1] > 1e6


def coloured(rng, size, memory):
    """AR(1) noise of unit variance that has run in."""
    return np.sqrt(1 - memory**2) * lfilter([1], [1, -memory], rng.normal(size=size + 200))[200:]


@pytest.mark.parametrize("memory", [0.0, 0.8, 0.95])
def test_errors_are_the_scatter_of_estimates_over_campaigns(memory):
    """A block of 50 samples misses what AR(1) noise of memory m carries over its ends, 2 m / (1 - m^2) / 50 of the
    variance, and three parameters take 3 of 40 degrees of freedom: with 0.95 a third less. The spectrum of the residual
    makes up for it. Errors of white noise would be a third with 0.8, a sixth with 0.95."""
    t = np.linspace(-1, 1, 2000)
    jacobian = np.column_stack([np.ones(t.size), t + 0.9, np.sin(7 * t) + t])
    solve, rng = np.linalg.pinv(jacobian), np.random.default_rng(8)
    found, told = [], []
    for _ in range(CAMPAIGNS):
        noise = coloured(rng, t.size, memory)
        found.append(solve @ noise)
        told.append(np.diag(covariance_of(jacobian, noise - jacobian @ found[-1])))
    ratio = np.sqrt(np.mean(told, axis=0)) / np.std(found, axis=0)
    assert np.all(np.abs(ratio - 1) < 0.09 + SCATTER)
    white = np.sqrt(np.diag(np.linalg.inv(jacobian.T @ jacobian))) / np.std(found, axis=0)
    np.testing.assert_allclose(white, np.sqrt((1 - memory) / (1 + memory)), rtol=SCATTER)


def test_an_autoregression_is_found_from_its_residual():
    lags, residual = Lags(), coloured(np.random.default_rng(2), 20_000, 0.9)
    for part in np.array_split(residual, [50, 4000]):
        lags.add(0, part)
    np.testing.assert_allclose(lags.sums[7], residual[7:] @ residual[:-7], rtol=1e-9)
    weights, variance = autoregression(lags)
    np.testing.assert_allclose(weights[:2], [1, -0.9], atol=0.02)
    assert np.abs(weights[2:]).max(initial=0) < 0.05 and variance == pytest.approx(1 - 0.9**2, rel=0.03)


def test_a_model_that_leaves_nothing_has_no_errors():
    assert np.all(covariance_of(np.ones((50, 1)), np.zeros(50)) == 0)


def test_the_error_of_a_gain_is_that_of_the_slope_of_a_straight_line():
    """sigma / |u - mean u|, in the user's units, whatever the bounds are; 40 block sums know it to a ninth."""
    noise, drive = 2e-8, np.linspace(0, 100, 4000)
    response = 1e-7 * drive + np.random.default_rng(4).normal(0, noise, drive.size)
    straight = {
        f"bouc_wen.{word}": FixedValue(value) for word, value in (("alpha", 0.0), ("beta", 0.01), ("gamma", 0.0))
    }
    problem = Problem(Chain([blocks["bouc_wen"]], "x", [0]), [record(drive, response=[response])], straight)
    point, _ = polish(problem, np.array([0.5]))
    (gain,) = estimates(problem, point)[0]
    assert (gain.name, gain.unit, gain.verdict) == ("bouc_wen.gain", "m/V", "determined")
    expected = noise / np.linalg.norm(drive - drive.mean())
    assert gain.standard_error == pytest.approx(expected, rel=0.35)
    assert abs(gain.value - 1e-7) < 4 * expected
    assert gain.note == ""


@pytest.mark.parametrize(("tau", "known"), [(3.0, True), (40.0, False)])
def test_of_a_time_constant_far_beyond_the_records_nothing_of_its_effect_is_determined(tau, known):
    """Creep of 5 % in records of 4 s: the beginning of a slow one has a slope, and no end."""
    truth = {"bouc_wen.gain": 1e-7, "bouc_wen.alpha": 0.0, "bouc_wen.beta": 1.0, "bouc_wen.gamma": 0.0}
    truth |= {"creep.ratio": 0.05, "creep.tau": tau, "creep.decades": 0.0}
    drive = np.repeat([0.0, 60.0, 20.0, 90.0], 250)
    moved = response(["bouc_wen", "creep"], truth, drive, dt=4e-3)
    made = record(drive, response=[moved + np.random.default_rng(1).normal(0, 1e-10, drive.size)], dt=4e-3)
    fixed = {name: FixedValue(value) for name, value in truth.items() if name.startswith("bouc_wen")}
    chain = Chain([blocks["bouc_wen"], blocks["creep"]], ("x",), (0,))
    problem = Problem(chain, [made], fixed | {"creep.decades": FixedValue(0.0)})
    rows, _ = estimates(problem, problem.unit_point({"creep.ratio": 0.05, "creep.tau": tau}))
    assert [row.verdict == "determined" for row in rows] == [known, known]
    assert [row.interval is not None for row in rows] == [known, known]
    assert ("creep.tau is far beyond the longest record, of 4 s" in rows[0].note) == (not known)


@pytest.mark.parametrize(("bounds", "least"), [(None, 0.0), ((0.0, 1.0), 0.0), ((-1.0, 1.0), -np.inf)])
def test_an_interval_goes_below_zero_only_where_the_parameter_may(bounds, least):
    """alpha is a share: at 0.01 +- 0.1 its interval begins at 0, unless the job lets it be negative."""
    specs = {"bouc_wen.alpha": SimpleNamespace(bounds=bounds, value=None)} if bounds else {}
    drive = np.sin(np.arange(200) / 10)
    problem = Problem(Chain([blocks["bouc_wen"]], "x", [0]), [record(drive, response=[drive])], specs)
    place = problem.names.index("bouc_wen.alpha")
    width = problem.upper[place] - problem.lower[place]
    value = (0.01 - problem.lower[place]) / width
    ends = value + np.array([-0.1, 0.1]) / width
    point = np.full(problem.dimensions, 0.5)
    point[place] = value
    assert interval_of(problem, point, place, ends) == pytest.approx((max(-0.09, least), 0.11))


@pytest.mark.parametrize(
    ("value", "correlation", "note"),
    [
        (-2.1, 0.99, ""),
        (1.9, 0.99, "zero lies within two standard errors"),
        (2.1, -0.996, "known only together with b"),
        (-1.9, 0.996, "zero lies within two standard errors; known only together with b"),
    ],
)
def test_a_doubtful_sign_and_a_tie_are_told(value, correlation, note):
    named = SimpleNamespace(names=("a", "b", "c"))
    assert caution(named, 0, value, 1.0, np.array([1.0, correlation, 0.5])) == note


@pytest.mark.parametrize(
    ("place", "error", "said"),
    [(0.0, 1e-6, "on its lower bound"), (7e-5, 1e-4, "on its lower bound"), (7e-5, 1e-7, "determined")],
)
def test_a_value_that_is_surely_off_a_bound_is_not_on_it(place, error, said):
    assert verdict_of(place, error, 0.0)[0] == said
    assert verdict_of(1 - place, error, 0.0)[0] == said.replace("lower", "upper")


@pytest.mark.parametrize(("bounds", "ends"), [((0, 5), True), ((1, 5), False)])
@pytest.mark.parametrize(("declared", "end"), [((0, 10), None), ((-3, 10), None), ((-3, 10), "upper")])
def test_nothing_lies_beyond_the_zero_of_what_is_never_negative_or_where_a_range_ends(bounds, ends, declared, end):
    parameter = Parameter("s", declared, "", end=end)
    model = SimpleNamespace(entries=[SimpleNamespace(parameter=parameter)])
    problem = SimpleNamespace(free=[0], model=model, lower=np.array([bounds[0]]), upper=np.array([bounds[1]]))
    assert ends_at_bound(problem, np.array([0.0]), 0) == (ends and declared[0] == 0)
    assert ends_at_bound(problem, np.array([1.0]), 0) == (end == "upper")
    assert verdict_of(0.0, 1e-6, 0.0, ends)[1] == (NOTHING_BEYOND if ends else verdict_of(0.0, 1e-6, 0.0)[1])
