"""What a drive does at each sample: which way, how far and how fast it goes, and since when."""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.noise import rough

Array = NDArray[np.float64]
Whole = NDArray[np.intp]


class DriveHistory(NamedTuple):
    """A drive sample by sample, all of shape (samples,).

    way: +1 rising, -1 falling, 0 holding. amplitude: peak to peak of the half cycle between two reversals. rate:
    |dU/dt|, 1/s. since: time since the last reversal, start of a hold, or start of the record, s. cycle: 1, 2, ...,
    two half cycles each.
    """

    way: Whole
    amplitude: Array
    rate: Array
    since: Array
    cycle: Whole

    def behind(self, settle: int) -> DriveHistory:
        """Without the first `settle` samples."""
        way, amplitude, rate, since, cycle = self
        return DriveHistory(way[settle:], amplitude[settle:], rate[settle:], since[settle:], cycle[settle:])


def drive_history(drive: Array, dt: float) -> DriveHistory:
    """The motion of a drive of shape (samples,); what is smaller than half a percent of its span, or than its noise,
    is no motion."""
    samples, span = drive.size, float(np.ptp(drive))
    noise = max([1e-6 * span, *(size for size, _ in rough(drive[None], drive))])
    turn = max(0.005 * span, 8 * noise)
    if span <= turn:
        still, zero = np.zeros(samples, dtype=np.intp), np.zeros(samples)
        return DriveHistory(still, zero, zero, dt * np.arange(samples, dtype=np.float64), still + 1)
    turns = reversals(drive, turn)
    ends = [*turns, samples - 1]
    lengths = np.diff([*turns, samples])
    amplitudes = np.array([np.ptp(drive[first : last + 1]) for first, last in pairwise(ends)])
    ways = np.sign([drive[last] - drive[first] for first, last in pairwise(ends)]).astype(np.intp)
    holds = held(drive, turns, amplitudes, 8 * noise)
    smooth = 1 + int(20 * noise * samples / amplitudes.sum())
    return DriveHistory(
        np.where(holds, 0, np.repeat(ways, lengths)),
        np.repeat(amplitudes, lengths),
        np.where(holds, 0.0, speed(drive, min(smooth, samples - 1)) / dt),
        dt * since(turns, holds),
        np.repeat(np.arange(lengths.size) // 2 + 1, lengths),
    )


def reversals(drive: Array, turn: float) -> list[int]:
    """The first sample, and the extrema from which the drive goes back by `turn` at least."""
    runs = np.flatnonzero(np.diff(drive, prepend=np.inf))
    ways = np.sign(np.diff(drive[runs]))
    extrema = np.append(runs[1:-1][ways[1:] != ways[:-1]], runs[-1])
    found, top, bottom, way = [0], 0, 0, 0
    for place in extrema.tolist():
        top = place if drive[place] > drive[top] else top
        bottom = place if drive[place] < drive[bottom] else bottom
        if way >= 0 and drive[top] - drive[place] >= turn:
            found.append(top)
            bottom, way = place, -1
        elif way <= 0 and drive[place] - drive[bottom] >= turn:
            found.append(bottom)
            top, way = place, 1
    return sorted(set(found))


def held(drive: Array, turns: list[int], amplitudes: Array, band: float) -> NDArray[np.bool_]:
    """Where the drive stays in a band for twice as long as a sine of the half cycle's size would at its turn."""
    from scipy.ndimage import maximum_filter1d, minimum_filter1d

    holds = np.zeros(drive.size, dtype=bool)
    for (first, last), amplitude in zip(pairwise([*turns, drive.size]), amplitudes, strict=True):
        turning = np.arccos(1 - 2 * (band / amplitude if band < amplitude else 1.0)) / np.pi
        least = max(3, int(np.ceil(2 * turning * (last - first))))
        if least > last - first:
            continue
        part = drive[first:last]
        calm = maximum_filter1d(part, least) - minimum_filter1d(part, least) <= band
        calm[: least // 2] = calm[last - first - (least - 1) // 2 :] = False
        starts = np.flatnonzero(calm) - least // 2
        edges = np.zeros(part.size + 1)
        np.add.at(edges, starts, 1)
        np.add.at(edges, starts + least, -1)
        holds[first:last] = np.cumsum(edges[:-1]) > 0
    return holds


def speed(drive: Array, steps: int) -> Array:
    """|dU| per sample, over so many samples ahead or back, whichever is more."""
    change = np.abs(drive[steps:] - drive[:-steps]) / steps
    pad = np.zeros(steps)
    return np.maximum(np.append(change, pad), np.append(pad, change))


def since(turns: list[int], holds: NDArray[np.bool_]) -> Array:
    """Samples since the last reversal or start of a hold."""
    starts = np.zeros(holds.size, dtype=np.intp)
    starts[turns] = turns
    begun = np.flatnonzero(np.diff(holds.astype(int), prepend=0) == 1)
    starts[begun] = begun
    return (np.arange(holds.size) - np.maximum.accumulate(starts)).astype(np.float64)
