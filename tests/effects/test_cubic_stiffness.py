"""Cubic stiffness: the cubic equation itself."""

import numpy as np
import pytest

from rig import response


def bent(force, cubic):
    return response(["cubic_stiffness"], {"cubic_stiffness.cubic": cubic}, force)


@pytest.mark.parametrize("cubic", [1e-12, 2e-4, 1e-2, 1.0, 1e6])
def test_hard_spring_is_in_equilibrium(cubic):
    force = np.linspace(-30, 30, 1001)
    x = bent(force, cubic)
    np.testing.assert_allclose(x + cubic * x**3, force, rtol=3e-14, atol=1e-14)


def test_soft_spring_is_in_equilibrium_short_of_its_limit():
    limit = np.sqrt(0.125 / 1e-3)
    force = np.linspace(-limit, limit, 1001)
    x = bent(force, -1e-3)
    np.testing.assert_allclose(x - 1e-3 * x**3, force, rtol=1e-14, atol=1e-14)


def test_beyond_its_limit_it_goes_on_in_proportion():
    np.testing.assert_allclose(bent(np.array([20.0, 40, -1e3]), -1e-3), (np.sqrt(5) - 1) * np.array([20, 40, -1e3]))
