"""Dahl friction against its closed form in the displacement."""

from itertools import pairwise

import numpy as np
import pytest

from rig import path, response


def rubbed(force, sliding=0.05, reach=0.3):
    return response(["friction"], {"friction.force": sliding, "friction.reach": reach}, force)


def driving(x, sliding, reach):
    """The force that moves the stage along a path, from rest: x plus Dahl's friction on every monotone step."""
    friction, found = 0.0, [x[0]]
    for before, after in pairwise(x):
        move = after - before
        limit = np.sign(move) * sliding
        friction = limit + (friction - limit) * np.exp(-abs(move) / reach)
        found.append(after + friction)
    return np.array(found)


@pytest.mark.parametrize(("sliding", "reach"), [(0.05, 0.3), (0.1, 1e-3), (1.0, 1e-2), (1e-9, 1.0), (2.0, 0.01)])
def test_displacement_for_the_force_that_makes_it(sliding, reach):
    x = np.concatenate([path(0, 8, 3, 5, -2, 4, points=40), 4 + np.random.default_rng(1).normal(size=300).cumsum()])
    np.testing.assert_allclose(rubbed(driving(x, sliding, reach), sliding, reach), x, rtol=0, atol=1e-12)


def test_a_long_loop_is_twice_the_sliding_friction_wide():
    force = path(0, 10, 0, 10, points=400)
    x = rubbed(force)
    assert x[800:][200] - x[400:800][200] == pytest.approx(-2 * 0.05, rel=1e-6)


def test_below_the_reach_it_is_a_spring():
    """sliding / reach times the stiffness."""
    small = path(0, 1e-6, -1e-6, 0)
    np.testing.assert_allclose(rubbed(small), small / (1 + 0.05 / 0.3), rtol=1e-5, atol=1e-11)
