"""Drives in volts: straight lines through corners, cosines, sweeps, tones and filtered noise."""

from dataclasses import dataclass

import numpy as np
from scipy import signal


@dataclass(frozen=True)
class Drive:
    rate: float
    values: np.ndarray

    def ahead(self):
        """All but the last sample, with which a record goes on."""
        return Drive(self.rate, self.values[:-1])

    def rest_of(self):
        """A drive of the same length at zero."""
        return Drive(self.rate, np.zeros(self.values.size))


def path(rate, corners, speed, rest=0.2, hold=0.0):
    """Straight lines through the corners at V/s, one speed or one for each, held `hold` s at each corner."""
    times, volts = [0.0], [corners[0]]
    if rest:
        times.append(rest)
        volts.append(corners[0])
    count = (len(corners) - 1,)
    speeds, holds = np.broadcast_to(speed, count), np.broadcast_to(hold, count)
    for corner, each, wait in zip(corners[1:], speeds, holds, strict=True):
        if corner != volts[-1]:
            times.append(times[-1] + abs(corner - volts[-1]) / each)
            volts.append(corner)
        if wait:
            times.append(times[-1] + wait)
            volts.append(corner)
    if rest:
        times.append(times[-1] + rest)
        volts.append(volts[-1])
    return Drive(rate, np.interp(np.arange(round(times[-1] * rate) + 1) / rate, times, volts))


def nested(rate, top, shares, speed, rest=0.2, low=0.0):
    """Reversals at shares of the range from `low` to `top`."""
    return path(rate, [0.0, *(low + (top - low) * share for share in shares)], speed, rest)


def stairs(rate, levels, speed, hold, rest=0.2):
    return path(rate, [0, *levels], speed, rest, hold)


def cosines(rate, heights, frequencies, turns, rest=0.2):
    """Raised cosines, `turns` of each height."""
    parts = [np.zeros(int(rest * rate))]
    for height, frequency in zip(heights, np.broadcast_to(frequencies, (len(heights),)), strict=True):
        count = round(turns * rate / frequency)
        parts.append(height / 2 * (1 - np.cos(2 * np.pi * frequency * np.arange(count) / rate)))
    return Drive(rate, np.concatenate([*parts, np.zeros(int(rest * rate) + 1)]))


def sines(rate, rest, *swings):
    """Sines about zero, each of an amplitude, a frequency and so many samples; `rest` samples before and after."""
    parts = [a * np.sin(2 * np.pi * f * np.arange(count) / rate) for a, f, count in swings]
    return Drive(rate, np.concatenate([np.zeros(rest), *parts, np.zeros(rest)]))


def _faded(count, edge):
    window = np.ones(count)
    rise = 0.5 * (1 - np.cos(np.pi * np.arange(edge) / edge))
    window[:edge], window[-edge:] = rise, rise[::-1]
    return window


def _about(rate, bias, wave, rest, up):
    """A wave about a bias, to which the drive goes in `up` s."""
    parts, count = [np.zeros(int(rest * rate))], int(up * rate)
    if bias:
        parts += [bias * np.arange(count) / count, np.full(int(rest * rate), bias)]
    return Drive(rate, np.concatenate([*parts, bias + wave, np.full(int(rest * rate) + 1, bias)]))


def chirp(rate, bias, height, low, high, seconds, rest=0.05, up=0.05):
    """A sweep whose frequency grows exponentially."""
    count = int(seconds * rate)
    t, ratio = np.arange(count) / rate, high / low
    wave = height * np.sin(2 * np.pi * low * seconds / np.log(ratio) * (ratio ** (t / seconds) - 1))
    return _about(rate, bias, wave * _faded(count, max(count // 25, 8)), rest, up)


def multisine(rate, bias, height, low, high, tones, seconds, seed, rest=0.05, up=0.05):
    """Tones that are whole turns of the wave, with phases by lot."""
    rng, count = np.random.default_rng(seed), int(seconds * rate)
    t = np.arange(count) / rate
    frequencies = np.unique(np.round(np.geomspace(low, high, tones) * seconds)) / seconds
    wave = sum(np.sin(2 * np.pi * f * t + rng.uniform(0, 6.283)) for f in frequencies)
    wave = wave * (height / np.abs(wave).max()) * _faded(count, max(count // 20, 8))
    return _about(rate, bias, wave, rest, up)


def noise(rate, low, high, cutoff, seconds, seed, rest=0.2):
    """Filtered white noise between two voltages."""
    rng, count, settled = np.random.default_rng(seed), int(seconds * rate), int(2 * rate / cutoff)
    b, a = signal.butter(3, cutoff / (rate / 2))
    wave = signal.lfilter(b, a, rng.standard_normal(count + settled))[settled:]
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    wave = middle + half * np.clip(wave / np.abs(wave).max() * 1.0, -1, 1)
    still = np.zeros(int(rest * rate))
    return Drive(rate, np.concatenate([still, wave * _faded(count, int(0.1 * count)), still, [0.0]]))
