"""A stage by NumPy and SciPy alone: Bouc-Wen in closed form between samples, behind it one mass, damper and spring."""

from __future__ import annotations

from math import exp, log

import numpy as np
from numpy.typing import NDArray
from scipy.signal import cont2discrete, lfilter

Array = NDArray[np.float64]
Truth = dict[str, float]
MASS = 0.1  # kg


def bouc_wen(u: Array, gain: float, alpha: float, beta: float, gamma: float) -> Array:
    """d u - h from rest, dh = alpha d du - beta |du| h - gamma du |h|; along the motion, dq/ds = 1 - r q."""
    state, out = 0.0, np.empty(u.size)
    out[0] = gain * u[0]
    for i in range(1, u.size):
        step = u[i] - u[i - 1]
        side = 1.0 if step > 0 else -1.0
        state = side * _travel(side * state, abs(step), beta - gamma, beta + gamma)
        out[i] = gain * u[i] - alpha * gain * state
    return out


def _travel(state: float, length: float, below: float, above: float) -> float:
    """q after a length of 1 - r q, r = below where q < 0."""
    if state < 0:
        to_zero = log(1 - below * state) / below
        if length < to_zero:
            return 1 / below - (1 / below - state) * exp(-below * length)
        state, length = 0.0, length - to_zero
    return 1 / above - (1 / above - state) * exp(-above * length)


def displacement(u: Array, dt: float, truth: Truth) -> Array:
    """um. The force is a line between samples."""
    force = bouc_wen(u, *(truth[name] for name in ("gain", "alpha", "beta", "gamma")))
    stiffness, damping = truth["stiffness"], truth["damping"]
    top, bottom, _ = cont2discrete(([stiffness], [MASS, damping, stiffness]), dt, method="foh")
    return lfilter(top.ravel(), bottom, force)
