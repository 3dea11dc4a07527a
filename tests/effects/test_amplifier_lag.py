"""The amplifier's lag against its closed forms."""

import numpy as np
import pytest

from rig import response

TAU = 0.3e-3


def lagged(drive, dt=1e-4, tau=TAU):
    return response(["amplifier_lag"], {"amplifier_lag.tau": tau}, drive, dt=dt)


@pytest.mark.parametrize("dt", [1e-3, 1e-4, 1e-6])
def test_a_ramp_is_followed_a_time_constant_late(dt):
    t = dt * np.arange(200)
    np.testing.assert_allclose(lagged(t, dt), t - TAU * -np.expm1(-t / TAU), rtol=1e-9, atol=1e-15)


def test_sampling_twice_as_often_changes_nothing():
    corners = np.random.default_rng(1).normal(size=100)
    fine = np.interp(np.arange(199) / 2, np.arange(100), corners)
    np.testing.assert_allclose(lagged(fine, 5e-5)[::2], lagged(corners), rtol=0, atol=1e-13)


def test_phase_and_amplitude_of_a_sine():
    t, omega = 1e-5 * np.arange(20000), 2 * np.pi * 500
    found = lagged(np.exp(1j * omega * t).imag, 1e-5)[10000:]
    wave = np.exp(-1j * omega * t[10000:])
    assert 2j * np.mean(found * wave) == pytest.approx(1 / (1 + 1j * omega * TAU), abs=1e-4)


def test_long_time_constants_keep_their_digits():
    t = 1e-4 * np.arange(1000)
    np.testing.assert_allclose(lagged(t, tau=5.0), t - 5 * -np.expm1(-t / 5), rtol=1e-6, atol=1e-15)


def test_a_step_from_rest_is_followed_from_the_sample_ahead():
    """The drive goes there on a line: the lag follows that ramp, and then decays towards the drive."""
    dt, level, start = 1e-4, 10.0, -4.0
    found = response(["amplifier_lag"], {"amplifier_lag.tau": TAU}, np.full(100, level), dt=dt, rest_at=(start,))
    left = (level - start) * TAU / dt * -np.expm1(-dt / TAU) * np.exp(-dt * np.arange(100) / TAU)
    np.testing.assert_allclose(found, level - left, rtol=1e-9)
