"""Readings that are equal to the last digit amid noise: held values, and the ends of a range."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.faults.moves import off_line, scatter
from pzt_ident.data.record import Record
from pzt_ident.data.stretches import stretches

Array = NDArray[np.float64]

NOISY = 0.3  # of all samples: so often noise takes a reading to the other side of the line through its neighbours
OFTEN = 0.2  # of all samples: where neighbours are equal so often the counts of the sensor are as coarse as its noise
ROUNDING = 1e-6  # of the largest move: less is none
COUNTS = 2.0  # of the sensor, at least, half of the readings are off the lines through their neighbours
CHANCE = 1e-5  # of a run of equal readings in a record
SHORTEST = 5  # readings in a run
CLEAR = 6.0  # times half of the moves of a drive off its lines: a drive that travels farther moves
BESIDE = 2  # samples from a turn of the drive, where what sticks stands still
MANY = 12  # runs: a stage that has more stands still so


def still_stretches(record: Record, axis: int) -> list[tuple[int, int]]:
    """First and last sample of each run of equal readings amid noise, at no end of their range, over which the drive
    moves and which does not begin where it turns."""
    response, drive = record.response[axis], record.drive[axis]
    held = [
        (start, stop - 1)
        for start, stop in unlikely_runs(response)
        if response.min() < response[start] < response.max()
        and np.ptp(drive[start:stop]) > CLEAR * scatter(drive)
        and not turns_near(drive, start)
    ]
    return held if len(held) <= MANY else []


def unlikely_runs(signal: Array) -> list[tuple[int, int]]:
    """Start and stop of each run of equal values that noise does not make; none without noise."""
    moves = np.diff(signal)
    still = stretches(moves == 0)
    often = sum(stop - start for start, stop in still if stop - start < SHORTEST - 1) / signal.size
    if not is_noisy(signal) or often > OFTEN:
        return []
    least = max(SHORTEST - 1, math.log(CHANCE / signal.size) / math.log(max(often, 1 / signal.size)))
    return [(start, stop + 1) for start, stop in still if stop - start >= least]


def is_noisy(signal: Array) -> bool:
    """Whether a signal goes from one side of the line through its neighbours to the other as often as noise does, and
    farther than the counts of its sensor."""
    off, moves = off_line(signal), np.abs(np.diff(signal))
    least = float(moves[moves > ROUNDING * moves.max()].min(initial=np.inf))
    return bool(np.mean(off[1:] * off[:-1] < 0) > NOISY) and scatter(signal) > COUNTS * least


def turns_near(drive: Array, place: int) -> bool:
    """Whether a drive turns within a few samples."""
    moves = np.diff(drive[max(place - BESIDE - 1, 0) : place + BESIDE + 2])
    return bool((moves > 0).any() and (moves < 0).any())
