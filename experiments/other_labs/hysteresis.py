"""Hysteresis operators from a voltage to a displacement in micrometres, each from a demagnetised state."""

import math

import numpy as np
from scipy.special import erf, ndtri


def _relaxing_step(q, source, decay, length):
    """q at the end of dq/ds = source - decay q over `length`."""
    if abs(decay) < 1e-12:
        return q + source * length
    return q * math.exp(-decay * length) - source * math.expm1(-decay * length) / decay


def _way_to_zero(q, source, decay):
    """Length after which q < 0 is zero."""
    if abs(decay) < 1e-12:
        return -q / source
    ratio = 1 - decay * q / source
    return math.log(ratio) / decay if ratio > 0 else 1e99


def bouc_wen(drive, gain, alpha, beta, gamma, relax=None, dt=None, rate=None, tilt=0.0):
    """gain u - h with dh = alpha gain du - beta |du| h - gamma du |h| (Bouc 1967, Wen 1976), each step in closed form.

    relax(h, dt): h after a rest of dt. rate(speed): factor on alpha. tilt: h' gains alpha gain tilt u |u'| besides.
    """
    h, samples = 0.0, drive.tolist()
    out = np.empty(len(drive))
    out[0] = gain * samples[0]
    for i in range(1, len(samples)):
        change = samples[i] - samples[i - 1]
        if change != 0.0:
            sign, length = 1.0 if change > 0 else -1.0, abs(change)
            q = sign * h
            source = alpha * gain
            if rate is not None:
                source *= rate(length / dt)
            if tilt:
                source = source + sign * (tilt * (samples[i] + samples[i - 1]) / 2) * (alpha * gain)
            if q < 0:
                falling = _way_to_zero(q, source, beta - gamma)
                if length <= falling:
                    q, length = _relaxing_step(q, source, beta - gamma, length), 0.0
                else:
                    q, length = 0.0, length - falling
            if length > 0:
                q = _relaxing_step(q, source, beta + gamma, length)
            h = sign * q
        if relax is not None:
            h = relax(h, dt)
        out[i] = gain * samples[i] - h
    return out


def _sign(value):
    return (value > 0) - (value < 0)


def generalised_bouc_wen(
    drive, gain, alpha, beta, gamma, beta_2=0, beta_3=0, beta_4=0, beta_5=0, beta_6=0, centre=0.0, longest=0.004
):
    """Shape function of Song and Der Kiureghian (2006), driven by the voltage, by midpoint steps.

    longest: length of a step as a share of the range of the drive.
    """

    def slope(u, h, way):
        shape = beta * _sign(way * h) + gamma + beta_2 * _sign(u * way) + beta_3 * _sign(u * h)
        return alpha * gain - abs(h) * (shape + beta_4 * way + beta_5 * _sign(h) + beta_6 * _sign(u))

    limit = longest * (drive.max() - drive.min())
    h, samples = 0.0, drive.tolist()
    out = np.empty(len(drive))
    out[0] = gain * samples[0]
    for i in range(1, len(samples)):
        start, change = samples[i - 1], samples[i] - samples[i - 1]
        if change:
            count = int(abs(change) / limit) + 1
            step, way = change / count, 1 if change > 0 else -1
            for j in range(count):
                u = start + (j + 0.5) * step - centre
                middle = h + 0.5 * step * slope(u, h, way)
                h += step * slope(u, middle, way)
        out[i] = gain * samples[i] - h
    return out


def plays(drive, widths, start=0.0, wider=None):
    """Play operators of half-widths `widths`, one a column. wider: what is added to all of them, sample by sample."""
    widths = np.asarray(widths, float)
    state = np.clip(start, drive[0] - widths, drive[0] + widths)
    out = np.empty((len(drive), len(widths)))
    out[0] = state
    for i in range(1, len(drive)):
        now = widths if wider is None else widths + wider[i]
        state = np.minimum(drive[i] + now, np.maximum(drive[i] - now, state))
        out[i] = state
    return out


def prandtl_ishlinskii(drive, gain, reach, weights, wider=None):
    """gain u and eight weighted plays of half-widths up to `reach` (Kuhnen 2003)."""
    return gain * drive + plays(drive, reach * np.arange(1, 9) / 8, wider=wider) @ np.array(weights)


def free_energy(drive, gain, remanence, coercive, spread, interaction, count=160):
    """Homogenised free energy (Smith et al. 2006): lognormal coercive voltages, normal interaction voltages."""
    fields = coercive * np.exp(spread * ndtri((np.arange(count) + 0.5) / count))
    start = np.maximum(-fields, np.minimum(fields, 0.0))
    share = erf(plays(drive, fields, start) / (math.sqrt(2) * interaction)).mean(1)
    return gain * (drive + remanence * share - remanence)


def preisach(drive, gain, interaction, fields, weights):
    """Preisach operator (Mayergoyz 1986): `weights` of coercive voltages times a normal interaction voltage."""
    return gain * drive + erf(plays(drive, fields) / (math.sqrt(2) * interaction)) @ weights


def two_groups(low, high, top, count=60):
    """Coercive voltages and their shares: 60 % lognormal about `low`, 40 % normal about `high`, up to `top`."""
    x = np.linspace(0.25, top, count)
    log_width, width, share = 0.35, 0.25, 0.6
    density = share * np.exp(-((np.log(x / low) / log_width) ** 2) / 2) / (x * log_width)
    density = density + (1 - share) * np.exp(-(((x - high) / (width * high)) ** 2) / 2) / (width * high)
    return x, density / density.sum()


def domain_walls(drive, saturation, width, coupling, pinning, reversible, longest=0.004):
    """Domain walls after Jiles and Atherton (1986), for ferroelectrics Smith and Hom (1999), by Heun steps.

    The polarisation p over its saturation solves p = c tanh(E) + (1 - c) p_irr with E = u / width + coupling p.
    """

    def polarisation(u, irreversible, p):
        for _ in range(30):
            level = math.tanh(u / width + coupling * p)
            fault = p - reversible * level - (1 - reversible) * irreversible
            change = fault / (1 - reversible * coupling * (1 - level * level))
            p -= change
            if abs(change) < 1e-13:
                break
        return p, math.tanh(u / width + coupling * p)

    def slope(u, irreversible, p, sign):
        p, level = polarisation(u, irreversible, p)
        away = max(sign * (level - irreversible), 0.0)
        return p, away / (pinning - coupling * width * away)

    limit = longest * (drive.max() - drive.min())
    irreversible = p = 0.0
    out, points = np.empty(len(drive)), [0.0, *drive.tolist()]
    for i in range(1, len(points)):
        change = points[i] - points[i - 1]
        if change:
            count = int(abs(change) / limit) + 1
            step, sign, u = change / count, 1.0 if change > 0 else -1.0, points[i - 1]
            for _ in range(count):
                p, first = slope(u, irreversible, p, sign)
                _, second = slope(u + step, irreversible + step * first, p, sign)
                irreversible += step * (first + second) / 2
                u += step
            p, _ = polarisation(points[i], irreversible, p)
        out[i - 1] = saturation * p
    return out


BOUC_WEN = ("gain", "alpha", "beta", "gamma")
SHAPE = ("beta_2", "beta_3", "beta_4", "beta_5", "beta_6", "centre")
ARGUMENTS = {
    "bouc_wen": (bouc_wen, BOUC_WEN),
    "generalised_bouc_wen": (generalised_bouc_wen, BOUC_WEN + SHAPE),
    "homogenized_energy": (free_energy, ("gain", "remanence", "coercive", "spread", "interaction")),
    "preisach": (preisach, ("gain", "interaction", "fields", "weights")),
    "domain_wall": (domain_walls, ("saturation", "width", "coupling", "pinning", "reversible")),
}


def operator(base, drive, parameters, **more):
    """The operator `base` with its parameters of an axis."""
    if base == "prandtl_ishlinskii":
        weights = [parameters[f"weight_{i}"] for i in range(1, 9)]
        return prandtl_ishlinskii(drive, parameters["gain"], parameters["reach"], weights, **more)
    function, names = ARGUMENTS[base]
    return function(drive, **{name: parameters[name] for name in names}, **more)
