from itertools import pairwise

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from pzt_ident.diagnosis.drive_history import drive_history, reversals

DT = 1e-3


def triangle(samples, half, height=100.0):
    phase = np.arange(samples) / half
    return height * np.abs((phase + 1) % 2 - 1)


def trapezoid(parts):
    """(samples, level at the end) one after the other, from 0."""
    drive = [0.0]
    for samples, level in parts:
        drive.extend(np.linspace(drive[-1], level, samples + 1)[1:])
    return np.array(drive)


def test_a_triangle():
    history = drive_history(triangle(4001, 1000), DT)
    np.testing.assert_array_equal(history.direction[:4000], np.repeat([1, -1, 1, -1], 1000))
    np.testing.assert_allclose(history.amplitude, 100)
    np.testing.assert_allclose(history.rate, 0.1 / DT)
    np.testing.assert_allclose(history.since[:4000], DT * np.tile(np.arange(1000), 4))
    np.testing.assert_array_equal(history.cycle[:4000], np.repeat([1, 2], 2000))


def test_a_noisy_triangle_turns_where_the_clean_one_does():
    noise = 0.05 * np.random.default_rng(1).normal(size=4001)
    history = drive_history(triangle(4001, 1000) + noise, DT)
    same = history.direction[:4000] == np.repeat([1, -1, 1, -1], 1000)
    assert same.mean() > 0.99
    np.testing.assert_allclose(np.median(history.rate), 100, rtol=0.05)


@pytest.mark.parametrize("noise", [0.0, 0.02])
def test_holds_are_neither_rising_nor_falling(noise):
    drive = trapezoid([(1000, 100), (500, 100), (1000, 20), (2000, 20)])
    history = drive_history(drive + noise * np.random.default_rng(2).normal(size=drive.size), DT)
    ways = np.concatenate([[1], np.repeat([1, 0, -1, 0], [1000, 500, 1000, 2000])])
    assert (history.direction == ways).mean() > 0.95
    assert not history.rate[history.direction == 0].any()


def test_the_clock_starts_anew_with_a_hold():
    history = drive_history(trapezoid([(1000, 100), (500, 100), (1000, 150)]), DT)
    assert history.since[999] == pytest.approx(0.999, abs=2 * DT)
    assert history.since[1490] == pytest.approx(0.49, abs=2 * DT)


@pytest.mark.parametrize("samples", [20, 200, 20_000])
def test_a_sine_holds_nowhere(samples):
    history = drive_history(50 - 50 * np.cos(2 * np.pi * np.arange(5 * samples) / samples), DT)
    assert not (history.direction == 0).any()
    assert history.cycle.max() == 5


@pytest.mark.parametrize("noise", [0.0, 1e-3])
def test_a_drive_that_stands_still(noise):
    history = drive_history(7 + noise * np.random.default_rng(3).normal(size=500), DT)
    assert not history.direction.any()
    assert not history.amplitude.any()


@given(arrays(float, st.integers(3, 60), elements=st.integers(-5, 5).map(float)), st.integers(1, 4))
def test_reversals_alternate_and_leave_nothing_larger_between(drive, turn):
    turns = reversals(drive, turn)
    assert turns[0] == 0
    assert (np.diff(turns) > 0).all()
    steps = np.diff(drive[turns])
    assert (np.abs(steps[1:]) >= turn).all()
    assert (np.sign(steps[1:]) != np.sign(steps[:-1]))[1:].all()
    for first, last in pairwise(turns[1:]):
        inside = drive[first : last + 1]
        assert {inside.min(), inside.max()} == {drive[first], drive[last]}


@given(arrays(float, st.integers(3, 200), elements=st.floats(-1e3, 1e3)))
@example(np.array([0.0, 5e-324, 0.0]))
def test_any_drive_has_a_motion(drive):
    history = drive_history(drive, DT)
    assert set(np.unique(history.direction)) <= {-1, 0, 1}
    assert all(np.isfinite(values).all() and (values >= 0).all() for values in history[1:])
