"""A response that runs out: a hyperbolic tangent in the prompt response, none in the memory."""

import numpy as np
import pytest

from rig import path, response

KNOWN = {"bouc_wen.gain": 0.1, "bouc_wen.alpha": 0.4, "bouc_wen.beta": 0.04, "bouc_wen.gamma": -0.01}


@pytest.mark.parametrize("knee", [1e-9, 1e-5, 1e-2, 1.0, 50.0])
def test_alone_it_is_a_hyperbolic_tangent(knee):
    """On both sides of where a series takes over, and far beyond the knee."""
    drive = np.concatenate([np.linspace(-100, 100, 2001), np.geomspace(1e-8, 100, 300), -1e-3 / knee * np.arange(3)])
    np.testing.assert_allclose(
        response(["saturation"], {"saturation.knee": knee}, drive), np.tanh(knee * drive) / knee, rtol=1e-13
    )


def test_the_memory_does_not_saturate():
    drive = path(0, 90, 20, 60, -30, 0, points=60)
    found = response(["bouc_wen", "saturation"], KNOWN | {"saturation.knee": 0.02}, drive)
    lost = drive - 50 * np.tanh(drive / 50)
    np.testing.assert_allclose(response(["bouc_wen"], KNOWN, drive) - found, 0.1 * lost, rtol=0, atol=1e-12)


@pytest.mark.parametrize("sharpness", [1.2, 2.0, 40.0, 500.0])
def test_a_knee_of_any_sharpness(sharpness):
    drive = np.concatenate([np.linspace(-100, 100, 2001), np.geomspace(1e-8, 100, 300)])
    found = response(["saturation.knee"], {"saturation.knee": 0.02, "saturation.sharpness": sharpness}, drive)
    expected = drive / (1 + np.abs(drive / 50) ** sharpness) ** (1 / sharpness)
    np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-18)
