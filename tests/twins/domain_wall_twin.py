"""Slow twin of the domain wall model: its differential equation between samples, P by a bracketed root."""

from itertools import pairwise

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq


def plain(field, p, a, alpha, p_s):
    """Eqs. 3 and 4."""
    return p_s * np.tanh((field + alpha * p) / a)


def biased(reversal, bias, way, a, alpha, p_s):
    """P_an(E, P) of eq. 5 by the reversal (E1, P1) and the bias (E0, P0); way is the sign of dE."""
    (e1, p1), (e0, p0) = reversal, bias
    share = (p1 + p_s) / (plain(e1, p1, a, alpha, p_s) + p_s)
    return lambda e, p: -(share * plain(2 * e0 - e, 2 * p0 - p, a, alpha, p_s) - (1 - share) * way * p_s) + 2 * p0


def anhysteretic(pin, field, a, alpha, c, p_s, curve=None):
    """P_an with P = c P_an + (1 - c) P_irr, eq. 8."""
    curve = curve or (lambda e, p: plain(e, p, a, alpha, p_s))
    return brentq(lambda p: p - curve(field, c * p + (1 - c) * pin), -3 * p_s, 3 * p_s, xtol=1e-15)


def domain_wall(drive, a, alpha, k, c, p_s, virgin=0.0, pin=0.0, curve=None):
    """P at every sample, from P_irr = 0 at no field; eqs. 6 to 8."""

    def slope(field, pin, sign):
        ahead = max(sign * (anhysteretic(pin[0], field, a, alpha, c, p_s, curve) - pin[0]), 0.0)
        return [ahead / (k - alpha * ahead)]

    result = []
    for before, now in pairwise([virgin, *drive]):
        if now != before:
            sign = np.sign(now - before)
            found = solve_ivp(slope, (before, now), [pin], args=(sign,), rtol=1e-8, atol=1e-10)
            pin = found.y[0, -1]
        result.append(c * anhysteretic(pin, now, a, alpha, c, p_s, curve) + (1 - c) * pin)
    return np.array(result)


def minor_loop(rise, fall, back, a, p_s, **walls):
    """P over three legs, each from the end of the one before: biased about (0, 0) on the fall, about the middle of the
    two reversals on the way back. P_irr is P at a reversal."""
    first = domain_wall(rise, a, p_s=p_s, **walls)
    top = rise[-1], first[-1]
    given = {"a": a, "alpha": walls["alpha"], "p_s": p_s}
    down = biased(top, (0.0, 0.0), -1, **given)
    second = domain_wall(fall, a, p_s=p_s, virgin=rise[-1], pin=top[1], curve=down, **walls)
    bottom = fall[-1], second[-1]
    up = biased(top, tuple(np.add(top, bottom) / 2), 1, **given)
    third = domain_wall(back, a, p_s=p_s, virgin=fall[-1], pin=bottom[1], curve=up, **walls)
    return np.concatenate([first, second, third])
