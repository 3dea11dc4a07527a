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
    the last beside that through the next two, and none of the drives does."""
    strange = stands_out(record.response[axis])
    return np.flatnonzero(strange & ~np.any([stands_out(drive) for drive in record.drive], axis=0))


def stands_out(signal: Array) -> NDArray[np.bool_]:
    """Of each sample, (samples,), whether it stands far beside those around it."""
    if signal.size <= 2 * AROUND + 3:
        return np.zeros(signal.size, bool)
    off, edge = off_line(signal), AROUND + 1
    size = np.abs(off)
    around = np.lib.stride_tricks.sliding_window_view(np.pad(size[1:-1], edge + 1), 2 * edge + 1)
    usual = np.delete(around, (edge - 1, edge, edge + 1), axis=1).max(axis=1)
    steps = np.abs(np.diff(signal))
    least = max(CLEAR * float(np.median(size)), 2 * float(steps[steps > 0].min(initial=np.inf)))
    return np.asarray((size > FAR * usual) & (size > least) & is_single(signal, off))


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
