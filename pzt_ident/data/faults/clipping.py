"""Readings that stay at the end of a range while the drive goes on."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.record import Record
from pzt_ident.data.units import factor

Array = NDArray[np.float64]

SHORTEST = 6  # readings in a row at the end of a range
BEFORE = 24  # samples ahead of them that say how fast the response went
BEYOND = 5.0  # times the step and the noise of the readings: what the drive asked for meanwhile


def clipping_phrase(record: Record) -> str:
    """Which readings stay at the end of their range, and what to do; empty where none do."""
    told = []
    for number in record.measured:
        for name, side in (("largest", 1), ("least", -1)):
            response = record.response[number]
            if count := clipped(side * response, record.drive[number]):
                unit = str(record.response_units[number])
                value = f"{side * float((side * response).max()) / factor(unit):.4g}"
                told.append(f"{count} readings of {record.axes[number]} are the {name} one, {value} {unit}")
    advice = "a converter or a sensor at the end of its range reads so; leave them out by `rows`, or measure again"
    return f"{' and '.join(told)}, and stay there while the drive goes on: {advice}" if told else ""


def clipped(response: Array, drive: Array) -> int:
    """How many readings, (samples,), are the largest one in runs over which the drive asks for clearly more."""
    return sum(stop - start for start, stop in runs(response == response.max()) if asks(response, drive, start, stop))


def runs(where: NDArray[np.bool_]) -> Iterator[tuple[int, int]]:
    """Start and stop of each stretch that is long enough and begins inside."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], where, [False]]).astype(np.int8)))
    for start, stop in edges.reshape(-1, 2).tolist():
        if stop - start >= SHORTEST and start >= SHORTEST:
            yield start, stop


def asks(response: Array, drive: Array, start: int, stop: int) -> bool:
    """Whether the drive goes on in a stretch by more than the readings would hide, as fast as they went before it."""
    before = slice(max(start - BEFORE, 0), start)
    values, driven = response[before], drive[before]
    rise, travel = float(response[start] - values[0]), float(drive[start] - driven[0])
    if travel == 0 or rise <= 0:
        return False
    onward = max(float(np.max((drive[start:stop] - drive[start]) * np.sign(travel))), 0.0)
    moves = np.abs(np.diff(values))
    line = values[0] + rise * (driven - driven[0]) / travel
    return rise / abs(travel) * onward > BEYOND * max(float(np.abs(values - line).max()), smallest(moves))


def smallest(moves: Array) -> float:
    """The least move that is none of zero."""
    return float(moves[moves > 0].min(initial=np.inf))
