"""Single readings that stand far beside those around them, as no stage moves."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.notation import listed
from pzt_ident.data.record import Record

Array = NDArray[np.float64]

FAR = 8.0  # times what the readings around it stand off the lines through theirs
CLEAR = 12.0  # times what half of all readings do
MOVED = 3.0  # times what the signal moves from one of the readings around it to the next
AT_AN_END = 0.05  # of the range: the first or last reading is off as much, since it may be beside a corner
BESIDE = (
    0.25,
    0.75,
)  # times as far a spike takes the next readings to the other side of their lines: a corner takes none
AROUND = 3  # readings on each side
MOST = 4  # that are told by their times


def spike_phrase(record: Record) -> str:
    """Which readings of a record stand far beside those around them, and what to do; empty where none does."""
    found = {f"the reading of {record.axes[axis]}": spikes(record, axis) for axis in record.measured}
    found |= {f"the drive of {name}": drive_spikes(record, axis) for axis, name in enumerate(record.axes)}
    told = [f"{whose} at {times_of(record, places)}" for whose, places in found.items() if places.size]
    if not told:
        return ""
    one = sum(places.size for places in found.values()) == 1
    stand, out = ("stands", "it") if one else ("stand", "them")
    advice = f"mend the file, or leave {out} out at an end by `rows` or `settle`"
    return f"{listed(told)} {stand} far beside those around {out}, as no stage moves: {advice}"


def times_of(record: Record, places: NDArray[np.intp]) -> str:
    """The first few times, s."""
    times = listed([f"{second:.6g}" for second in record.time[places[:MOST]].tolist()])
    return f"{times} s" + (f" and {places.size - MOST} more" if places.size > MOST else "")


def spikes(record: Record, axis: int) -> NDArray[np.intp]:
    """The samples at which the response of an axis stands far beside the line through its neighbours, or the first and
    the last beside that through the next two, while the drives neither kink nor turn: what sticks jumps as they do."""
    if record.samples <= 2 * AROUND + 3:
        return np.zeros(0, np.intp)
    turning = np.any([turns(drive) for drive in record.drive], axis=0)
    return np.flatnonzero(stands_out(record.response[axis], record.drive) & ~turning)


def drive_spikes(record: Record, axis: int) -> NDArray[np.intp]:
    """The samples at which a drive stands far beside the line through its neighbours, while no response kinks; none
    where there is no response."""
    if record.samples <= 2 * AROUND + 3 or not record.measured:
        return np.zeros(0, np.intp)
    return np.flatnonzero(stands_out(record.drive[axis], record.response[[*record.measured]]))


def stands_out(signal: Array, others: Array) -> NDArray[np.bool_]:
    """Of each sample, (samples,), whether a signal stands far beside those around it, farther than it moves there from
    one to the next, and than the others, (signals, samples), kink in their ranges."""
    off, moves = off_line(signal), np.abs(np.diff(signal, prepend=signal[:1]))
    size, steps = np.abs(off), moves[moves > 0]
    far = FAR * np.maximum(nearby(np.pad(size[1:-1], 1)), kinked(others) * np.ptp(signal))
    least = max(CLEAR * float(np.median(size)), 2 * float(steps.min(initial=np.inf)))
    return np.asarray((size > np.maximum(far, least)) & (size > MOVED * nearby(moves)) & is_single(signal, off))


def nearby(values: Array) -> Array:
    """The largest of the values around each sample, (samples,), but for those beside it."""
    edge = AROUND + 1
    around = np.lib.stride_tricks.sliding_window_view(np.pad(values, edge), 2 * edge + 1)
    return np.asarray(np.delete(around, (edge - 1, edge, edge + 1), axis=1).max(axis=1))


def kinked(signals: Array) -> Array:
    """How far signals, (signals, samples), are off the lines through their neighbours at most around each sample, of
    their ranges, and beyond their noise."""
    sizes = np.abs([off_line(signal) for signal in signals])
    ranges = np.ptp(signals, axis=1, keepdims=True)
    sizes = np.maximum(sizes - CLEAR * np.median(sizes, axis=1, keepdims=True), 0) / np.where(ranges > 0, ranges, 1)
    around = np.lib.stride_tricks.sliding_window_view(np.pad(sizes.max(axis=0), AROUND), 2 * AROUND + 1)
    return np.asarray(around.max(axis=1))


def turns(drive: Array) -> NDArray[np.bool_]:
    """Of each sample, (samples,), whether a drive turns there or beside it."""
    moves = np.diff(drive)
    there = np.pad(moves[:-1] * moves[1:] < 0, 2)
    return np.asarray(there[:-2] | there[1:-1] | there[2:])


def is_single(signal: Array, off: Array) -> NDArray[np.bool_]:
    """Of each sample, whether it takes both neighbours, but for the first and last, to the other side, or is far off at
    an end."""
    ends = np.abs(off) > AT_AN_END * np.ptp(signal)
    shares = np.array([-off[:-2], -off[2:]]) / np.where(off[1:-1], off[1:-1], np.inf)
    shares[0, 0], shares[1, -1] = shares[1, 0], shares[0, -1]
    inner = ((shares > BESIDE[0]) & (shares < BESIDE[1])).all(axis=0)
    return np.concatenate([ends[:1], inner, ends[-1:]])


def off_line(signal: Array) -> Array:
    """How far each sample is off the line through its neighbours, and those at the ends off that through the next
    two."""
    inner = signal[1:-1] - (signal[:-2] + signal[2:]) / 2
    return np.concatenate([[signal[0] - 2 * signal[1] + signal[2]], inner, [signal[-1] - 2 * signal[-2] + signal[-3]]])
