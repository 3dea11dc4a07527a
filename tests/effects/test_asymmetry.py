"""Asymmetric Bouc-Wen memory against its closed forms."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from rig import path, response

GAIN, ALPHA = 0.08, 0.4


def memory(drive, skew, beta=0.0, gamma=0.0):
    """h / (alpha d), V."""
    known = {"gain": GAIN, "alpha": ALPHA, "beta": beta, "gamma": gamma, "asymmetry": skew}
    found = response(["bouc_wen"], {f"bouc_wen.{word}": known[word] for word in known}, drive)
    return (GAIN * drive - found) / (ALPHA * GAIN)


@pytest.mark.parametrize("skew", [-5e-3, 5e-3])
def test_without_forgetting_both_directions_add_to_it(skew):
    """h = u + skew / 2 u^2 on the way up and, from U on, u + skew (U^2 - u^2 / 2) on the way down, for any step."""
    drive = path(0, 80, 0, points=7)
    up, down = drive[:8], drive[8:]
    expected = np.append(up + skew * up**2 / 2, down + skew * (80**2 - down**2 / 2))
    np.testing.assert_allclose(memory(drive, skew), expected, rtol=1e-13, atol=1e-12)


def test_along_a_curve_both_directions_add_to_it():
    """h = u + p(u) on the way up and, from U on, u + 2 p(U) - p(u) on the way down, p' = skew u + ... + skew_3 u^3, to
    second order in the step."""
    skew, errors = np.array([5e-3, -4e-5, 3e-7]), []
    for points in (50, 100):
        drive = path(0, 80, 0, points=points)
        known = {"gain": GAIN, "alpha": ALPHA, "beta": 0.0, "gamma": 0.0}
        known |= dict(zip(("skew", "skew_2", "skew_3"), skew, strict=True))
        found = response(["bouc_wen"], {f"bouc_wen.{word}": value for word, value in known.items()}, drive)
        grown = (drive[:, None] ** [2, 3, 4] / [2, 3, 4]) @ skew
        expected = drive + np.where(np.arange(drive.size) <= points, grown, 2 * grown[points] - grown)
        errors.append(np.abs((GAIN * drive - found) / (ALPHA * GAIN) - expected).max())
    assert errors[0] < 2e-3
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.02)


def test_with_forgetting_it_is_of_second_order_in_the_step():
    """dh/du = 1 + skew u - r h from zero: h = (1 + skew u) / r - skew / r^2 - (1 / r - skew / r^2) exp(-r u)."""
    rate, skew, errors = 0.05, 4e-3, []
    for points in (100, 200):
        u = path(0, 80, points=points)
        particular = (1 + skew * u) / rate - skew / rate**2
        expected = particular - particular[0] * np.exp(-rate * u)
        errors.append(np.abs(memory(u, skew, 0.03, 0.02) - expected).max())
    assert errors[0] < 3e-4
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.02)


@pytest.mark.parametrize(("middle", "lopsided"), [(0.0, False), (40.0, True)])
def test_a_settled_loop_is_lopsided_unless_it_is_about_zero_volts(middle, lopsided):
    """Turned about its centre one branch is the other where the term is odd about it, or where h forgets alike on both
    sides of zero: then h as a whole is shifted."""

    def lopsidedness(skew, gamma=0.05):
        h = memory(middle + path(*[-40, 40] * 8, points=200), skew, 0.07, gamma)[-401:]
        return np.ptp(h[:201] + h[200:]) / np.ptp(h)

    assert lopsidedness(0.0) < 1e-9
    assert (lopsidedness(5e-3) > 0.01) == lopsided
    assert lopsidedness(5e-3, gamma=0.0) < 1e-9


BETAS = {"beta_2": 0.01, "beta_3": -0.008, "beta_4": 0.02, "beta_5": -0.015, "beta_6": 0.012}
BOUC_WEN = {"gain": GAIN, "alpha": ALPHA, "beta": 0.07, "gamma": 0.03}


def by_branch(drive, **more):
    """h / (alpha d), V."""
    found = response(["bouc_wen"], {f"bouc_wen.{word}": value for word, value in (BOUC_WEN | more).items()}, drive)
    return (GAIN * drive - found) / (ALPHA * GAIN)


def test_by_branch_the_memory_is_that_of_the_differential_equation():
    """Legs that end where sgn(x) changes, each integrated over u in pieces that end where h changes its sign."""
    legs, known, h, expected = [0, 40, 80, 40, 10, 40, 60, 40, 0], BOUC_WEN | BETAS, 0.0, [0.0]
    for start, end in pairwise(legs):
        v, x, points = np.sign(end - start), np.sign((start + end) / 2 - 40), np.linspace(start, end, 51)[1:]

        def slope(u, state, v=v, x=x):
            s = np.sign(state[0]) or v
            psi = known["gamma"] + known["beta"] * s * v + known["beta_2"] * x * v + known["beta_3"] * x * s
            psi += known["beta_4"] * v + known["beta_5"] * s + known["beta_6"] * x
            return 1 - abs(state) * psi

        path_of_h = solve_ivp(slope, (start, end), [h], t_eval=points, rtol=1e-10, atol=1e-12, max_step=0.1)
        expected += path_of_h.y[0].tolist()
        h = expected[-1]
    np.testing.assert_allclose(by_branch(path(*legs, points=50), centre=40.0, **BETAS), expected, rtol=0, atol=2e-4)


@pytest.mark.parametrize(
    ("word", "centre", "up", "down"),
    [
        *(("beta_2", 0.0, 0.12, 0.12), ("beta_3", 0.0, 0.12, 0.12), ("beta_6", 0.0, 0.12, 0.08)),
        *(("beta_4", 0.0, 0.12, 0.08), ("beta_5", 0.0, 0.12, 0.08), ("beta_6", -1e3, 0.12, 0.12)),
    ],
)
def test_the_memory_levels_off_at_another_height_on_each_branch(word, centre, up, down):
    """At one over the rate of decay, beta + gamma = 0.1 with the term added or taken off."""
    h = by_branch(path(-400, 400, -400, points=800), centre=centre, **{word: 0.02})
    assert h[800] == pytest.approx(1 / up, rel=1e-6)
    assert h[1600] == pytest.approx(-1 / down, rel=1e-6)


def test_a_step_over_the_centre_takes_the_mean_of_both_sides():
    """So that the response changes smoothly with the centre."""
    drive = path(0, 80, 0, points=16)
    shifted = [by_branch(drive, centre=centre, **BETAS) for centre in (41.0, 41.001, 41.002)]
    first, second = shifted[1] - shifted[0], shifted[2] - shifted[1]
    assert np.abs(first).max() > 0
    np.testing.assert_allclose(first, second, rtol=0, atol=1e-3 * np.abs(first).max())
