"""Readings that stay at the end of a range while the drive goes on."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.faults.moves import scatter
from pzt_ident.data.faults.places import place_of
from pzt_ident.data.faults.standstill import is_noisy
from pzt_ident.data.record import Record
from pzt_ident.data.stretches import stretches
from pzt_ident.data.units import factor

Array = NDArray[np.float64]

SHORTEST = 6  # readings in a row at the end of a range
SEVERAL, LITTLE = 3, 0.01  # times that they are there, or of the range of the drive: once a stage may rest
OFTENER = 4  # times as many as are next to it
BEFORE = 24  # samples ahead of them that say how fast the response went
MOST = 0.9  # of the samples of a stretch beyond which its drive goes on: fewer may be wrong
BEYOND = 5.0  # times the step and the noise of the readings: what the drive asked for meanwhile


def clipping_phrase(record: Record) -> str:
    """Which readings stay at the end of their range, and what to do; empty where none do."""
    phrases = []
    for number in record.measured:
        for name, side in (("largest", 1), ("least", -1)):
            response = side * record.response[number]
            if clipped(response, record.drive[number]):
                places = np.flatnonzero(response == response.max())
                unit = str(record.response_units[number])
                value = f"{side * float(response.max()) / factor(unit) + 0.0:.4g} {unit}, the {name} of all"
                first = place_of(record, int(places[0]))
                phrases.append(f"{places.size} readings of {record.axes[number]} are exactly {value}, first at {first}")
    advice = "leave them out by `rows`, or measure again in a wider one"
    return f"{' and '.join(phrases)}: the end of the range of a sensor or converter; {advice}" if phrases else ""


def clipped(response: Array, drive: Array) -> bool:
    """Whether readings, (samples,), are the largest one far oftener than noise would have it, at several drives or
    times, or in a run over which the drive asks for clearly more."""
    at_end = response == response.max()
    count, next_to_it = int(at_end.sum()), int((response == response[~at_end].max(initial=-np.inf)).sum())
    often = count >= SHORTEST and count > OFTENER * next_to_it and is_noisy(response)
    runs = stretches(at_end)
    varied = len(runs) >= SEVERAL or bool(np.ptp(drive[at_end]) > LITTLE * np.ptp(drive))
    return (often and varied) or any(asks(response, drive, start, stop) for start, stop in runs)


def asks(response: Array, drive: Array, start: int, stop: int) -> bool:
    """Whether the drive goes on in a stretch by more than the readings would hide, as fast as they went before it; not
    in one that is short, or at the beginning."""
    if stop - start < SHORTEST or start < SHORTEST:
        return False
    before = slice(max(start - BEFORE, 0), start)
    values, driven = response[before], drive[before]
    rise, travel = float(response[start] - values[0]), float(drive[start] - driven[0])
    if travel == 0 or rise <= 0:
        return False
    onward = max(float(np.quantile((drive[start:stop] - drive[start]) * np.sign(travel), MOST)), 0.0)
    if onward < BEYOND * scatter(drive):
        return False
    moves = np.abs(np.diff(values))
    line = values[0] + rise * (driven - driven[0]) / travel
    return rise / abs(travel) * onward > BEYOND * max(float(np.abs(values - line).max()), smallest(moves))


def smallest(moves: Array) -> float:
    """The least move that is none of zero."""
    return float(moves[moves > 0].min(initial=np.inf))
