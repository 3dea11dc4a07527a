"""Hysteresis of a piezo actuator: voltage in (V), free displacement out (um), from a demagnetised start.

Every operator is written from its paper's equation and is exact for a voltage that is a line on each step.
"""

import math

import numpy as np
from scipy.interpolate import RectBivariateSpline
from scipy.special import erf, ndtr, ndtri


def _advance(g, drive, up, down, length):
    """g after a path of `length` with dg/dl = drive - up g where g > 0 and drive - down g where g < 0."""
    for _ in range(2):
        rate = up if g > 0 or (g == 0 and drive >= 0) else down
        away = -g * drive > 0 and (drive - rate * g) * drive > 0  # runs towards zero, and reaches it
        if away:
            slope = drive - rate * g
            reach = math.log(slope / drive) / rate if abs(rate) > 1e-12 else -g / drive
            if reach < length:
                g, length = 0.0, length - reach
                continue
        if abs(rate * length) < 1e-9:
            return g + (drive - rate * g) * length
        return drive / rate + (g - drive / rate) * math.exp(-rate * length)
    return g


def _branches(u, beta, gamma, shape):
    """Decay rates along the motion for h with it and h against it, per step.

    Song & Der Kiureghian (2006), J. Eng. Mech. 132, 610: dz = dx (A - |z| psi), psi = b1 sgn(dx z) + b2 sgn(x dx)
    + b3 sgn(x z) + b4 sgn(dx) + b5 sgn(z) + b6 sgn(x), here beside Bouc and Wen's gamma + beta sgn(dx z).
    """
    step = np.sign(np.diff(u))
    middle = (u[1:] + u[:-1]) / 2 - shape.get("centre", 0.0)
    side = np.sign(middle)
    b2, b3, b4, b5, b6 = (shape.get(key, 0.0) for key in ("b2", "b3", "b4", "b5", "b6"))

    def psi(sign):
        return gamma + beta * sign + b2 * side * step + (b3 * side + b5) * step * sign + b4 * step + b6 * side

    return psi(1.0), -psi(-1.0)


def bouc_wen(u, gain, alpha, beta, gamma, *, dt=1.0, growth=None, tilt=0.0, lean=0.0, shape=None, fade=None):
    """gain u - h,  dh = alpha gain growth(|du/dt|) du - beta |du| h - gamma du |h| + (tilt u + lean) |du| - relaxation.

    Lin & Lin (2012), Mechatronics 22, 614, eq. 5; tilt as in Zhu & Wang (2012), Sens. Actuators A 181, 51;
    `fade(h, dt)` is what time alone does to h.
    """
    steps = np.diff(u)
    length, sign = np.abs(steps), np.sign(steps)
    drive = np.full(len(steps), alpha * gain)
    if growth is not None:
        drive = drive * growth(length / dt)
    drive = drive + sign * (tilt * (u[1:] + u[:-1]) / 2 + lean)
    up, down = _branches(u, beta, gamma, shape or {})
    h, held = 0.0, [0.0]
    for s, a, p, d, way in zip(*(v.tolist() for v in (sign, drive, up, down, length)), strict=True):
        if s:
            h = s * _advance(s * h, a, p, d, way)
        if fade is not None:
            h = fade(h, dt)
        held.append(h)
    return gain * u - np.array(held)


def plays(u, widths, start=0.0):
    """Plays p <- max(u - r, min(u + r, p)) of half-widths r (n, r); Krasnosel'skii & Pokrovskii (1989)."""
    widths = np.asarray(widths, float)
    memory = np.full(widths.shape, start)
    out = np.empty((len(u), len(widths)))
    for i, value in enumerate(u.tolist()):
        memory = np.maximum(value - widths, np.minimum(value + widths, memory))
        out[i] = memory
    return out


def prandtl_ishlinskii(u, gain, weights, widths):
    """gain u + sum_i w_i F_ri[u]; Kuhnen (2003), Eur. J. Control 9, 407."""
    return gain * u + plays(u, widths) @ np.asarray(weights)


def everett_table(remanence, coercive, spread, interaction, law, reach, points=360):
    """Everett function E(a, b) of a density nu1(Ec) nu2(Ei) of relays that turn up at Ec - Ei and down at -Ec - Ei.

    E(a, b) = 2 P_R int nu1 max(0, Phi2(-Ec - b) - Phi2(Ec - a)) dEc; Mayergoyz (2003), Mathematical Models of
    Hysteresis, ch. 1. nu1 is lognormal with median `coercive`, or normal about it with `spread` relative to it.
    """
    share = (np.arange(400) + 0.5) / 400
    if law == "lognormal":
        fields = coercive * np.exp(spread * ndtri(share))
    else:
        low = ndtr(-1 / spread)
        fields = coercive * (1 + spread * ndtri(low + (1 - low) * share))
    axis = np.linspace(-reach, reach, points)
    above = ndtr((-fields[None] - axis[:, None]) / interaction)
    below = ndtr((fields[None] - axis[:, None]) / interaction)
    table = np.empty((points, points))
    for i in range(points):
        table[i] = np.maximum(above - below[i], 0).sum(axis=1)
    fine = np.linspace(-reach, reach, 4 * (points - 1) + 1)
    return fine, 2 * remanence / 400 * RectBivariateSpline(axis, axis, table)(fine, fine)


def _reader(grid, table):
    """E(a, b) between the points of a table, bilinear."""
    low, scale, last = grid[0], 1 / (grid[1] - grid[0]), len(grid) - 2

    def read(a, b):
        x, y = (a - low) * scale, (b - low) * scale
        i, j = min(max(int(x), 0), last), min(max(int(y), 0), last)
        x, y = x - i, y - j
        top, bottom = table[i], table[i + 1]
        return (1 - x) * ((1 - y) * top[j] + y * top[j + 1]) + x * ((1 - y) * bottom[j] + y * bottom[j + 1])

    return read


def preisach(u, everett, reach, decay=0.985):
    """Preisach operator by its memory of dominant extremes, demagnetised by an alternating field that dies out.

    `everett(a, b)` is the change of the output when a virgin interval from b to a is passed.
    f = f_r + E(u, u_r) upwards, f_r - E(u_r, u) downwards; Mayergoyz (2003), ch. 1.
    """
    now, f, extremes = reach, 0.5 * everett(reach, -reach), []
    while abs(now) > 1e-3 * reach:
        extremes.append((now, f))
        following = -now * decay
        f += everett(following, now) if following > now else -everett(now, following)
        now = following
    extremes.append((now, f))
    out = []
    for new in u.tolist():
        if new != now:
            f = _pass(extremes, everett, new, now, f)
            now = new
        out.append(f)
    return np.array(out)


def _pass(extremes, everett, new, now, f):
    """The output at the voltage `new`, coming from `now`; extremes that are passed are wiped out."""
    upwards = new > now
    if extremes[-1][0] == now and (now > extremes[-2][0]) == upwards:
        extremes.pop()  # it goes on where it came to rest
    if extremes[-1][0] != now and (extremes[-1][0] < now) != upwards:
        extremes.append((now, f))  # a turning point
    while len(extremes) > 2 and ((new >= extremes[-2][0]) if upwards else (new <= extremes[-2][0])):
        del extremes[-2:]
    turn, level = extremes[-1]
    return level + everett(new, turn) if new > turn else level - everett(turn, new)


def preisach_density(u, gain, table):
    """gain u plus the Preisach operator of an Everett table."""
    grid, values = table
    read = _reader(grid, [row.tolist() for row in values])
    return gain * u + preisach(u, read, 0.98 * float(grid[-1]))


def rayleigh(u, slope):
    """Preisach operator of a constant density: E(a, b) = slope (a - b)^2 / 2.

    Rayleigh's law, as in Damjanovic (1997), Phys. Rev. B 55, R649.
    """
    return preisach(u, lambda a, b: 0.5 * slope * (a - b) ** 2, 1.2 * float(np.max(np.abs(u))) + 1.0)


def free_energy(u, gain, remanence, coercive, spread, interaction, *, dt=1.0, theta=0.0, speed=1.0):
    """gain u + P_R int nu1(Ec) erf(p / (2^0.5 sigma)) dEc, p the interaction field at which domains turn.

    Smith et al., Model Development for AFM Stage Mechanisms, eqs. 7-14. Without thermal activation p is a play.
    """
    nodes = 240 if theta == 0 else 90
    fields = coercive * np.exp(spread * ndtri((np.arange(nodes) + 0.5) / nodes))
    front = plays(u, fields) if theta == 0 else _activated(u, fields, dt, theta, speed)
    return gain * u + remanence * erf(front / (math.sqrt(2) * interaction)).mean(axis=1)


def _activated(u, fields, dt, theta, speed):
    """Fronts p that move by Arrhenius' rate, dp/dt = s speed exp((g - Ec) / theta), g = s (E - p), s the sign of E - p.

    With y = exp(-g / theta) and E a line, dy/dt = -(s E' / theta) y + (speed / theta) exp(-Ec / theta): exact, in logs.
    """
    front, before = np.zeros(len(fields)), 0.0
    out = np.empty((len(u), len(fields)))
    hazard = math.log(speed * dt / theta) - fields / theta
    for i, value in enumerate(u.tolist()):
        gap = (value + before) / 2 - front
        side = np.where(gap < 0, -1.0, 1.0)
        path = side * (value - before) / theta
        path = np.where(np.abs(path) < 1e-9, 1e-9, path)
        old = side * (before - front) / theta + path
        new = -np.logaddexp(-old, hazard + np.log(-np.expm1(-path) / path))
        new = np.maximum(new, np.minimum(old, 0.0))
        front, before = value - side * theta * new, value
        out[i] = front
    return out
