"""Asymmetric Bouc-Wen memory against its closed forms."""

import numpy as np
import pytest

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
