"""Slow twin of the domain wall model: its differential equation between samples, P by a bracketed root."""

from itertools import pairwise

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq


def anhysteretic(pin, field, a, alpha, c, p_s):
    """P_an with P = c P_an + (1 - c) P_irr. Smith & Salapaka, eqs. 3, 4 and 8."""
    miss = lambda p: p - p_s * np.tanh((field + alpha * (c * p + (1 - c) * pin)) / a)  # noqa: E731
    return brentq(miss, -1.01 * p_s, 1.01 * p_s, xtol=1e-15)


def domain_wall(drive, a, alpha, k, c, p_s, virgin=0.0):
    """P at every sample, from P_irr = 0 at no field; eqs. 6 to 8."""

    def slope(field, pin, sign):
        ahead = max(sign * (anhysteretic(pin[0], field, a, alpha, c, p_s) - pin[0]), 0.0)
        return [ahead / (k - alpha * ahead)]

    pin, result = 0.0, []
    for before, now in pairwise([virgin, *drive]):
        if now != before:
            sign = np.sign(now - before)
            found = solve_ivp(slope, (before, now), [pin], args=(sign,), rtol=1e-8, atol=1e-10)
            pin = found.y[0, -1]
        result.append(c * anhysteretic(pin, now, a, alpha, c, p_s) + (1 - c) * pin)
    return np.array(result)
