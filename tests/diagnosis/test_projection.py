"""A parameter takes up no more of a signal than its bounds allow."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import lsq_linear

from pzt_ident.diagnosis.projection import Projection, least_squares
from pzt_ident.diagnosis.projection import bounded as solved

SAMPLES = 40
NOBODY = np.zeros(0, dtype=bool)


def drawn(seed, free, amplitudes=0):
    """A Jacobian whose columns differ by decades in size, a point of the cube with some parameters on a bound, a signal
    and traces."""
    rng = np.random.default_rng(seed)
    jacobian = rng.normal(size=(SAMPLES, free)) * 10.0 ** rng.uniform(-3, 2, free)
    point = np.where(rng.random(free) < 0.4, rng.integers(0, 2, free), rng.random(free))
    return jacobian, point, rng.normal(size=SAMPLES), rng.normal(size=(SAMPLES, amplitudes))


def bounded(jacobian, point, signal, traces, one_sided):
    """The same by SciPy's bounded least squares on all samples."""
    least = np.concatenate([-point, np.where(one_sided, 0, -np.inf)])
    most = np.concatenate([1 - point, np.full(one_sided.size, np.inf)])
    matrix = np.hstack([jacobian, traces])
    return signal + matrix @ lsq_linear(matrix, -signal, (least, most), method="bvls", tol=1e-14).x


def left(jacobian, point, signal):
    projection = Projection(jacobian, point, signal)
    found = projection.left(projection.signal)
    np.testing.assert_allclose(projection.left_of(signal[None]), found, rtol=1e-6, atol=1e-6 * np.linalg.norm(signal))
    return found[0]


@given(st.integers(0, 10_000), st.integers(1, 6))
def test_what_remains_is_the_least_within_the_bounds(seed, free):
    jacobian, point, signal, traces = drawn(seed, free)
    expected = bounded(jacobian, point, signal, traces, NOBODY)
    assert left(jacobian, point, signal) == pytest.approx(np.linalg.norm(expected), rel=1e-6)


@given(st.integers(0, 10_000), st.integers(1, 6))
def test_it_does_not_matter_where_the_exchange_of_bounds_begins(seed, free):
    jacobian, point, signal, _ = drawn(seed, free)
    box = (jacobian, signal, -point, 1 - point)
    expected = bounded(jacobian, point, signal, np.zeros((SAMPLES, 0)), NOBODY)
    rng = np.random.default_rng(seed)
    for begin in (np.zeros(free), rng.random(free) - point, np.where(rng.random(free) < 0.5, -point, 1 - point)):
        steps = solved(*box, begin)
        assert ((-point <= steps) & (steps <= 1 - point)).all()
        assert np.linalg.norm(signal + jacobian @ steps) == pytest.approx(np.linalg.norm(expected), rel=1e-6)


@given(st.integers(0, 10_000), st.integers(1, 5), st.integers(1, 3), st.booleans())
def test_so_it_is_beside_an_effect(seed, free, amplitudes, sided):
    jacobian, point, signal, traces = drawn(seed, free, amplitudes)
    one_sided = np.full(amplitudes, sided)
    projection = Projection(jacobian, point, signal)
    amounts, beside = projection.fit(projection.signal, projection.split(traces.T), one_sided)
    expected = bounded(jacobian, point, signal, traces, one_sided)
    assert not (one_sided & (amounts < 0)).any()
    assert beside <= np.linalg.norm(expected) * (1 + 1e-6) + 1e-12
    assert beside <= left(jacobian, point, signal) * (1 + 1e-9)


@given(st.integers(0, 10_000), st.integers(1, 4), st.integers(1, 4))
def test_no_set_of_traces_leaves_less_than_without_bounds(seed, free, amplitudes):
    jacobian, point, signal, traces = drawn(seed, free, 3 * amplitudes)
    projection = Projection(jacobian, point, signal)
    sets = projection.split_sets(traces.T, amplitudes)
    for number in range(3):
        matrix = np.hstack([jacobian, traces[:, number * amplitudes : (number + 1) * amplitudes]])
        steps = np.linalg.lstsq(matrix / np.linalg.norm(matrix, axis=0), -signal, rcond=None)[0]
        beside = np.linalg.norm(signal + matrix / np.linalg.norm(matrix, axis=0) @ steps)
        assert sets.least[number] == pytest.approx(beside, rel=1e-6)
        for sided in (False, True):
            _, within = projection.fit(*sets.exact(number), np.full(amplitudes, sided))
            assert within >= (1 - 1e-6) * sets.least[number]


@given(st.integers(0, 10_000), st.integers(1, 4))
def test_so_it_is_of_traces_that_the_parameters_nearly_produce(seed, free):
    """What is outside is a millionth of such a trace: its square is the rounding of that of the whole."""
    jacobian, point, signal, small = drawn(seed, free, 2)
    inside = jacobian / np.linalg.norm(jacobian, axis=0) @ np.random.default_rng(seed).normal(size=(free, 2))
    projection = Projection(jacobian, point, signal)
    sets = projection.split_sets((1e6 * inside + small).T, 1)
    outside = projection.split(small.T).outside
    left = projection.signal.outside[0]
    for number, trace in enumerate(outside):
        expected = left - trace * (trace @ left) / (trace @ trace)
        assert sets.least[number] == pytest.approx(np.linalg.norm(expected), rel=1e-6)


@given(st.integers(0, 10_000), st.integers(1, 6))
def test_where_all_may_go_as_far_as_they_like_it_is_the_orthogonal_projection(seed, free):
    jacobian, _, signal, _ = drawn(seed, free)
    jacobian *= 1e6 / np.linalg.norm(jacobian, axis=0)
    split = Projection(jacobian, np.full(free, 0.5), signal).signal
    q = np.linalg.qr(jacobian)[0]
    np.testing.assert_allclose(split.outside[0], signal - q @ (q.T @ signal), atol=1e-9)
    assert split.norms[0] == pytest.approx(np.linalg.norm(signal))
    assert left(jacobian, np.full(free, 0.5), signal) == pytest.approx(np.linalg.norm(split.outside))


@pytest.mark.parametrize(("place", "sign"), [(1.0, 1), (0.0, -1)])
def test_a_parameter_on_its_bound_is_no_excuse_for_what_lies_beyond_it(place, sign):
    derivative = np.sin(np.arange(SAMPLES))
    jacobian, point = derivative[:, None], np.array([place])
    beyond = -0.3 * sign * derivative  # what a step beyond the bound would take away
    assert left(jacobian, point, beyond) == pytest.approx(np.linalg.norm(beyond))
    assert left(jacobian, point, -beyond) == pytest.approx(0, abs=1e-12)


def test_a_parameter_that_hardly_moves_the_response_takes_up_its_range_of_it():
    derivative = np.sin(np.arange(SAMPLES))
    jacobian, point = 1e-3 * derivative[:, None], np.array([0.25])
    assert left(jacobian, point, -derivative) == pytest.approx((1 - 0.75e-3) * np.linalg.norm(derivative))


@given(st.integers(0, 10_000), st.integers(0, 12), st.integers(0, 12), st.integers(1, 12))
def test_least_squares_are_those_of_the_pseudo_inverse(seed, rows, columns, rank):
    rng = np.random.default_rng(seed)
    matrix = rng.normal(size=(rows, rank)) @ rng.normal(size=(rank, columns))
    target = rng.normal(size=rows)
    expected = np.linalg.pinv(matrix, rcond=1e-8) @ target
    scale = 1 + np.abs(expected).max(initial=0)
    np.testing.assert_allclose(least_squares(matrix, target, 1e-8) / scale, expected / scale, atol=1e-6)
