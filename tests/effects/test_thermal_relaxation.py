"""Relaxing memory: an exponential of time in a hold, a lag of the drive without forgetting."""

import numpy as np
import pytest
from scipy.optimize import brentq

from rig import path, response

KNOWN = {"bouc_wen.gain": 0.08, "bouc_wen.alpha": 0.4, "bouc_wen.beta": 0.04, "bouc_wen.gamma": -0.01}
TAU = 5.0


def memory(drive, dt=0.01, **more):
    """h, m."""
    known = KNOWN | {f"bouc_wen.{word}": value for word, value in more.items()}
    return 0.08 * drive - response(["bouc_wen"], known | {"bouc_wen.relaxation": 1 / TAU}, drive, dt=dt)


@pytest.mark.parametrize("last", [80, 30])
def test_decays_exponentially_in_a_hold(last):
    drive = np.append(path(0, 80, last, points=50), np.full(2000, last))
    held = memory(drive)[100:]
    assert abs(held[0]) > 0.1
    np.testing.assert_allclose(held, held[0] * np.exp(-0.01 * np.arange(2001) / TAU), rtol=1e-9)


def test_without_forgetting_a_ramp_is_remembered_for_tau():
    """dh/dt = alpha d v - h / tau: h = alpha d v tau (1 - exp(-t / tau)), to first order in the step."""
    errors = []
    for dt in (0.02, 0.01):
        t = np.arange(0, 20, dt)
        found = memory(4 * t, dt, beta=0.0, gamma=0.0)
        errors.append(np.abs(found - 0.4 * 0.08 * 4 * TAU * -np.expm1(-t / TAU)).max())
    assert errors[0] < 0.02 / TAU * 0.64
    assert errors[0] / errors[1] == pytest.approx(2, rel=0.01)


def test_a_small_step_back_arrests_it():
    """To where h is zero nothing is left to relax."""
    peak = path(0, 80, points=50)
    held = memory(np.append(peak, np.full(100, 80.0)))
    back = brentq(lambda voltage: memory(np.append(peak, voltage))[-1], 0, 80, xtol=1e-12)
    arrested = memory(np.append(peak, np.full(100, back)))
    assert np.ptp(held[51:]) > 0.1
    np.testing.assert_allclose(arrested[51:], 0, atol=1e-9)
