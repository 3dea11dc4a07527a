"""Voltages of a record, all from 0 V: loops, holds, sines, chirps, tones and random motion."""

import numpy as np
from scipy import signal

# Shares of the range that a nested loop visits, with revisits of its reversals.
NESTED = (1, 0.1, 0.9, 0.25, 0.8, 0.4, 0.7, 0.4, 0.7, 0.45, 0.9, 0.6, 0.8, 0.6, 0.8, 0.3, 1, 0)
CHIRP_BIAS = {"chirp": 0.5, "chirplo": 0.2, "chirphi": 0.8}


def _triangle(t, frequency):
    return 1 - np.abs(2 * ((t * frequency) % 1) - 1)


def _nested(t, seconds, top):
    levels = top * np.array(NESTED)
    ways = np.abs(np.diff(np.r_[0, levels]))
    return np.interp(t, np.cumsum(np.r_[0, ways / ways.sum() * seconds * 0.97]), np.r_[0, levels])


def _steps(rng, t, seconds, top, frequency, rate, edge):
    """Levels by chance with holds; each edge is rounded by a Hann window of `edge` seconds."""
    count = max(3, int(seconds * frequency))
    levels = top * rng.choice([0.15, 0.3, 0.45, 0.6, 0.8, 1.0], count)
    levels[0], levels[1], levels[2] = top * 0.8, top * 0.3, top * 0.25
    u = levels[np.minimum((t * count / seconds).astype(int), count - 1)]
    u[: int(0.02 * len(t))] = 0
    taps = max(1, int(edge * rate))
    if taps < 2:
        return u
    window = np.hanning(taps + 2)
    return signal.lfilter(window[1:-1] / window.sum(), 1, u)


def _chirp(t, seconds, top, band, bias, share):
    """Up to a bias, then a logarithmic chirp about it."""
    rest = 0.15 * seconds
    done = np.clip((t - rest) / (seconds - rest), 0, 1)
    log = np.log(band[1] / band[0])
    phase = 2 * np.pi * band[0] * (seconds - rest) / log * (np.exp(done * log) - 1)
    rise = bias * top * (1 - np.cos(np.pi * np.minimum(t / (0.9 * rest), 1))) / 2
    return np.where(t < rest, rise, bias * top + share * top * np.clip(done * 40, 0, 1) * np.sin(phase))


def _tones(rng, t, seconds, top, band):
    """Fourteen tones, evenly spaced in the logarithm, with random phases, about 45 % of the range."""
    orders = np.unique(np.round(np.geomspace(1, band[1] / band[0], 14)))
    fade = np.clip(t / (0.1 * seconds), 0, 1)
    u = sum(np.sin(2 * np.pi * band[0] * k * t + rng.uniform(0, 6.28)) / k**0.35 for k in orders)
    u /= np.abs(u).max()
    return top * (0.45 * (1 - np.cos(np.pi * np.minimum(fade, 1))) / 2 + 0.4 * fade * u)


def _random(rng, t, seconds, top, frequency, rate):
    """Low-passed noise over the whole range, faded in from 0 V."""
    b, a = signal.butter(3, min(0.8, 2 * frequency / rate))
    settle = int(5 * rate / frequency)
    u = signal.lfilter(b, a, rng.standard_normal(len(t) + settle))[settle:]
    u -= u.min()
    u *= top / u.max()
    return u * np.clip(t / (0.06 * seconds), 0, 1)


def drive(rng, kind, rate, seconds, top, frequency, resonance=0):
    """Voltage of one record.

    frequency: Hz, of a chirp or of tones (lowest, highest); `resonance` of the stage, 0 without one: chirps are gentle
    and steps are as fast as one period of it.
    """
    t = np.arange(round(seconds * rate)) / rate
    if kind == "zero":
        return np.zeros(len(t))
    if kind == "tri":
        return top * _triangle(t, frequency)
    if kind == "tridec":
        return top * np.maximum(0.25, 1 - 0.17 * np.floor(t * frequency)) * _triangle(t, frequency)
    if kind == "sine":
        return top / 2 * (1 - np.cos(2 * np.pi * frequency * t))
    if kind == "bip":
        return top * np.sin(2 * np.pi * frequency * t)
    if kind == "nest":
        return _nested(t, seconds, top)
    if kind == "steps":
        return _steps(rng, t, seconds, top, frequency, rate, 1.0 / resonance if resonance else 0.004 * seconds)
    if kind in CHIRP_BIAS:
        return _chirp(t, seconds, top, frequency, CHIRP_BIAS[kind], 0.02 if resonance else 0.06)
    if kind == "ms":
        return _tones(rng, t, seconds, top, frequency)
    if kind == "rand":
        return _random(rng, t, seconds, top, frequency, rate)
    if kind == "hold":
        return top * np.clip(t / (0.08 * seconds), 0, 1)
    raise KeyError(kind)
