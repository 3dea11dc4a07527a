"""What the levels of the steering mirror are held against."""

import numpy as np
import pytest

from experiments.steering_mirror.levels import RAYLEIGH


def test_rayleighs_law_adds_lag_and_gain_in_one_ratio():
    """Under E0 cos(t) the branches of a loop are a E0 E +- a (E0^2 - E^2) / 2, the falling one above."""
    t = np.arange(4096) * 2 * np.pi / 4096
    field = 3.0 * np.cos(t)
    loop = 0.1 * (3.0 * field + np.sign(np.sin(t)) * (3.0**2 - field**2) / 2)
    gain = np.fft.fft(loop)[1] / np.fft.fft(field)[1]
    assert gain.real == pytest.approx(0.1 * 3.0)
    assert -gain.imag / gain.real == pytest.approx(RAYLEIGH, rel=1e-5)
