"""Effects ahead of the hysteresis, behind it and in the sensor; each is the identity at its null."""

import math
from itertools import pairwise

import numpy as np

from .mechanics import lag, linear


def delay(u, t, dead):
    """u(t - dead)."""
    return np.interp(t - dead, t, u)


def jittered(x, t, jitter, fine, rng):
    """x, each sample of `fine` steps read at a time that a draw of its own moves."""
    late = jitter * rng.standard_normal(math.ceil(len(t) / fine))
    return np.interp(t - np.repeat(late, fine)[: len(t)], t, x)


def rate_clip(u, dt, limit):
    """|dUa/dt| <= limit: the output runs after the command at the largest current; Fleming & Leang (2014), ch. 14."""
    out, now, reach = [], float(u[0]), limit * dt
    for target in u.tolist():
        now += min(max(target - now, -reach), reach)
        out.append(now)
    return np.array(out)


def saturating_lag(u, dt, limit, tau):
    """dUa/dt = (U - Ua) / tau, at most `limit`: an amplifier whose current saturates; U a line on each step."""
    out, now, fade = [float(u[0])], float(u[0]), math.exp(-dt / tau)
    reach, first = limit * dt, 1 - tau / dt * (1 - fade)
    for old, new in pairwise(u.tolist()):
        free = fade * now + (1 - fade - first) * old + first * new
        now += min(max(free - now, -reach), reach)
        out.append(now)
    return np.array(out)


def input_lag(u, dt, form, tau):
    """Amplifier on a capacitance: tau Ua' + Ua = U, or two equal poles of tau / 2 behind each other."""
    return lag(u, dt, tau, 2 if form == "two_poles" else 1)


def curved(f, u, gain, form, size):
    """Gain that grows with the voltage or with the displacement asked for: f + size gain u^2, f + size f^2 / gain."""
    return f + size * gain * u**2 if form == "voltage" else f + size * f**2 / gain


def saturating(f, u, gain, form, size):
    """Output that levels off: F tanh(f / F) with F = gain / size; gain (U tanh(u / U) - u) with U = 1 / size; - u^3."""
    if form == "force":
        return gain / size * np.tanh(f * size / gain)
    bend = np.tanh(u * size) / size - u if form == "voltage" else -(size**2) * u**3
    return f + gain * bend


def kelvin_voigt(f, dt, shares, times):
    """f + sum_i x_i, tau_i x_i' + x_i = share_i f; Croft, Shed & Devasia (2001), J. Dyn. Syst. Meas. Contr. 123, 35."""
    return f + sum(share * lag(f, dt, tau) for share, tau in zip(shares, times, strict=True))


def logarithmic_creep(f, dt, share, onset, span):
    """f + share sum of df log10(1 + (t - s) / onset), by three Kelvin-Voigt elements a decade up to `span`.

    Vieira (1986), IBM J. Res. Dev. 30, 553; Ru & Sun (2005), Sens. Actuators A 122, 124. The sum of 1 - exp(-t / tau)
    with three tau a decade rises by three times its share in a decade.
    """
    count = max(3, math.ceil(3 * math.log10(10 * span / onset)))
    times = onset * 10 ** (np.arange(count) / 3 + 0.25)
    return kelvin_voigt(f, dt, [share / 3] * count, times)


def creep(f, voltage, dt, form, size, plan):
    """Creep of the displacement asked for, or of the voltage's own."""
    if form == "logarithmic":
        return logarithmic_creep(f, dt, size, plan["onset"], plan["span"])
    source = voltage if form == "voltage" else f
    crept = kelvin_voigt(source, dt, [size * weight for weight in plan["weights"]], plan["times"])
    return f + crept - source


def drift(t, form, size, plan, record):
    """Drift of the frame: size (1 - exp(-t / tau)), a ramp over `span`, or one of another slope every record."""
    if form == "exponential":
        return size * -np.expm1(-t / plan["time"])
    slope = plan["walk"][record] if form == "walk" else 1.0
    return size * slope * t / plan["span"]


def hum(t, size, plan, record):
    """size sin(2 pi f t + phase) and its third harmonic; the phase is that of the mains when a record starts."""
    phase = plan["phases"][record]
    angle = 2 * math.pi * plan["frequency"] * t + phase
    return size * (np.sin(angle) + plan["third"] * np.sin(3 * angle))


def cyclic_error(x, size, plan):
    """Encoder interpolation error size sin(2 pi x / pitch + phase), with a second harmonic; Heydemann (1981)."""
    angle = 2 * math.pi * x / plan["pitch"]
    first = np.sin(angle + plan["phase"]) - math.sin(plan["phase"])
    return x + size * (first + plan["second"] * np.sin(2 * angle))


def running_span(u):
    """Largest less smallest voltage so far."""
    return np.maximum.accumulate(u) - np.minimum.accumulate(u)


# What no effect of the catalogue explains.


def stick_slip(x, size, plan):
    """A jump by `size` when x passes a position upwards, which goes when it passes a lower one: a burr in the guide."""
    out, over, place, width = [], False, plan["place"], plan["width"]
    for value in x.tolist():
        over = value > place - width if over else value > place
        out.append(value + size if over else value)
    return np.array(out)


def ageing_gain(x, t, size, plan):
    """A gain that falls within a record, by `size` of itself at the end of the span, faster at first."""
    return x * (1 - size * np.sqrt(t / plan["span"]))


def linkage_backlash(x, size):
    """The sensor's linkage has a clearance 2 size: the target is pushed at either rim and else stays."""
    out, place = [], 0.0
    for value in x.tolist():
        place = min(max(place, value - size), value + size)
        out.append(place)
    return np.array(out)


def warm_gain(x, t, size, plan):
    """A gain that follows the temperature of the room, which the air conditioning lets swing."""
    return x * (1 + size * (np.sin(2 * math.pi * t / plan["period"] + plan["phase"]) - math.sin(plan["phase"])))


def crossover(u, size):
    """An amplifier that is dead about the middle of its range: u less a clipped step of half-width `size`."""
    middle = 0.4 * float(np.max(np.abs(u)))
    return u - np.clip(u - middle, -size, size) + np.clip(-middle, -size, size)


def outside(x, t, form, size, plan):
    """One of the things above, at the sensor."""
    acts = {
        "stick_slip": lambda: stick_slip(x, size, plan),
        "ageing_gain": lambda: ageing_gain(x, t, size, plan),
        "linkage_backlash": lambda: linkage_backlash(x, size),
        "warm_gain": lambda: warm_gain(x, t, size, plan),
    }
    return acts[form]()


def sensor_lag(x, dt, form, tau):
    """tau y' + y = x, or a second-order sensor filter with damping 0.7 and the same lag at low frequency."""
    if form == "one_pole":
        return lag(x, dt, tau)
    w = 1.4 / tau
    return linear([[0, 1], [-w * w, -1.4 * w]], [0, w * w], [1, 0], 0.0, x, dt)
