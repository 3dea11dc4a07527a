"""Drives in volts, put together segment after segment."""

import math

import numpy as np


class Drive:
    """Samples of a drive. Every segment goes on from the present value; times are in seconds, frequencies in hertz."""

    def __init__(self, rate, start=0.0):
        self.rate = rate
        self.values = [float(start)]
        self.ahead = 0  # samples that are simulated and not recorded

    def _count(self, seconds):
        return max(1, round(seconds * self.rate))

    def _times(self, seconds):
        return np.arange(1, self._count(seconds) + 1) / self.rate

    def _append(self, values):
        self.values.extend(np.asarray(values, float).tolist())
        return self

    def cycled(self, frequency, height, turns=3, rest=0.2):
        """What is ahead of the record: the range gone through, then a rest."""
        self.loops(frequency, height, turns).rest(rest)
        self.ahead = len(self.values) - 1
        return self

    def recorded_from(self, seconds):
        """The recorder starts that long after the run."""
        self.ahead = int(seconds * self.rate)
        return self

    def rest(self, seconds):
        return self._append(np.full(self._count(seconds), self.values[-1]))

    def ramp(self, end, seconds):
        count, start = self._count(seconds), self.values[-1]
        return self._append(start + (end - start) * np.arange(1, count + 1) / count)

    def step(self, level, seconds):
        return self._append(np.full(self._count(seconds), level))

    def stairs(self, levels, seconds):
        for level in levels:
            self.step(level, seconds)
        return self

    def sine(self, frequency, amplitude, turns):
        times = self._times(turns / frequency)
        return self._append(self.values[-1] + amplitude * np.sin(2 * np.pi * frequency * times))

    def loops(self, frequency, height, turns):
        """Raised cosines from the present value to `height` above it and back."""
        times = self._times(turns / frequency)
        return self._append(self.values[-1] + height / 2 * (1 - np.cos(2 * np.pi * frequency * times)))

    def triangles(self, frequency, end, turns):
        start = self.values[-1]
        for _ in range(turns):
            self.ramp(end, 0.5 / frequency).ramp(start, 0.5 / frequency)
        return self

    def reversals(self, levels, speed):
        """Lines from one level to the next at `speed` in volts a second."""
        for level in levels:
            self.ramp(level, max(abs(level - self.values[-1]) / speed, 2 / self.rate))
        return self

    def chirp(self, first, last, seconds, amplitude):
        """Sine whose frequency rises exponentially, faded in and out."""
        times = self._times(seconds)
        phase = 2 * np.pi * first * seconds / math.log(last / first) * ((last / first) ** (times / seconds) - 1)
        fade = np.minimum(1, np.minimum(times, seconds - times) / (0.04 * seconds))
        return self._append(self.values[-1] + amplitude * fade * np.sin(phase))

    def multisine(self, frequencies, amplitude, seconds, rng):
        times = self._times(seconds)
        wave = sum(np.sin(2 * np.pi * f * times + rng.uniform(0, 2 * np.pi)) for f in frequencies)
        wave = wave * np.minimum(1, np.minimum(times, seconds - times) / (0.05 * seconds))
        return self._append(self.values[-1] + amplitude * wave / np.abs(wave).max())

    def noise(self, first, last, amplitude, seconds, rng):
        """Random voltage with a flat spectrum between two frequencies, faded in and out."""
        count = self._count(seconds)
        spectrum, frequencies = np.zeros(count // 2 + 1, complex), np.fft.rfftfreq(count, 1 / self.rate)
        band = (frequencies >= first) & (frequencies <= last)
        spectrum[band] = rng.normal(size=band.sum()) + 1j * rng.normal(size=band.sum())
        wave, times = np.fft.irfft(spectrum, count), self._times(seconds)
        wave *= np.minimum(1, np.minimum(times, times[-1] - times) / (0.05 * seconds))
        return self._append(self.values[-1] + amplitude * wave / np.abs(wave).max())

    def array(self, count=None):
        """Its samples, with a rest at the end up to `count` of them."""
        padding = [self.values[-1]] * (0 if count is None else count - len(self.values))
        return np.array(self.values + padding)
