"""Mains hum and vibration of the floor."""

import numpy as np

from pzt_ident.block import Addition, Place
from pzt_ident.parameter import Parameter
from pzt_ident.registry import blocks


@blocks.register
class PeriodicDisturbance(Addition):
    """Hum or vibration adds to the displacement: y = x + a sin(2 pi f t) + b cos(2 pi f t), t from the start.

    Fleming & Leang (2014), Design, Modeling and Control of Nanopositioning Systems. Each record has its own phase.
    """

    place = Place.OUTPUT
    sine = Parameter("response", (-1, 1), "Part in phase at the start of a record.", null=0, per_record=True)
    cosine = Parameter("response", (-1, 1), "Part a quarter period ahead of it.", null=0, per_record=True)
    frequency = Parameter("Hz", (1, 1000), "Frequency of the disturbance.", scale="log")
    looks_like = ()
    separate_by = "Record at constant voltage, then with the driver off: a line that stays is not the drive's."
    remedy = "Ground and shield against hum, isolate the stage from the floor, or filter the line out."

    def basis(t, frequency):
        phase = 2 * np.pi * frequency * t
        return np.sin(phase), np.cos(phase)

    def guess(times, residuals, low, high):
        """The strongest lines of the residuals of all records, Hz."""
        grid = np.arange(low, high, 0.1 / max(t[-1] - t[0] for t in times))
        power = np.zeros(grid.size)
        for t, residual in zip(times, residuals, strict=True):
            rate = (t.size - 1) / (t[-1] - t[0])
            size = 2 ** int(np.ceil(np.log2(8 * t.size)))
            lines = np.abs(np.fft.rfft(residual, size)) ** 2 / t.size
            power += np.interp(grid, np.arange(lines.size) * rate / size, lines, right=0)
        peaks = np.flatnonzero((power[1:-1] > power[:-2]) & (power[1:-1] >= power[2:])) + 1
        return grid[peaks[np.argsort(-power[peaks])[:3]]]
