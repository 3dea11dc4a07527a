"""Single readings that stand far beside those around them, as no stage moves."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.notation import listed
from pzt_ident.data.record import Record

Array = NDArray[np.float64]

FAR = 8.0  # times what the readings around it stand off the lines through theirs
CLEAR = 12.0  # times what half of all readings do
AT_AN_END = 0.05  # of the range: the first or last reading is off as much, since it may be beside a corner
BESIDE = (
    0.25,
    0.75,
)  # times as far a spike takes the next readings to the other side of their lines: a corner takes none
AROUND = 3  # readings on each side
MOST = 4  # that are told by their times


def spike_phrase(record: Record) -> str:
    """Which readings of a record stand far beside those around them, and what to do; empty where none does."""
    found = {record.axes[axis]: spikes(record, axis) for axis in record.measured}
    told = [of_axis(record, axis, places) for axis, places in found.items() if places.size]
    if not told:
        return ""
    one = sum(places.size for places in found.values()) == 1
    stand, out = ("stands", "it") if one else ("stand", "them")
    advice = f"mend the file, or leave {out} out at an end by `rows` or `settle`"
    return f"{listed(told)} {stand} far beside those around {out}, as no stage moves: {advice}"


def of_axis(record: Record, axis: str, places: NDArray[np.intp]) -> str:
    """The readings of an axis, by the times of the first few."""
    times = listed([f"{second:.6g}" for second in record.time[places[:MOST]].tolist()])
    more = f" and {places.size - MOST} more" if places.size > MOST else ""
    return f"the reading{'s' * (places.size > 1)} of {axis} at {times} s{more}"


def spikes(record: Record, axis: int) -> NDArray[np.intp]:
    """The samples at which the response of an axis stands far beside the line through its neighbours, or the first and
    the last beside that through the next two, while the drives neither kink nor turn: what sticks jumps as they do."""
    response = record.response[axis]
    if response.size <= 2 * AROUND + 3:
        return np.zeros(0, np.intp)
    off, edge = off_line(response), AROUND + 1
    around = np.lib.stride_tricks.sliding_window_view(np.pad(np.abs(off)[1:-1], edge + 1), 2 * edge + 1)
    usual = np.delete(around, (edge - 1, edge, edge + 1), axis=1).max(axis=1)
    driven = np.max([kinked(drive) * np.ptp(response) for drive in record.drive], axis=0)
    steps = np.abs(np.diff(response))
    least = max(CLEAR * float(np.median(np.abs(off))), 2 * float(steps[steps > 0].min(initial=np.inf)))
    far = np.abs(off) > np.maximum(FAR * np.maximum(usual, driven), least)
    turning = np.any([turns(drive) for drive in record.drive], axis=0)
    return np.flatnonzero(far & is_single(response, off) & ~turning)


def turns(drive: Array) -> NDArray[np.bool_]:
    """Of each sample, (samples,), whether a drive turns there or beside it."""
    moves = np.diff(drive)
    there = np.pad(moves[:-1] * moves[1:] < 0, 2)
    return np.asarray(there[:-2] | there[1:-1] | there[2:])


def kinked(drive: Array) -> Array:
    """How far a drive, (samples,), is off the lines through its neighbours at most around each sample, of its range."""
    width = 2 * AROUND + 1
    around = np.lib.stride_tricks.sliding_window_view(np.pad(np.abs(off_line(drive)), AROUND), width)
    return np.asarray(around.max(axis=1) / (np.ptp(drive) or 1.0))


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
