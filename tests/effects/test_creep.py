"""Creep against one Kelvin-Voigt element and against a logarithm of time."""

import numpy as np
import pytest

from rig import response

STEP = np.minimum(np.arange(4001.0), 1)


def crept(drive, ratio=0.1, tau=2.0, decades=0.0, dt=1e-2):
    return response(["creep"], {"creep.ratio": ratio, "creep.tau": tau, "creep.decades": decades}, drive, dt=dt)


def test_without_spread_it_is_one_kelvin_voigt_element():
    """A ramp of a sample, then constant."""
    tau, dt = 2.0, 1e-2
    first = 1 - tau / dt * -np.expm1(-dt / tau)
    expected = 1.1 - 0.1 * (1 - first) * np.exp(-dt * np.arange(4000) / tau)
    np.testing.assert_allclose(crept(STEP)[1:], expected, rtol=1e-12)


def test_in_the_end_it_is_the_ratio():
    assert crept(STEP, decades=1)[-1] == pytest.approx(1.1, abs=1e-4)


def test_wide_spread_creeps_with_the_logarithm_of_time():
    """The same amount in every decade well inside the spread: ratio / decades."""
    t = np.arange(20001) * 1e-2
    found = crept(np.minimum(np.arange(20001.0), 1), tau=1.0, decades=5, dt=1e-2)
    inside = (t > 0.05) & (t < 20)
    slope, at_one = np.polyfit(np.log10(t[inside]), found[inside], 1)
    assert slope == pytest.approx(0.1 / 5, rel=0.03)
    line = at_one + slope * np.log10(t[inside])
    np.testing.assert_allclose(found[inside], line, rtol=0, atol=0.03 * np.ptp(line))


def test_at_rest_under_the_first_sample():
    np.testing.assert_array_equal(crept(np.full(100, 80.0)), 80)
    np.testing.assert_allclose(crept(STEP + 80), crept(STEP) + 80, rtol=1e-14)
