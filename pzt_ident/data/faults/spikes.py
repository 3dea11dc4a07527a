"""Single readings, and values of a drive, that stand far beside those around them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.faults.moves import CLEAR, kinked, off_line
from pzt_ident.data.faults.places import places_of
from pzt_ident.data.notation import listed
from pzt_ident.data.record import Record

Array = NDArray[np.float64]

FAR = 8.0  # times what the readings around it stand off the lines through theirs
MOVED = 3.0  # times what the signal moves from one of the readings around it to the next
AT_AN_END = 0.05  # of the range: the first or last reading is off as much, since it may be beside a corner
BESIDE = 0.25, 0.75  # times as far it takes the next readings to the other side of their lines, as no corner does
AROUND = 3  # readings on each side
STRETCH, OVERLAP = 2**16, 2**6  # samples that are looked at together, so that a long record takes no more room


def spike_phrase(record: Record) -> str:
    """Which readings of a record stand far beside those around them, and what to do; empty where none does."""
    standing = {("reading", axis): spikes(record, number) for number, axis in enumerate(record.axes)}
    standing |= {("value", f"the drive of {axis}"): drive_spikes(record, i) for i, axis in enumerate(record.axes)}
    phrases = [told_of(record, *whose, places) for whose, places in standing.items() if places.size]
    if not phrases:
        return ""
    one = sum(places.size for places in standing.values()) == 1
    stand, are, them = ("stands", "is", "it") if one else ("stand", "are", "them")
    advice = (
        f"mend the file, or leave {them} out by `rows` or `settle` where {'it is' if one else 'they are'} at an end"
    )
    return f"{listed(phrases)} {stand} far beside those around {them} and {are} most likely wrong: {advice}"


def told_of(record: Record, kind: str, whose: str, places: NDArray[np.intp]) -> str:
    """The spikes of a signal, by the places of the first few."""
    return f"the {kind}{'s' * (places.size > 1)} of {whose} {places_of(record, places.tolist())}"


def spikes(record: Record, axis: int) -> NDArray[np.intp]:
    """The samples at which the response of an axis stands far beside the line through its neighbours, or the first and
    the last beside that through the next two, while the drives neither kink nor turn: what sticks jumps as they do.
    None of an axis that is not measured."""
    if axis not in record.measured:
        return np.zeros(0, np.intp)
    places = spikes_beside(record.response[axis], record.drive)
    return places[[not any(turns_at(drive, place) for drive in record.drive) for place in places]]


def drive_spikes(record: Record, axis: int) -> NDArray[np.intp]:
    """The samples at which a drive stands far beside the line through its neighbours, while no response kinks; none
    where there is no response."""
    return spikes_beside(record.drive[axis], record.response[[*record.measured]])


def spikes_beside(signal: Array, others: Array) -> NDArray[np.intp]:
    """The samples at which a signal, (samples,), stands far beside those around it, farther than it moves there from
    one to the next, and than the others, (signals, samples), kink in their ranges."""
    if signal.size <= 2 * AROUND + 3 or not len(others):
        return np.zeros(0, np.intp)
    span, spans, spiked = float(np.ptp(signal)), np.ptp(others, axis=1, keepdims=True), list[NDArray[np.intp]]()
    for begin in range(0, signal.size, STRETCH):
        part = slice(max(begin - OVERLAP, 0), begin + STRETCH + OVERLAP)
        places = part.start + np.flatnonzero(stands_out(signal[part], span, others[:, part], spans))
        spiked.append(places[(places >= begin) & (places < begin + STRETCH)])
    return np.concatenate(spiked)


def stands_out(signal: Array, span: float, others: Array, spans: Array) -> NDArray[np.bool_]:
    """Of each sample, (samples,), whether a signal of that range does."""
    off, moves = off_line(signal), np.abs(np.diff(signal, prepend=signal[:1]))
    size, steps = np.abs(off), moves[moves > 0]
    least = max(CLEAR * float(np.median(size)), 2 * float(steps.min(initial=np.inf)))
    if size.max() <= least:
        return np.zeros(signal.size, np.bool_)
    kinks = span * kinked(others, spans, AROUND)
    far = np.maximum(FAR * np.maximum(nearby(np.pad(size[1:-1], 1)), kinks), least)
    return np.asarray((size > far) & (size > MOVED * nearby(moves)) & is_single(off, span))


def nearby(values: Array) -> Array:
    """The largest of the values around each sample, (samples,), but for those beside it."""
    edge = AROUND + 1
    around = np.lib.stride_tricks.sliding_window_view(np.pad(values, edge), 2 * edge + 1)
    return np.asarray(np.delete(around, (edge - 1, edge, edge + 1), axis=1).max(axis=1))


def turns_at(drive: Array, place: int) -> bool:
    """Whether a drive turns at a sample or beside it."""
    moves = np.diff(drive[max(place - 2, 0) : place + 3])
    return bool((moves[:-1] * moves[1:] < 0).any())


def is_single(off: Array, span: float) -> NDArray[np.bool_]:
    """Of each sample, whether it takes both neighbours, but for the first and last, to the other side, or is far off at
    an end."""
    ends = np.abs(off) > AT_AN_END * span
    shares = np.array([-off[:-2], -off[2:]]) / np.where(off[1:-1], off[1:-1], np.inf)
    shares[0, 0], shares[1, -1] = shares[1, 0], shares[0, -1]
    inner = ((shares > BESIDE[0]) & (shares < BESIDE[1])).all(axis=0)
    return np.concatenate([ends[:1], inner, ends[-1:]])
