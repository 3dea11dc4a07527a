"""Slow twin of the Bouc-Wen operator: its differential equation, integrated."""

from itertools import pairwise

import numpy as np
from scipy.integrate import solve_ivp


def bouc_wen(drive, gain, alpha, beta, gamma):
    """gain u - h at each sample of a drive that is linear between samples, h = 0 at the first.

    dh/dt = alpha d du/dt - beta |du/dt| h - gamma du/dt |h| (Lin & Lin 2012, Mechatronics 22, 614, eq. 5), rate
    independent, so integrated over u, for h / d. Every step stops where h changes sign, since |h| has a kink there.
    """
    memory = [0.0]
    for start, end in pairwise(np.asarray(drive, float)):
        memory.append(_travel(memory[-1], start, end, alpha, beta, gamma))
    return gain * (np.asarray(drive) - memory)


def _travel(h, start, end, alpha, beta, gamma):
    direction = np.sign(end - start)
    while start != end:
        away = h == 0 or h * direction * alpha > 0  # no sign change ahead
        sign = direction * np.sign(alpha) if h == 0 else np.sign(h)

        def slope(u, state, sign=sign):
            return alpha - beta * direction * state - gamma * sign * state

        def zero(u, state):
            return state[0]

        zero.terminal = True
        events = None if away else zero
        path = solve_ivp(slope, (start, end), [h], method="DOP853", rtol=1e-12, atol=1e-14, events=events)
        start, h = (path.t[-1], 0.0) if path.status == 1 else (end, path.y[0, -1])
    return h
