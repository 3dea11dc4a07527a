"""A load is mass of the stage."""

import numpy as np
import pytest

from rig import response

KNOWN = {"lumped.mass": 0.16, "lumped.damping": 30.0, "lumped.stiffness": 7e7}
STEP = np.minimum(np.arange(4000.0), 1)


def test_it_adds_to_the_moving_mass():
    loaded = response(["lumped", "load_mass"], KNOWN | {"lumped.load": 0.08}, STEP, dt=1e-5)
    np.testing.assert_array_equal(loaded, response(["lumped"], KNOWN | {"lumped.mass": 0.16 + 0.08}, STEP, dt=1e-5))


def test_resonance_falls_with_the_root_of_the_mass():
    loaded = response(["lumped", "load_mass"], KNOWN | {"lumped.load": 0.16, "lumped.damping": 0.0}, STEP, dt=1e-5)
    crossings = np.flatnonzero(np.diff(np.sign(loaded - 1)))
    period = 2e-5 * (crossings[-1] - crossings[1]) / (crossings.size - 2)
    assert period == pytest.approx(2 * np.pi * np.sqrt(2 * 0.16 / 7e7), rel=2e-3)
