"""A slew limit against its closed form and against fine steps."""

import numpy as np
import pytest

from rig import response

DT = 1e-3


def limited(drive, limit, dt=DT, ratio=None):
    values = {"slew_limit.slowness": 1 / limit}
    if ratio is None:
        return response(["slew_limit"], values, drive, dt=dt)
    return response(["slew_limit.two_sided"], values | {"slew_limit.ratio": ratio}, drive, dt=dt)


def test_nothing_up_to_the_limit():
    drive = 50 * np.sin(2 * np.pi * 20 * DT * np.arange(500))
    np.testing.assert_array_equal(limited(drive, 50 * 2 * np.pi * 20), drive)


def test_a_jump_is_followed_at_the_limit():
    found = limited(np.append(0, np.full(99, 10.0)), 400)
    np.testing.assert_allclose(found, np.minimum(0.4 * np.arange(100), 10), atol=1e-13)


def test_a_sine_far_above_the_limit_becomes_a_triangle():
    limit, frequency = 100, 10
    found = limited(50 * np.sin(2 * np.pi * frequency * 1e-5 * np.arange(50000)), limit, 1e-5)
    turns = np.diff(np.sign(np.diff(found))) != 0
    assert turns.sum() == 2 * 5
    at_limit = np.isclose(np.abs(np.diff(found)), limit * 1e-5, rtol=1e-9)
    assert np.count_nonzero(~at_limit) <= 2 * 5


CORNERS = np.random.default_rng(1).uniform(-3, 3, 300)


@pytest.mark.parametrize("ratio", [None, 0.4, 2.5])
def test_sampling_more_often_changes_nothing(ratio):
    """Also where the command meets the voltage within a sample and leaves it behind again."""
    fine = np.interp(np.arange(299 * 64 + 1) / 64, np.arange(300), CORNERS)
    found = limited(fine, 1500, DT / 64, ratio)
    assert (np.abs(found - fine) > 0.1).mean() > 0.3
    np.testing.assert_allclose(found[::64], limited(CORNERS, 1500, ratio=ratio), rtol=0, atol=1e-11)


def test_two_sides_alike_are_one():
    np.testing.assert_allclose(limited(CORNERS, 1500, ratio=1.0), limited(CORNERS, 1500), rtol=0, atol=1e-12)


def test_down_is_as_many_times_slower_as_told():
    jump = np.repeat([0.0, 10.0, 0.0], 100)
    found = limited(jump, 400, ratio=2.0)
    after = np.arange(1, 101)
    np.testing.assert_allclose(found[100:200], np.minimum(0.4 * after, 10), atol=1e-12)
    np.testing.assert_allclose(found[200:], np.maximum(10 - 0.2 * after, 0), atol=1e-12)
