"""What a drive does at each sample: its direction, half cycle and rate, and the time since it turned or stopped."""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class DriveHistory(NamedTuple):
    """A drive sample by sample, all of shape (samples,).

    direction: +1 rising, -1 falling, 0 holding. amplitude: peak to peak of the half cycle between two reversals. rate:
    |dU/dt|, 1/s. since: time since the last reversal, start of a hold, or start of the record, s. cycle: 1, 2, ...,
    two half cycles each.
    """

    direction: NDArray[np.int8]
    amplitude: Array
    rate: Array
    since: Array
    cycle: NDArray[np.int32]

    def scored(self, settle: int) -> DriveHistory:
        """Without the first `settle` samples."""
        direction, amplitude, rate, since, cycle = self
        return DriveHistory(direction[settle:], amplitude[settle:], rate[settle:], since[settle:], cycle[settle:])


def drive_history(drive: Array, dt: float) -> DriveHistory:
    """The history of a drive of shape (samples,). Changes below half a percent of its span, or below its noise, are no
    motion."""
    samples, span = drive.size, float(np.ptp(drive))
    noise = max(1e-6 * span, drive_noise(drive))
    least_swing = max(0.005 * span, 8 * noise)
    if span <= least_swing:
        zero, first = np.zeros(samples), np.ones(samples, dtype=np.int32)
        return DriveHistory(zero.astype(np.int8), zero, zero, dt * np.arange(samples, dtype=np.float64), first)
    turns = reversals(drive, least_swing)
    ends = [*turns, samples - 1]
    lengths = np.diff([*turns, samples])
    amplitudes = np.array([np.ptp(drive[first : last + 1]) for first, last in pairwise(ends)])
    directions = np.sign([drive[last] - drive[first] for first, last in pairwise(ends)]).astype(np.int8)
    holding = is_holding(drive, turns, amplitudes, 8 * noise)
    smoothing = 1 + int(20 * noise * samples / amplitudes.sum())
    return DriveHistory(
        np.where(holding, np.int8(0), np.repeat(directions, lengths)),
        np.repeat(amplitudes, lengths),
        np.where(holding, 0.0, speed(drive, min(smoothing, samples - 1)) / dt),
        dt * samples_since(turns, holding),
        np.repeat(np.arange(lengths.size, dtype=np.int32) // 2 + 1, lengths),
    )


def drive_noise(drive: Array) -> float:
    """Standard deviation of white noise, the variance of whose third differences is 20 times its own; 0 of a few."""
    third = np.diff(drive, 3)
    return float(np.median(np.abs(third)) / 0.6745 / np.sqrt(20)) if third.size > 10 else 0.0


def reversals(drive: Array, least_swing: float) -> list[int]:
    """Indices of the first sample and of the extrema from which the drive goes back by `least_swing` or more."""
    runs = np.flatnonzero(np.diff(drive, prepend=np.inf))
    directions = np.sign(np.diff(drive[runs]))
    extrema = np.append(runs[1:-1][directions[1:] != directions[:-1]], runs[-1])
    turns, top, bottom, direction = [0], 0, 0, 0
    for i in extrema.tolist():
        top = i if drive[i] > drive[top] else top
        bottom = i if drive[i] < drive[bottom] else bottom
        if direction >= 0 and drive[top] - drive[i] >= least_swing:
            turns.append(top)
            bottom, direction = i, -1
        elif direction <= 0 and drive[i] - drive[bottom] >= least_swing:
            turns.append(bottom)
            top, direction = i, 1
    return sorted(set(turns))


def is_holding(drive: Array, turns: list[int], amplitudes: Array, band: float) -> NDArray[np.bool_]:
    """Where the drive stays in a band for twice as long as a sine of the half cycle's amplitude would at its turn."""
    holding = np.zeros(drive.size, dtype=bool)
    for (first, last), amplitude in zip(pairwise([*turns, drive.size]), amplitudes, strict=True):
        turn_share = np.arccos(1 - 2 * (band / amplitude if band < amplitude else 1.0)) / np.pi
        least = max(3, int(np.ceil(2 * turn_share * (last - first))))
        if least > last - first:
            continue
        part = drive[first:last]
        starts = np.flatnonzero(extremes(np.maximum, part, least) - extremes(np.minimum, part, least) <= band)
        edges = np.zeros(part.size + 1)
        np.add.at(edges, starts, 1)
        np.add.at(edges, starts + least, -1)
        holding[first:last] = np.cumsum(edges[:-1]) > 0
    return holding


def extremes(extreme: np.ufunc, values: Array, length: int) -> Array:
    """Of every `length` values in a row, from their ends towards the borders of stretches of that length (van Herk
    1992, Pattern Recognit. Lett. 13, 517)."""
    stretches = np.pad(values, (0, -values.size % length), mode="edge").reshape(-1, length)
    ahead = extreme.accumulate(stretches, axis=1).ravel()
    back = extreme.accumulate(stretches[:, ::-1], axis=1)[:, ::-1].ravel()
    return np.asarray(extreme(back[: values.size - length + 1], ahead[length - 1 : values.size]))


def speed(drive: Array, steps: int) -> Array:
    """|dU| per sample, over so many samples ahead or back, whichever is more."""
    change = np.abs(drive[steps:] - drive[:-steps]) / steps
    pad = np.zeros(steps)
    return np.maximum(np.append(change, pad), np.append(pad, change))


def samples_since(turns: list[int], holding: NDArray[np.bool_]) -> Array:
    """Samples since the last reversal or start of a hold."""
    starts = np.zeros(holding.size, dtype=np.intp)
    starts[turns] = turns
    hold_starts = np.flatnonzero(np.diff(holding.astype(int), prepend=0) == 1)
    starts[hold_starts] = hold_starts
    return (np.arange(holding.size) - np.maximum.accumulate(starts)).astype(np.float64)
