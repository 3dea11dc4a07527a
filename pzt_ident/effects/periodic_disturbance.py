"""Mains hum and vibration of the floor."""

import numpy as np

from pzt_ident.model.block import Addition, Place
from pzt_ident.model.parameter import Parameter
from pzt_ident.model.registry import blocks

PERIODS = 8
LEAST = 3  # periods in a record, of fewer it could be the response itself
HARMONICS = 20  # of the drive, that hysteresis leaves in the residual


@blocks.register
class PeriodicDisturbance(Addition):
    """Hum or vibration adds to the displacement: y = x + a sin(2 pi f t) + b cos(2 pi f t), t from the start.

    Fleming & Leang (2014), Design, Modeling and Control of Nanopositioning Systems. Each record has its own phase; one
    of fewer than three periods has none.
    """

    place = Place.OUTPUT
    sine = Parameter("response", (-1, 1), "Part in phase at the start of a record.", null=0, per_record=True)
    cosine = Parameter("response", (-1, 1), "Part a quarter period ahead of it.", null=0, per_record=True)
    frequency = Parameter("Hz", (1, 1000), "Frequency of the disturbance.", scale="log")
    look_alikes = ()
    separate_by = "Record at constant voltage, then with the driver off: a line that stays is not the drive's."
    remedy = "Ground and shield against hum, isolate the stage from the floor, or filter the line out."

    def basis(t, frequency):
        phase, there = 2 * np.pi * frequency * t, frequency * (t[-1] - t[0]) >= LEAST
        return there * np.sin(phase), there * np.cos(phase)

    def guess(times, drives, residuals, low, high):
        """The strongest lines of the residuals of all records, Hz: those of some periods that are not the drive's."""
        grid = np.arange(low, high, 0.1 / max(t[-1] - t[0] for t in times))
        power = np.zeros(grid.size)
        for t, drive, residual in zip(times, drives, residuals, strict=True):
            frequency, lines = spectrum(t, residual)
            power += np.interp(grid, frequency, lines, right=0) * own(grid, t, drive)
        peaks = np.flatnonzero((power[1:-1] > power[:-2]) & (power[1:-1] >= power[2:])) + 1
        return grid[peaks[np.argsort(-power[peaks])[:3]]]


def spectrum(t, signal):
    """Frequencies in Hz, eight to a line's width, and the power there."""
    size = 2 ** int(np.ceil(np.log2(8 * t.size)))
    rate = (t.size - 1) / (t[-1] - t[0])
    return np.arange(size // 2 + 1) * rate / size, np.abs(np.fft.rfft(signal, size)) ** 2 / t.size


def own(grid, t, drive):
    """Whether a line at a frequency is a record's own: PERIODS of it fit in, and it is no harmonic of a drive that
    goes to and fro at one frequency, a third of its power or more."""
    seconds = t[-1] - t[0]
    frequency, lines = spectrum(t, drive - drive.mean())
    first = frequency[np.argmax(lines)]
    near = np.abs(frequency - first) < 1 / seconds
    found = grid * seconds >= PERIODS
    if first * seconds >= 3 and lines[near].sum() > lines.sum() / 3:
        order = np.round(grid / first)
        found &= (order > HARMONICS) | (np.abs(grid - order * first) > 1 / seconds)
    return found
