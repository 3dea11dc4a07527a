"""Slow twin of the Bouc-Wen oscillator: its differential equation, integrated tightly."""

from itertools import pairwise

import numpy as np
from scipy.integrate import solve_ivp
from scipy.interpolate import make_interp_spline


def oscillator(force, dt, mass, damping, stiffness, alpha, beta_gamma, beta_delta, degree=3):
    """m y'' + c y' + k y + z = u, z' = alpha y' - beta gamma |y'| z - beta delta y' |z|; y at each sample, from rest.

    Noel & Schoukens (2016), Hysteretic benchmark with a dynamic nonlinearity, with nu = 1. The force between samples is
    a spline of that degree (1: straight lines). Integrated sample by sample, since the spline has knots there.
    """
    time = dt * np.arange(len(force))
    applied = make_interp_spline(time, force, k=degree)

    def slope(t, state):
        y, v, z = state.tolist()
        acceleration = (applied(t).item() - damping * v - stiffness * y - z) / mass
        return v, acceleration, alpha * v - beta_gamma * abs(v) * z - beta_delta * v * abs(z)

    full_scale = np.abs(force).max() / stiffness * np.array([1, np.sqrt(stiffness / mass), stiffness])
    states = [np.zeros(3)]
    for start, end in pairwise(time):
        path = solve_ivp(slope, (start, end), states[-1], method="DOP853", rtol=1e-10, atol=1e-12 * full_scale)
        states.append(path.y[:, -1])
    return np.array(states)[:, 0]
