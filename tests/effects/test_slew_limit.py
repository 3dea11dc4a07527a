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


def charged(drive, **values):
    values = {"slowness": 1 / 400, "ratio": 2.0, "growth": 0.05} | values
    return response(
        ["slew_limit.charge"], {f"slew_limit.{word}": value for word, value in values.items()}, drive, dt=DT
    )


def test_the_charge_of_a_jump_grows_and_falls_at_the_limits():
    """Q = U + growth / 2 U^2 of -4, 10 and 0 V."""
    found = charged(np.concatenate([[0.0], np.full(99, 10.0), np.full(100, -4.0), np.full(100, 0.0)]))
    charge, after = found + 0.025 * found**2, np.arange(1, 101)
    assert found.max() == 10 and found.min() == pytest.approx(-4)
    np.testing.assert_allclose(charge[1:100], np.minimum(0.4 * after[:-1], 12.5), atol=1e-12)
    np.testing.assert_allclose(charge[100:200], np.maximum(12.5 - 0.2 * after, -3.6), atol=1e-12)
    np.testing.assert_allclose(charge[200:], np.minimum(-3.6 + 0.4 * after, 0), atol=1e-12)


def test_the_charge_of_a_capacitance_that_does_not_grow_is_the_voltage():
    np.testing.assert_allclose(charged(CORNERS, growth=0.0), limited(CORNERS, 400, ratio=2.0), rtol=0, atol=1e-12)


def test_a_charge_is_of_second_order_in_the_step():
    """Where a command moves in a sample."""
    drive = 10 * np.sin(np.arange(200) / 9)
    times = np.arange(199 * 256 + 1) / 256
    exact = response_in(drive, times, 256)
    errors = [np.abs(response_in(drive, times, n) - exact).max() for n in (2, 32)]
    assert errors[0] < 0.01 and errors[0] / errors[1] > 100


def response_in(drive, times, steps):
    """Of a drive that is linear between samples, in so many steps of each."""
    fine = np.interp(times[:: 256 // steps], np.arange(200), drive)
    values = {"slew_limit.slowness": 1 / 400, "slew_limit.ratio": 2.0, "slew_limit.growth": 0.09}
    return response(["slew_limit.charge"], values, fine, dt=DT / steps)[::steps]
