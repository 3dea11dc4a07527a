"""Hysteresis that widens with the rate: that of another alpha at each rate, the same one at 100 V/s."""

import numpy as np
import pytest

from rig import path, response

KNOWN = {"bouc_wen.gain": 0.08, "bouc_wen.alpha": 0.4, "bouc_wen.beta": 0.04, "bouc_wen.gamma": -0.01}
DRIVE = path(0, 80, 10, 60, 0, points=70).round(9)


def driven(drive, dt, rate=0.1, **more):
    return response(["bouc_wen"], KNOWN | {"bouc_wen.rate": rate} | more, drive, dt=dt)


def decades(speed, onset=0.01):
    return np.log10((speed + onset) / (100 + onset))


FORMS = [
    ({}, decades),
    ({"bouc_wen.onset": 30.0}, lambda speed: decades(speed, 30)),
    ({"bouc_wen.exponent": 0.4}, lambda speed: (10 ** (0.4 * decades(speed)) - 1) / (0.4 * np.log(10))),
    ({"bouc_wen.level": 30.0}, lambda speed: 4 / np.log(10) * (speed / (speed + 30) - 100 / (100 + 30))),
    ({"bouc_wen.exponent": -0.3}, lambda speed: (10 ** (-0.3 * decades(speed)) - 1) / (-0.3 * np.log(10))),
]


@pytest.mark.parametrize("speed", [1.0, 100.0, 2e4])
@pytest.mark.parametrize(("more", "growth"), FORMS)
def test_at_one_rate_it_is_another_alpha(more, growth, speed):
    drive = path(0, 80, 0, 80, 0, points=80)
    wider = KNOWN | {"bouc_wen.alpha": 0.4 * (1 + 0.1 * growth(speed))}
    found = driven(drive, 1 / speed, **more)
    np.testing.assert_allclose(found, response(["bouc_wen"], wider, drive), rtol=0, atol=1e-12)


def test_each_leg_has_the_alpha_of_its_own_rate():
    """Rising from zero h = alpha d / r (1 - exp(-r s)); what is there already is forgotten at any rate alike."""
    rate, slow, fast = 0.03, 0.4 * 0.08, 0.4 * 0.08 * (1 + 0.1 * decades(1000))
    drive = np.append(np.arange(41.0), np.arange(50.0, 101, 10))  # 100 V/s, then 1000 V/s
    s = drive - 40
    first = slow / rate * -np.expm1(-rate * drive)
    then = slow / rate * -np.expm1(-rate * 40) * np.exp(-rate * s) + fast / rate * -np.expm1(-rate * s)
    np.testing.assert_allclose(driven(drive, 0.01), 0.08 * drive - np.where(s > 0, then, first), rtol=0, atol=1e-12)


def test_a_hold_changes_nothing():
    held = np.repeat(DRIVE[70], 50)
    found = driven(np.concatenate([DRIVE[:71], held, DRIVE[71:]]), 1e-3)
    np.testing.assert_array_equal(found[71:121], found[70])
    np.testing.assert_allclose(np.delete(found, slice(71, 121)), driven(DRIVE, 1e-3), rtol=0, atol=1e-13)


def test_standing_is_not_without_bounds():
    """Far below 0.01 V/s alpha is what it is there; it never turns over."""
    np.testing.assert_allclose(driven(DRIVE, 1e15), driven(DRIVE, 1e18), rtol=0, atol=1e-12)
    far = driven(DRIVE, 1e3, rate=0.3), response(["bouc_wen"], KNOWN | {"bouc_wen.alpha": 0.004}, DRIVE)
    np.testing.assert_allclose(*far, rtol=0, atol=1e-12)


PLAYS = {f"prandtl_ishlinskii.weight_{i}": 0.01 * i for i in range(1, 9)} | {"prandtl_ishlinskii.gain": 0.05}


@pytest.mark.parametrize("speed", [1e-9, 0.1, 50.0, 4e4])
def test_half_widths_that_level_off(speed):
    """From rest they grow by 0.1 4 / log 10 at most: on a branch a play is u less its half-width."""
    words = {"prandtl_ishlinskii.rate": 0.1, "prandtl_ishlinskii.level": 50.0, "prandtl_ishlinskii.reach": 40.0}
    found = response(["prandtl_ishlinskii"], PLAYS | words, path(0, 100, points=100), dt=1 / speed)
    wider = 5.0 * np.arange(1, 9) * (1 + 0.4 / np.log(10) * speed / (speed + 50))
    assert found[-1] == pytest.approx(0.05 * 100 + 0.01 * np.arange(1, 9) @ (100 - wider), rel=1e-9)


@pytest.mark.parametrize("order", [0.5, 1.0])
@pytest.mark.parametrize("speed", [1e-9, 0.1, 50.0, 400.0])
def test_half_widths_that_grow_alike_are_farther_apart_from_zero(order, speed):
    """By 0.02 of the widest at 100 V/s, each of them: on a branch a play is u less its half-width."""
    values = PLAYS | {"prandtl_ishlinskii.reach": 40.0}
    words = {"prandtl_ishlinskii.rate": 0.02, "prandtl_ishlinskii.order": order}
    drive = path(0, 100, points=100)
    found = response(["prandtl_ishlinskii", "rate_dependence.alike"], values | words, drive, dt=1 / speed)
    wider = 5.0 * np.arange(1, 9) + 0.8 * (speed / 100) ** order
    expected = 0.05 * 100 + 0.01 * np.arange(1, 9) @ (100 - wider)
    assert found[-1] == pytest.approx(expected, rel=1e-9)
