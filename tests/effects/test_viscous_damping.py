"""Extra damping is damping of the stage."""

import numpy as np
import pytest

from rig import response

KNOWN = {"lumped.mass": 0.16, "lumped.damping": 30.0, "lumped.stiffness": 7e7}


def test_it_adds_to_the_damping():
    drive = np.random.default_rng(1).normal(size=300).cumsum()
    damped = response(["lumped", "viscous_damping"], KNOWN | {"lumped.extra_damping": 50.0}, drive, dt=1e-4)
    np.testing.assert_array_equal(damped, response(["lumped"], KNOWN | {"lumped.damping": 80.0}, drive, dt=1e-4))


def test_a_slow_ramp_is_followed_late_by_damping_over_stiffness():
    t = 1e-3 * np.arange(2000)
    damped = response(["lumped", "viscous_damping"], KNOWN | {"lumped.extra_damping": 7e4 - 30}, t)
    assert t[-1] - damped[-1] == pytest.approx(7e4 / 7e7, rel=1e-9)
