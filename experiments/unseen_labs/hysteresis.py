"""Hysteresis of a drive in V at rest at its first sample, in um, and forms of it that the literature prints."""

import math

import numpy as np
from numba import njit
from scipy.special import ndtri


@njit(cache=True)
def _slope(h, sign, gain, alpha, beta, gamma, phi, lean):
    """dh/d|u|."""
    size = abs(h)
    side = 1.0 if h > 0 else (-1.0 if h < 0 else 0.0)
    return gain * alpha * (sign + lean) - beta * h - gamma * sign * size - phi * size * sign * (sign + side)


@njit(cache=True)
def _relaxed(h, dt, relax, activation):
    """Half a step of dh/dt = -relax sinh(activation h) / activation."""
    if relax > 0:
        h -= 0.5 * dt * relax * (math.sinh(activation * h) / activation if activation > 0 else h)
    return h


@njit(cache=True)
def _hysteretic(u, dt, gain, alpha, beta, gamma, phi, lean, rate, onset, relax, activation):
    out = np.zeros(u.size)
    h = 0.0
    for i in range(1, u.size):
        length = abs(u[i] - u[i - 1])
        sign = 1.0 if u[i] > u[i - 1] else -1.0
        grown = alpha
        if rate != 0.0:
            grown = alpha * (1.0 + rate * math.log10(1.0 + length / dt / onset))
        h = _relaxed(h, dt, relax, activation)
        if length > 0:
            k1 = _slope(h, sign, gain, grown, beta, gamma, phi, lean)
            k2 = _slope(h + 0.5 * length * k1, sign, gain, grown, beta, gamma, phi, lean)
            k3 = _slope(h + 0.5 * length * k2, sign, gain, grown, beta, gamma, phi, lean)
            k4 = _slope(h + length * k3, sign, gain, grown, beta, gamma, phi, lean)
            h += length * (k1 + 2 * k2 + 2 * k3 + k4) / 6
        h = _relaxed(h, dt, relax, activation)
        out[i] = h
    return out


def bouc_wen(u, dt, gain, alpha, beta, gamma, phi=0.0, lean=0.0, rate=0.0, onset=1.0, relax=0.0, activation=0.0):
    """Hysteretic part h: dh = alpha gain du - beta |du| h - gamma du |h| (Wen 1976; Lin and Lin 2012), fourth order.

    phi: asymmetry after Wang and Wen (2000). lean: domains that switch more easily one way. rate, onset: alpha grows
    as 1 + rate log10(1 + |du/dt| / onset). relax, activation: dh/dt = -relax sinh(activation h) / activation.
    """
    return _hysteretic(u, dt, gain, alpha, beta, gamma, phi, lean, rate, onset, relax, activation)


@njit(cache=True)
def _play(q, low, high):
    if q < low:
        q = low
    if q > high:
        q = high
    return q


@njit(cache=True)
def _plays(u, widths, weights, dt, share, scale, power):
    p, y = np.zeros(widths.size), np.zeros(u.size)
    for i in range(u.size):
        grown = 1.0
        if share > 0 and i > 0:
            grown = 1.0 + share * math.log(1.0 + scale * (abs(u[i] - u[i - 1]) / dt) ** power)
        for j in range(widths.size):
            width = widths[j] * grown
            p[j] = _play(p[j], u[i] - width, u[i] + width)
            y[i] += weights[j] * p[j]
    return y


def plays(u, widths, weights, dt=1.0, share=0.0, scale=0.0, power=1.0):
    """Weighted plays; their widths grow as 1 + share ln(1 + scale |du/dt|^power) (Al Janaideh, Rakheja, Su 2009)."""
    return _plays(u, widths, weights, dt, share, scale, power)


@njit(cache=True)
def generalised_plays(u, widths, weights, scale, shift):
    """Plays between envelopes scale tanh(u / scale + shift) -+ width (Al Janaideh, Rakheja, Su 2009)."""
    p, y = np.zeros(widths.size) + scale * math.tanh(u[0] / scale + shift), np.zeros(u.size)
    for i in range(u.size):
        bent = scale * math.tanh(u[i] / scale + shift)
        for j in range(widths.size):
            p[j] = _play(p[j], bent - widths[j], bent + widths[j])
            y[i] += weights[j] * p[j]
    return y


@njit(cache=True)
def lorentzian_preisach(u, widths, weights, spread, middle):
    """Preisach density that factorises, Lorentzian in the interaction field (Bertotti 1998)."""
    p, y = np.zeros(widths.size), np.zeros(u.size)
    for i in range(u.size):
        for j in range(widths.size):
            p[j] = min(max(p[j], u[i] - widths[j]), u[i] + widths[j])
            angle = math.atan((p[j] - middle) / spread) + math.atan(middle / spread)
            y[i] += weights[j] * spread * angle
    return y


@njit(cache=True)
def _switched(u, coercive, interaction):
    """Mean polarisation of kernels with normal interaction voltages."""
    p, y = np.zeros(coercive.size), np.zeros(u.size)
    for i in range(u.size):
        for j in range(coercive.size):
            p[j] = _play(p[j], u[i] - coercive[j], u[i] + coercive[j])
            y[i] += math.erf(p[j] / (interaction * 1.4142135623730951))
        y[i] /= coercive.size
    return y


def free_energy(u, gain, remanence, coercive, spread, interaction, nodes=64):
    """Homogenised free energy (Smith et al. 2005): lognormal coercive and normal interaction voltages."""
    quantiles = ndtri((np.arange(nodes) + 0.5) / nodes)
    y = gain * (u + remanence * _switched(u, coercive * np.exp(spread * quantiles), interaction))
    return y - y[0]


@njit(cache=True)
def _polarisation(p, u, irreversible, width, coupling, reversible):
    """Root of p = reversible tanh(u / width + coupling p) + (1 - reversible) irreversible."""
    for _ in range(30):
        bent = math.tanh(u / width + coupling * p)
        step = p - reversible * bent - (1 - reversible) * irreversible
        step /= 1 - reversible * coupling * (1 - bent * bent)
        p -= step
        if abs(step) < 1e-14:
            break
    return p


@njit(cache=True)
def _walls(u, sign, p, irreversible, width, coupling, pinning, reversible):
    """Change of the irreversible polarisation for one volt."""
    p = _polarisation(p, u, irreversible, width, coupling, reversible)
    lack = max(sign * (math.tanh(u / width + coupling * p) - irreversible), 0.0)
    return lack / (pinning - coupling * width * lack)


@njit(cache=True)
def domain_walls(u, width, coupling, pinning, reversible):
    """Polarisation of walls that bend and are pinned (Jiles and Atherton 1986; Smith and Hom 1999)."""
    q, p, y = 0.0, 0.0, np.zeros(u.size)
    for i in range(u.size):
        if i > 0 and u[i] != u[i - 1]:
            start, du = u[i - 1], u[i] - u[i - 1]
            s = 1.0 if du > 0 else -1.0
            k1 = _walls(start + 0.0 * du, s, p, q, width, coupling, pinning, reversible)
            k2 = _walls(start + 0.5 * du, s, p, q + 0.5 * k1 * du, width, coupling, pinning, reversible)
            k3 = _walls(start + 0.5 * du, s, p, q + 0.5 * k2 * du, width, coupling, pinning, reversible)
            k4 = _walls(start + 1.0 * du, s, p, q + k3 * du, width, coupling, pinning, reversible)
            q += du * (k1 + 2 * k2 + 2 * k3 + k4) / 6
        p = _polarisation(p, u[i], q, width, coupling, reversible)
        y[i] = p
    return y


def _bouc_wen(u, dt, p, prompt=None, **more):
    hysteretic = bouc_wen(u, dt, p["gain"], p["alpha"], p["beta"], p["gamma"], **more)
    return p["gain"] * (u if prompt is None else prompt(u)) - hysteretic


def _prandtl_ishlinskii(u, dt, p, reach, **more):
    weights = np.array([p[f"weight_{i}"] for i in range(1, 9)])
    return p["gain"] * u + plays(u, reach / 8 * np.arange(1, 9), weights, dt, **more)


def _homogenized_energy(u, dt, p, **more):
    return free_energy(u, p["gain"], p["remanence"], p["coercive"], p["spread"], p["interaction"], **more)


def _domain_wall(u, dt, p):
    return p["saturation"] * domain_walls(u, p["width"], p["coupling"], p["pinning"], p["reversible"])


OPERATORS = {
    "bouc_wen": _bouc_wen,
    "prandtl_ishlinskii": _prandtl_ishlinskii,
    "homogenized_energy": _homogenized_energy,
    "domain_wall": _domain_wall,
}


def operator(base, u, dt, parameters, **more):
    """Displacement of the base in um; more: what it has beyond the parameters of the job."""
    return OPERATORS[base](u, dt, parameters, **more)
