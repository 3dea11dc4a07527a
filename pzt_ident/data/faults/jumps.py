"""Readings that jump while the drive does not: a sensor that drops out or holds its last value, and measurements joined
to one record."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.faults.moves import CLEAR, off_line, scatter
from pzt_ident.data.faults.places import places_of, span_of
from pzt_ident.data.faults.standstill import SHORTEST, still_stretches
from pzt_ident.data.notation import listed
from pzt_ident.data.record import Record
from pzt_ident.data.units import factor

Array = NDArray[np.float64]

FAR = 8.0  # times what the signal moves from one sample to the next around a jump
LEAST = 0.01  # of the range of the readings
AROUND = 8  # samples on each side
MANY = 12  # jumps that no drive asks for: a stage that has more moves so
MOST_MOVES = 2000  # moves that may be jumps: a signal that has more moves so
LONGEST, LONG = 64, 0.05  # samples, or of all, that a channel drops out for: what is away for longer is no dropout
JOINED = (
    "as where measurements were joined, a sensor lost counts or a stage slipped: "
    "give what is before and after it a record of its own, by `rows`"
)
FEW = 3  # samples that are away: no record is worth dividing there
MOVING = 6.0  # times the scatter of a drive: one that goes farther in AROUND samples moves


def dropout_phrase(record: Record) -> str:
    """For how long readings of a record, or values of a drive, do not go with what is around them, and what to do;
    empty where all do."""
    gaps = {f"the readings of {record.axes[number]}": dropouts(record, number) for number in record.measured}
    gaps |= {f"the drive of {axis}": drive_dropouts(record, number) for number, axis in enumerate(record.axes)}
    phrases = [f"{whose} {span_of(record, stretches)}" for whose, stretches in gaps.items() if stretches]
    jump = "jumps" if len(phrases) == 1 and phrases[0].startswith("the drive") else "jump"
    advice = "a channel most likely dropped out; give what is before and after a record of its own, by `rows`"
    if all(last - first < FEW for stretches in gaps.values() for first, last in stretches):
        advice = "what is there is most likely wrong; mend the file"
    return f"{listed(phrases)} {jump} away and back: {advice}" if phrases else ""


def hold_phrase(record: Record) -> str:
    """Where the readings of a record, or its drive, stand still while the other moves, and what to do; empty where none
    does."""
    held = {record.axes[number]: holds(record, number) for number in record.measured}
    phrases = [
        f"the readings of {axis} {span_of(record, stretches)} are equal to the last digit while the drive moves"
        for axis, stretches in held.items()
        if stretches
    ]
    still = {axis: drive_holds(record, number) for number, axis in enumerate(record.axes)}
    phrases += [
        f"the drive of {axis} {span_of(record, stretches)} stands still until it jumps, and the readings do not"
        for axis, stretches in still.items()
        if stretches
    ]
    advice = "a sensor or a recorder held its last value; give what is before and after a record of its own, by `rows`"
    return f"{listed(phrases)}: {advice}" if phrases else ""


def join_phrase(record: Record) -> str:
    """Where a record may go on with another measurement, and what to do; empty where nothing looks so."""
    places = joins(record)
    if not places:
        return ""
    sizes = {axis: max(abs(step_at(record, axis, place)) for place in places) for axis in record.measured}
    number = max(sizes, key=lambda axis: sizes[axis] / (np.ptp(record.response[axis]) or 1.0))
    unit = str(record.response_units[number])
    size = f"{'up to ' * (len(places) > 1)}{sizes[number] / factor(unit):.2g} {unit}"
    return f"the readings of {record.axes[number]} jump by {size} in one sample {places_of(record, places)}, {JOINED}"


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
    """How far signals, (signals, samples), kink around places beyond their noise, of their ranges."""
    if not places:
        return {}
    noise, spans = [CLEAR * scatter(signal) for signal in signals], np.ptp(signals, axis=1)
    parts = {place: slice(max(place - AROUND - 2, 0), place + AROUND + 2) for place in places}
    sizes = {
        place: [np.abs(off_line(signal)[1:-1]).max() for signal in signals[:, part]] for place, part in parts.items()
    }
    beyond = {place: np.maximum(np.subtract(size, noise), 0) for place, size in sizes.items()}
    return {place: float(np.max(size / np.where(spans > 0, spans, 1))) for place, size in beyond.items()}


def drive_jumps(record: Record, axis: int) -> list[int]:
    """The samples to which a drive jumps in one step, while no response kinks; none where there is no response."""
    places = lone_jumps(record.drive[axis]) if record.measured else []
    kinks = kinks_at(record.response[[*record.measured]], places)
    return [place for place in places if not kinks[place]]


def drive_dropouts(record: Record, axis: int) -> list[tuple[int, int]]:
    """First and last sample of each stretch to which a moving drive jumps and from which it jumps back, unseen by the
    responses."""
    drive = record.drive[axis]
    gaps = returns(drive_jumps(record, axis), drive)
    return [(first, after - 1) for first, after in gaps if all(moves_beside(drive, first - 1, after))]


def drive_holds(record: Record, axis: int) -> list[tuple[int, int]]:
    """First and last sample of each stretch in which a moving drive stands still until it jumps, unseen by the
    responses."""
    drive = record.drive[axis]
    since = {place: equal_since(drive, place) for place in drive_jumps(record, axis)}
    held = [(first, place) for place, first in since.items() if place - first >= SHORTEST]
    return [(first, place - 1) for first, place in held if all(moves_beside(drive, first, place))]


def joins(record: Record) -> list[int]:
    """The samples at which a record may go on with another measurement: a response jumps there and does not come back,
    while the drives go on as before, or jump in the same sample amid a motion."""
    alone, all_jumps = set(), set()
    for axis in record.measured:
        unasked = jumps(record, axis)
        gaps = [*dropouts(record, axis), *holds(record, axis)]
        of_gaps = {place for first, last in gaps for place in (first, last + 1)}
        alone |= {*unasked} - of_gaps
        all_jumps |= {*lone_jumps(record.response[axis])} - of_gaps
    places = sorted(alone | (all_jumps & driven_jumps(record)))
    return places if len(places) <= MANY else []


def driven_jumps(record: Record) -> set[int]:
    """The samples to which a drive jumps in one step amid a motion; none where all of its jumps are alike, as those of
    a sawtooth."""
    jumped = set()
    for drive in record.drive:
        places = [place for place in lone_jumps(drive) if is_amid_motion(drive, place)]
        sizes = [drive[place] - drive[place - 1] for place in places]
        if len(places) == 1 or (places and np.ptp(sizes) > LEAST * np.ptp(drive)):
            jumped |= {*places}
    return jumped


def is_amid_motion(drive: Array, place: int) -> bool:
    """Whether a drive moves on either side of a jump to a place, or on one side and is at no end of its range there."""
    before, after = moves_beside(drive, place - 1, place)
    value = drive[place - 1] if before else drive[place]
    inside = min(drive.max() - value, value - drive.min()) > LEAST * np.ptp(drive)
    return (before and after) or ((before or after) and bool(inside))


def moves_beside(drive: Array, last: int, first: int) -> tuple[bool, bool]:
    """Whether a drive moves up to a sample, and from another one on, farther than its noise goes."""
    least = MOVING * scatter(drive)
    sides = drive[max(last - AROUND + 1, 0) : last + 1], drive[first : first + AROUND]
    before, after = (bool(abs(side[-1] - side[0]) > least) for side in sides)
    return before, after


def lone_jumps(signal: Array) -> list[int]:
    """The samples to which a signal, (samples,), moves in one step far more than around it, but for other jumps; none
    where there are many."""
    moves = np.abs(np.diff(signal))
    steps = moves[moves > 0]
    if moves.size <= 2 * AROUND or not steps.size:
        return []
    least = max(CLEAR * float(np.median(moves)), 2 * float(steps.min()), LEAST * float(np.ptp(signal)))
    candidates = np.flatnonzero(moves > least)
    if candidates.size > MOST_MOVES:
        return []
    inside = candidates[(candidates >= AROUND) & (candidates < moves.size - AROUND)]
    return [int(place) + 1 for place in inside if moves[place] > FAR * around(moves, place, candidates)]


def around(moves: Array, place: int, others: NDArray[np.intp]) -> float:
    """The largest move in the samples on each side of a place, but for another jump that is not beside it; infinite
    among several, as where a stage rings."""
    near = np.arange(max(place - AROUND, 0), min(place + AROUND + 1, moves.size))
    apart = np.isin(near, others) & (np.abs(near - place) > 1)
    if np.count_nonzero(apart) > 1:
        return float(np.inf)
    return float(moves[near[~apart & (near != place)]].max(initial=0.0))


def dropouts(record: Record, axis: int) -> list[tuple[int, int]]:
    """First and last sample of each stretch to which the response of an axis jumps and from which it jumps back."""
    gaps = [(first, after - 1) for first, after in returns(jumps(record, axis), record.response[axis])]
    return gaps if len(gaps) <= MANY else []


def holds(record: Record, axis: int) -> list[tuple[int, int]]:
    """First and last sample of each stretch of equal readings amid noise, or up to a jump that no drive asks for, to
    which the response did not jump."""
    response, places = record.response[axis], jumps(record, axis)
    still = [(first, last) for first, last in still_stretches(record, axis) if first not in places]
    known = {last + 1 for _, last in still} | {after for pair in returns(places, response) for after in pair}
    since = {place: equal_since(response, place) for place in places if place not in known}
    return sorted([*still, *((first, place - 1) for place, first in since.items() if place - first >= SHORTEST)])


def equal_since(response: Array, place: int) -> int:
    """The first of the equal readings ahead of a place."""
    changes = np.flatnonzero(response[:place] != response[place - 1])
    return int(changes[-1]) + 1 if changes.size else 0


def returns(places: Sequence[int], signal: Array) -> Iterator[tuple[int, int]]:
    """The pairs of jumps of which the second soon takes most of the first back."""
    taken, longest = 0, max(LONGEST, LONG * signal.size)
    for first, after in pairwise(places):
        there, back = (signal[place] - signal[place - 1] for place in (first, after))
        if first > taken and after - first <= longest and abs(there + back) < 0.5 * max(abs(there), abs(back)):
            taken = after
            yield first, after
