"""Backlash against what Coulomb's friction of the sensor's target does: it moves only as far as it is pushed."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rig import path, response


def read(x, clearance):
    """The reading of a stage that stands at x."""
    return response(["backlash"], {"backlash.clearance": clearance}, np.asarray(x, dtype=float))


def test_the_target_moves_once_the_gap_is_crossed_and_stays_on_a_reversal():
    np.testing.assert_allclose(read([0, 1, 3, 2, 1, 0, 2, 4], 1.0), [0, 0, 2, 2, 2, 1, 1, 3], atol=1e-12)


def test_a_loop_is_as_wide_as_the_gap_and_has_no_minor_loop_within_it():
    x = path(0, 10, 0, 10, points=400)
    y = read(x, 0.7)
    rising, falling = y[800:1199], y[400:799]
    assert rising[200] - falling[::-1][200] == pytest.approx(-2 * 0.7, abs=0.06)
    assert np.ptp(read(path(5, 6.3, 5, 6.3, points=50), 0.7)[60:]) < 1e-12


@given(seed=st.integers(0, 10**6), clearance=st.floats(0.01, 3))
def test_it_is_never_farther_than_half_the_gap_and_moves_only_at_a_rim(seed, clearance):
    x = np.cumsum(np.random.default_rng(seed).normal(size=200))
    x -= x[0]
    y = read(x, clearance)
    assert np.abs(y - x).max() <= clearance + 1e-9
    moved = np.flatnonzero(np.abs(np.diff(y)) > 1e-9) + 1
    np.testing.assert_allclose(np.abs(y - x)[moved], clearance, atol=1e-9)
