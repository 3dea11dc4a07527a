"""Relaxing memory: of Bouc-Wen an exponential of time in a hold, of plays a logarithm."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from pzt_ident.hysteresis._play import relaxation_coefficients, relaxed_play
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


FLUCTUATION, HALF = 40.0, 900.0


def ramp(steps, rate, start=-2000.0, stop=2000.0):
    """The play of a ramp from where it lies on its upper edge, (steps + 1,), and the field."""
    field = np.linspace(start, stop, steps + 1)
    heat = relaxation_coefficients(FLUCTUATION, (stop - start) / rate / steps)
    p = [start - HALF]
    for before, u in pairwise(field):
        p.append(relaxed_play(p[-1], before, u, HALF, *heat))
    return np.array(p), field


@pytest.mark.parametrize("rate", [0.01, 50.0, 1e5])
def test_a_play_on_a_ramp_is_one_step_however_it_is_divided(rate):
    whole, fine = ramp(1, rate)[0][-1], ramp(500, rate)[0][-1]
    assert fine == pytest.approx(whole, abs=1e-6)


@pytest.mark.parametrize("rate", [1.0, 50.0, 1e4])
def test_the_half_width_of_a_play_grows_with_the_logarithm_of_the_rate(rate):
    p, field = ramp(1000, rate)
    assert field[-1] - p[-1] == pytest.approx(HALF + FLUCTUATION * np.log(rate / FLUCTUATION), abs=1e-6)


def test_a_play_in_a_hold_goes_on_with_the_logarithm_of_time():
    heat, p, found = relaxation_coefficients(FLUCTUATION, 0.5), 100.0, []
    for _ in range(400):
        p = relaxed_play(p, 1000.0, 1000.0, HALF, *heat)
        found.append(p)
    t = 0.5 * np.arange(1, 401)
    np.testing.assert_allclose(found, 100 + FLUCTUATION * np.log(1 + t), atol=1e-7)


def test_a_play_is_its_differential_equation():
    """Through both edges, where they are so near that each is felt at the other."""
    half, dt = 4 * FLUCTUATION, 0.01
    drive = path(0, 600, -500, 200, 150, points=400)
    heat, p, found = relaxation_coefficients(FLUCTUATION, dt), 0.0, []
    for before, u in pairwise(drive):
        p = relaxed_play(p, before, u, half, *heat)
        found.append(p)

    def slope(t, p):
        apart = np.interp(t, dt * np.arange(drive.size), drive) - p
        return FLUCTUATION * (np.exp((apart - half) / FLUCTUATION) - np.exp((-apart - half) / FLUCTUATION))

    t = dt * np.arange(1, drive.size)
    exact = solve_ivp(slope, (0, t[-1]), [0.0], "LSODA", t, max_step=dt, rtol=1e-10, atol=1e-9).y[0]
    np.testing.assert_allclose(found, exact, atol=2e-3 * FLUCTUATION)


def test_a_step_back_arrests_the_domains_of_a_ferroelectric():
    """By f log(100 s over the time that it had); a linear creep would go on with the larger part of the step."""
    known = {"gain": 1e-3, "remanence": 6000.0, "coercive": 900.0, "spread": 0.3, "interaction": 200.0, "bias": 0.0}
    known |= {"quadratic": 0.0, "poled": -1e4, "fluctuation": FLUCTUATION}
    named = {f"homogenized_energy.{word}": value for word, value in known.items()}
    up = path(-1500, 1000, points=50)
    crept = [
        np.ptp(response(["homogenized_energy"], named, np.append(up, np.full(1000, level)), dt=0.1)[53:])
        for level in (1000.0, 700.0)
    ]
    assert crept[0] > 0.5
    assert crept[1] < 0.15 * crept[0]


@pytest.mark.parametrize("activation", [1e-9, 0.1, 0.5, 5.0])
def test_activated_it_decays_as_the_differential_equation_says_in_a_hold(activation):
    """tanh(a h / 2) fades exponentially, h being in volts."""
    drive = np.append(path(0, 80, points=50), np.full(2000, 80))
    held = memory(drive, activation=activation)[50:] / (0.4 * 0.08)
    t = 0.01 * np.arange(held.size)
    law = solve_ivp(
        lambda t, h: -np.sinh(activation * h) / (activation * TAU), (0, t[-1]), held[:1], "LSODA", t, rtol=1e-10, atol=0
    )
    np.testing.assert_allclose(held, law.y[0], rtol=1e-6)


def test_activated_it_is_logarithmic_in_time_while_much_is_left():
    """h falls by 1 / a for each factor of e in time."""
    drive = np.append(path(0, 80, points=50), np.full(4000, 80))
    held = memory(drive, activation=3.0)[50:] / (0.4 * 0.08)
    assert held[40] - held[400] == pytest.approx(np.log(10) / 3, rel=0.05)


def test_it_relaxes_by_branch_and_activated_at_once():
    drive = np.append(path(0, 80, 20, points=50), np.full(100, 20.0))
    by_branch = {"beta_4": 0.01, "beta_2": 0.0, "beta_3": 0.0, "beta_5": 0.0, "beta_6": 0.0, "centre": 0.0}
    found = memory(drive, activation=0.5, **by_branch)
    assert np.abs(found[:101] - memory(drive, activation=0.5)[:101]).max() > 1e-2
    held = found[100:] / (0.4 * 0.08)
    left = 2 * np.arctanh(np.tanh(held[0] / 4) * np.exp(-0.01 * np.arange(101) / TAU)) / 0.5
    np.testing.assert_allclose(held, left, rtol=1e-9)
