"""Readings that jump while the drive does not: a sensor that drops out, and measurements joined to one record."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.faults.moves import CLEAR, kinked
from pzt_ident.data.notation import listed
from pzt_ident.data.record import Record
from pzt_ident.data.units import factor

Array = NDArray[np.float64]

FAR = 8.0  # times what the signal moves from one sample to the next around a jump
LEAST = 0.01  # of the range of the readings
AROUND = 8  # samples on each side
MANY = 12  # jumps: a signal that has more moves so
LONGEST = 64  # samples that a sensor drops out for: what is away for longer is another measurement
HELD = 4  # readings that are equal to the last digit
JOINED = (
    "as where measurements were joined, a sensor lost counts or a stage slipped: "
    "give what is before and after it a record of its own, by `rows`"
)
MOST = 3  # that are told by their times


def dropout_phrase(record: Record) -> str:
    """For how long readings of a record, or values of a drive, do not go with what is around them, and what to do;
    empty where all do."""
    gaps = {f"the readings of {record.axes[number]}": dropouts(record, number) for number in record.measured}
    gaps |= {f"the drive of {axis}": drive_dropouts(record, number) for number, axis in enumerate(record.axes)}
    told = [f"{whose} from {spans_of(record, found)}" for whose, found in gaps.items() if found]
    are = "are" if len(told) > 1 or any("readings" in whose for whose in told) else "is"
    advice = "mend the file, or leave it out by `rows` or `time`"
    return f"{listed(told)} {are} away from what is around: a channel most likely dropped out; {advice}" if told else ""


def spans_of(record: Record, gaps: Sequence[tuple[int, int]]) -> str:
    """The first few stretches of a record by their times."""
    spans = [f"{record.time[first]:.6g} to {record.time[last]:.6g} s" for first, last in gaps[:MOST]]
    return listed(spans) + (f" and {len(gaps) - MOST} more" if len(gaps) > MOST else "")


def join_phrase(record: Record) -> str:
    """Where a record may go on with another measurement, and what to do; empty where nothing looks so."""
    places = joins(record)
    if not places:
        return ""
    number = max(record.measured, key=lambda axis: abs(step_at(record, axis, places[0])))
    unit = str(record.response_units[number])
    size = f"{abs(step_at(record, number, places[0])) / factor(unit):.2g} {unit}"
    seconds = listed([f"{record.time[place]:.6g}" for place in places[:MOST]])
    more = f" and at {len(places) - MOST} more" if len(places) > MOST else ""
    jump = f"the readings of {record.axes[number]} jump by {size} in one sample at {seconds} s{more}"
    return f"{jump}, {JOINED}"


def step_at(record: Record, axis: int, place: int) -> float:
    """How far the response moves from the sample before a place to it."""
    return float(record.response[axis, place] - record.response[axis, place - 1])


def jumps(record: Record, axis: int) -> list[int]:
    """The samples to which the response of an axis jumps in one step, while no drive kinks there by as much of its
    range; none where it jumps all the time."""
    response = record.response[axis]
    steps = {place: abs(step_at(record, axis, place)) for place in lone_jumps(response)}
    kinks = kinks_at(record.drive, [*steps])
    return [place for place in steps if steps[place] > FAR * kinks[place] * np.ptp(response)]


def kinks_at(signals: Array, places: Sequence[int]) -> dict[int, float]:
    """How far signals, (signals, samples), kink around places, of their ranges."""
    spans = np.ptp(signals, axis=1, keepdims=True) if places else np.empty((0, 1))
    parts = {place: slice(max(place - AROUND - 2, 0), place + AROUND + 2) for place in places}
    return {place: float(kinked(signals[:, part], spans, AROUND).max()) for place, part in parts.items()}


def drive_dropouts(record: Record, axis: int) -> list[tuple[int, int]]:
    """First and last sample of each stretch to which a drive jumps and from which it jumps back, while no response
    kinks; none where there is no response."""
    if not record.measured:
        return []
    drive = record.drive[axis]
    kinks = kinks_at(record.response[[*record.measured]], lone_jumps(drive))
    return [(first, after - 1) for first, after in returns([place for place in kinks if not kinks[place]], drive)]


def joins(record: Record) -> list[int]:
    """The samples at which a record may go on with another measurement: a response jumps there and does not come back,
    while the drives go on as before, or jump in the same sample amid a motion."""
    alone, all_jumps = set(), set()
    for axis in record.measured:
        gaps = dropouts(record, axis)
        of_gaps = {place for first, last in gaps for place in (first, last + 1)}
        alone |= {*jumps(record, axis)} - of_gaps
        all_jumps |= {*lone_jumps(record.response[axis])} - of_gaps
    return sorted(alone | (all_jumps & driven_jumps(record)))


def driven_jumps(record: Record) -> set[int]:
    """The samples to which a drive jumps in one step amid a motion; none where all of its jumps are alike, as those of
    a sawtooth."""
    found = set()
    for drive in record.drive:
        places = [place for place in lone_jumps(drive) if is_amid_motion(drive, place)]
        sizes = [drive[place] - drive[place - 1] for place in places]
        if len(places) == 1 or (places and np.ptp(sizes) > LEAST * np.ptp(drive)):
            found |= {*places}
    return found


def is_amid_motion(drive: Array, place: int) -> bool:
    """Whether a drive moves in half of the samples on either side of a jump to a place, or on one side and is at no end
    of its range there."""
    sides = drive[max(place - AROUND, 0) : place], drive[place : place + AROUND]
    moves = [float(np.mean(np.diff(side) != 0)) > 0.5 for side in sides]
    value = drive[place - 1] if moves[0] else drive[place]
    inside = min(drive.max() - value, value - drive.min()) > LEAST * np.ptp(drive)
    return all(moves) or (any(moves) and bool(inside))


def lone_jumps(signal: Array) -> list[int]:
    """The samples to which a signal, (samples,), moves in one step far more than around it, but for other jumps; none
    where there are many."""
    moves = np.abs(np.diff(signal))
    steps = moves[moves > 0]
    if moves.size <= 2 * AROUND or not steps.size:
        return []
    least = max(CLEAR * float(np.median(moves)), 2 * float(steps.min()), LEAST * float(np.ptp(signal)))
    candidates = np.flatnonzero(moves > least)
    if candidates.size > 2 * MANY:
        return []
    inside = candidates[(candidates >= AROUND) & (candidates < moves.size - AROUND)]
    return [int(place) + 1 for place in inside if moves[place] > FAR * around(moves, place, candidates)]


def around(moves: Array, place: int, others: NDArray[np.intp]) -> float:
    """The largest move in the samples on each side of a place, but for other jumps that are not beside it."""
    near = np.arange(max(place - AROUND, 0), min(place + AROUND + 1, moves.size))
    apart = near[(near != place) & ~(np.isin(near, others) & (np.abs(near - place) > 1))]
    return float(moves[apart].max(initial=0.0))


def dropouts(record: Record, axis: int) -> list[tuple[int, int]]:
    """First and last sample of each stretch to which the response of an axis jumps and from which it jumps back, or in
    which it stands still until it jumps."""
    places, response = jumps(record, axis), record.response[axis]
    gaps = [*returns(places, response)]
    back = {place for pair in gaps for place in pair}
    held = [(held_since(response, place), place) for place in places if place not in back]
    gaps += [(first, place) for first, place in held if place - first >= HELD]
    return sorted((first, after - 1) for first, after in gaps)


def held_since(response: Array, place: int) -> int:
    """The first of the equal readings ahead of a place."""
    changes = np.flatnonzero(response[:place] != response[place - 1])
    return int(changes[-1]) + 1 if changes.size else 0


def returns(places: list[int], response: Array) -> Iterator[tuple[int, int]]:
    """The pairs of jumps of which the second soon takes most of the first back."""
    taken = 0
    for first, after in pairwise(places):
        there, back = (response[place] - response[place - 1] for place in (first, after))
        if first > taken and after - first <= LONGEST and abs(there + back) < 0.5 * max(abs(there), abs(back)):
            taken = after
            yield first, after
