"""Equation of motion of a table, or of two, and linear parts: force over stiffness in (um), displacement out (um)."""

import math
from collections import namedtuple

import numpy as np
from numba import njit
from scipy import signal

# A table: kg, N s/m, N/m; stiffness (1 + quadratic x + cubic x^2); drag v |v|; an eddy-current damper whose gap grows
# by x / gap; and a second mass, the rider, on a spring and a damper of its own.
Table = namedtuple(
    "Table", "mass damping stiffness quadratic cubic drag eddy gap rider_mass rider_stiffness rider_damping"
)
# Friction over stiffness in um, speed in um/s; kind 0 none, 1 LuGre, 2 Dahl, 3 Maxwell slip. `bristle` is the bristles'
# stiffness over that of the table, for Maxwell slip the reach of the elements in um.
Friction = namedtuple("Friction", "kind bristle level breakaway speed inner")
KINDS = {"none": 0.0, "lugre": 1.0, "dahl": 2.0, "slip": 3.0}
NO_FRICTION = Friction(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
SLIPS = np.array([0.35, 0.8, 1.3, 2.2])  # reaches of the Maxwell elements over the mean one
X, V, Y, W, Q, P, Z = range(7)  # place and speed of the table, of the other one, of the rider; bristles


@njit(cache=True)
def _pull(element, level, way, reach):
    """Force of one of four elastic elements that slip at a quarter of the level; over stiffness."""
    return max(-0.25 * level, min(0.25 * level, element + 0.25 * level * way / reach))


@njit(cache=True)
def _rates(state, rate, start, f, g, table, other, two, spring, push, friction, elements):
    """Time derivative of the state into `rate`; `start` is x at the start of the step."""
    x, v, q, w = state[X], state[V], state[Q], state[P]
    force = (
        table.stiffness * (f + push * g - x - table.quadratic * x * x - table.cubic * x**3)
        - table.damping * v
        - table.drag * v * abs(v)
    )
    if table.eddy > 0:
        force -= table.eddy * v / (1.0 + x / table.gap)
    rate[Z] = 0.0
    if friction.kind == 1.0:
        fading = math.exp(-((v / friction.speed) ** 2))
        limit = friction.level + (friction.breakaway - friction.level) * fading
        rate[Z] = v - friction.bristle * abs(v) / limit * state[Z]
        force -= table.stiffness * (friction.bristle * state[Z] + friction.inner * rate[Z])
    elif friction.kind == 2.0:
        rate[Z] = v - friction.bristle * abs(v) / friction.level * state[Z]
        force -= table.stiffness * friction.bristle * state[Z]
    elif friction.kind == 3.0:
        for i in range(4):
            held = _pull(elements[i], friction.level, x - start, friction.bristle * SLIPS[i])
            force -= table.stiffness * held
    if table.rider_mass > 0:
        between = table.rider_stiffness * (q - x) + table.rider_damping * (w - v)
        force += between
        rate[Q], rate[P] = w, -between / table.rider_mass
    if two:
        drawn = spring * (x - state[Y])
        force -= drawn
        back = other.stiffness * (g - state[Y]) - other.damping * state[W] + drawn
        rate[Y], rate[W] = state[W], back / other.mass
    rate[X], rate[V] = v, force / table.mass


@njit(cache=True)
def motion(f, g, dt, table, other, two, spring, push, friction):
    """m x'' + b x' + k (x + a x^2 + c x^3) + F = k (f + push g) and the like for another table in y, by Runge-Kutta.

    F, over k: LuGre, z' = v - s |v| z / g(v), F = s z + s1 z', g = Fc + (Fs - Fc) exp(-(v / vs)^2): Canudas de Wit,
    Olsson, Astrom & Lischinsky (1995), IEEE TAC 40, 419; Dahl (1976), AIAA J. 14, 1675, with Fs = Fc and s1 = 0; or
    four Maxwell elements that slip: Iwan (1966), J. Appl. Mech. 33, 893; Goldfarb & Celanovic (1997), J. Dyn. Syst.
    Meas. Contr. 119, 478. `spring` (N/m) joins the tables, -spring (x - y) on x and as much back on y.
    """
    state, stages, here, out = np.zeros(7), np.zeros((4, 7)), np.zeros(7), np.zeros((2, f.size))
    elements = np.zeros(4)
    out[0, 0] = state[X] = state[Q] = f[0]
    out[1, 0] = state[Y] = g[0]
    for i in range(1, f.size):
        for s in range(4):
            share = 0.0 if s == 0 else 1.0 if s == 3 else 0.5
            if s == 0:
                here[:] = state
            elif s == 3:
                here[:] = state + dt * stages[2]
            else:
                here[:] = state + 0.5 * dt * stages[s - 1]
            now_f, now_g = f[i - 1] + share * (f[i] - f[i - 1]), g[i - 1] + share * (g[i] - g[i - 1])
            _rates(here, stages[s], state[X], now_f, now_g, table, other, two, spring, push, friction, elements)
        before = state[X]
        state = state + dt / 6 * (stages[0] + 2 * stages[1] + 2 * stages[2] + stages[3])
        if friction.kind == 3.0:
            for j in range(4):
                elements[j] = _pull(elements[j], friction.level, state[X] - before, friction.bristle * SLIPS[j])
        out[0, i], out[1, i] = state[X], state[Y]
    return out


def linear(x, dt, numerator, denominator):
    """Output of a transfer function of unit gain, x a line on each step; Franklin, Powell & Workman, ch. 6."""
    b, a, _ = signal.cont2discrete((numerator, denominator), dt, method="foh")
    return x[0] + signal.lfilter(np.squeeze(b), np.squeeze(a), x - x[0])
