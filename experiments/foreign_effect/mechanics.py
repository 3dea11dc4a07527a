"""Mechanics of a stage: force over stiffness in (um), displacement out (um), at rest at the start."""

import math
from itertools import pairwise

import numpy as np
from scipy.linalg import expm
from scipy.signal import lfilter


def linear(a, b, c, d, f, dt):
    """Output of x' = A x + B f, y = C x + D f for f a line on each step, exactly; Franklin, Powell & Workman, ch. 6."""
    a, b, c = np.atleast_2d(a).astype(float), np.asarray(b, float).reshape(-1, 1), np.asarray(c, float).reshape(1, -1)
    n = len(a)
    block = np.zeros((n + 2, n + 2))
    block[:n, :n], block[:n, n : n + 1], block[n, n + 1] = a * dt, b * dt, 1.0
    e = expm(block)
    phi, one, two = e[:n, :n], e[:n, n : n + 1], e[:n, n + 1 : n + 2]
    # x_k+1 = phi x_k + (one - two) f_k + two f_k+1, as a transfer function in z by its characteristic polynomial
    den = np.poly(phi)
    impulse = np.zeros(n + 1)
    state, gamma = (two).copy(), one - two
    impulse[0] = (c @ state)[0, 0] + d
    state = phi @ state + gamma
    for k in range(1, n + 1):
        impulse[k] = (c @ state)[0, 0]
        state = phi @ state
    num = np.convolve(den, impulse)[: n + 1].real
    offset = f[0]
    rest = d - (c @ np.linalg.solve(a, b))[0, 0]
    return lfilter(num, den.real, f - offset) + rest * offset


def mode(f, dt, frequency, damping):
    """q'' / w^2 + 2 damping q' / w + q = f."""
    w = 2 * math.pi * frequency
    return linear([[0, 1], [-w * w, -2 * damping * w]], [0, w * w], [1, 0], 0.0, f, dt)


def lag(f, dt, tau, poles=1):
    """tau y' + y = f, once or in `poles` equal stages of tau / poles."""
    for _ in range(poles):
        f = linear([[-poles / tau]], [poles / tau], [1], 0.0, f, dt)
    return f


def motion(f, dt, frequency, damping, *, cubic=0.0, friction=None):
    """x'' / w^2 + 2 damping x' / w + x + cubic x^3 + F = f by fourth-order Runge-Kutta, F the friction over stiffness.

    Bristles: z' = v - s |v| z / g(v), F = s z + s1 z' + s2 v, g = Fc + (Fs - Fc) exp(-(v / vs)^2): Canudas de Wit,
    Olsson, Astrom & Lischinsky (1995), IEEE TAC 40, 419; Dahl (1976), AIAA J. 14, 1675, with Fs = Fc and s1 = s2 = 0;
    Coulomb and viscous friction F = Fc tanh(v / vs) + s2 v.
    """
    w2, c = (2 * math.pi * frequency) ** 2, 2 * damping * 2 * math.pi * frequency
    law = friction or {"kind": "none"}
    bristle = law["kind"] in ("lugre", "dahl")
    limit, breakaway, speed = law.get("level", 0.0), law.get("breakaway", law.get("level", 0.0)), law.get("speed", 1.0)
    stiff, inner, viscous = law.get("stiffness", 0.0), law.get("inner", 0.0), law.get("viscous", 0.0)

    def rates(x, v, z, force):
        dz, pull = 0.0, viscous * v
        if bristle:
            g = limit + (breakaway - limit) * math.exp(-min((v / speed) ** 2, 50.0))
            dz = v - stiff * abs(v) * z / g
            pull += stiff * z + inner * dz
        elif limit:
            pull += limit * math.tanh(v / speed)
        return v, w2 * (force - x - cubic * x**3 - pull) - c * v, dz

    forces = f.tolist()
    x, v, z = float(static_cubic(forces[0], cubic)), 0.0, 0.0
    out = [x]
    for old, new in pairwise(forces):
        half = (old + new) / 2
        a1, b1, c1 = rates(x, v, z, old)
        a2, b2, c2 = rates(x + dt / 2 * a1, v + dt / 2 * b1, z + dt / 2 * c1, half)
        a3, b3, c3 = rates(x + dt / 2 * a2, v + dt / 2 * b2, z + dt / 2 * c2, half)
        a4, b4, c4 = rates(x + dt * a3, v + dt * b3, z + dt * c3, new)
        x += dt / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
        v += dt / 6 * (b1 + 2 * b2 + 2 * b3 + b4)
        z += dt / 6 * (c1 + 2 * c2 + 2 * c3 + c4)
        out.append(x)
    return np.array(out)


def static_cubic(f, cubic):
    """x of x + cubic x^3 = f by Newton's method."""
    x = np.array(f, float)
    for _ in range(30):
        x -= (x + cubic * x**3 - f) / (1 + 3 * cubic * x**2)
    return x


def friction_ahead(f, dt, law):
    """Displacement asked for less the friction that it meets, ahead of the equation of motion.

    Dahl on a step, z <- s Fc + (z - s Fc) exp(-sigma |df| / Fc), LuGre likewise with g(v); Coulomb with v = df/dt.
    What is viscous drags against the stiffness alone, s2 x' + x = f.
    """
    steps = np.diff(f, prepend=f[0])
    v = steps / dt
    limit, speed, viscous = law["level"], law.get("speed", 1.0), law.get("viscous", 0.0)
    start = lag(f, dt, viscous) if viscous else f
    if law["kind"] == "coulomb":
        return start - limit * np.tanh(v / speed)
    breakaway = law.get("breakaway", limit)
    level = limit + (breakaway - limit) * np.exp(-np.minimum((v / speed) ** 2, 50.0))
    z, held = 0.0, []
    for s, way, g in zip(np.sign(steps).tolist(), np.abs(steps).tolist(), level.tolist(), strict=True):
        if s:
            z = s * g + (z - s * g) * math.exp(-law["stiffness"] * way / g)
        held.append(z)
    return start - np.array(held)


def carry(f, voltage, dt, plan):
    """Displacement of a stage by its plan: `modes` [(frequency, damping, share)], what acts in it, and a second mode.

    `voltage` is gain times voltage, for a second mode that the voltage drives.
    """
    modes, cubic, law, second = plan["modes"], plan.get("cubic", 0.0), plan.get("friction"), plan.get("second")
    first = f
    if second and second["place"] == "series":
        source = voltage if second["drive"] == "voltage" else f
        first = f + second["share"] * (mode(source, dt, second["frequency"], second["damping"]) - source)
    elif second:
        source = voltage if second["drive"] == "voltage" else f
        first = f - second["share"] * source
    if law and (law["place"] == "ahead" or not modes):
        first, law = friction_ahead(first, dt, law), None
    if not modes:
        x = static_cubic(first, cubic) if cubic else first
    elif law or (cubic and modes[0][0] * dt < 0.2):
        x = motion(first, dt, modes[0][0], modes[0][1], cubic=cubic, friction=law)
    else:
        eased = static_cubic(first, cubic) if cubic else first
        x = sum(share * mode(eased, dt, frequency, damping) for frequency, damping, share in modes)
    if second and second["place"] == "parallel":
        x = x + second["share"] * mode(source, dt, second["frequency"], second["damping"])
    return x
