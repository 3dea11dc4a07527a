"""The uniform time grid of a record."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.decimals import last_bit, last_decimal
from pzt_ident.data.readers.signal import Signal
from pzt_ident.errors import InputError

JITTER = 0.01
"""Largest accepted deviation of a time stamp from the uniform grid, in sample times."""

COARSEST = 0.2
"""Coarsest digit that time stamps may be rounded to, in sample times: of coarser ones one may be missing."""


@dataclass(frozen=True)
class Grid:
    """Sample time and first time stamp, s; what the stamps are rounded to where that is seen."""

    dt: float
    start: float = 0.0
    rounded: float = 0.0


def grid_of_rate(rate: float, where: str) -> Grid:
    """The grid of a sample rate, Hz, from time 0 on."""
    if not 0 < rate < np.inf:
        raise InputError(f"the sample rate {rate:g} Hz is not positive", where=where, remedy="give it in Hz or kHz")
    return Grid(1 / rate)


def grid_of_sample_times(sample_times: Sequence[float], where: str) -> Grid | None:
    """The grid of the sample times, s, that a file states for its signals; None where it states none. Raises
    InputError where they differ."""
    if not sample_times:
        return None
    least, most = min(sample_times), max(sample_times)
    if most > (1 + JITTER) * least:
        problem = f"its signals have different sample times, {least:g} and {most:g} s"
        raise InputError(problem, where=where, remedy="bring them to one sample time first")
    return grid_of_rate(1 / sample_times[0], where)


def grid_of_stamps(stamps: Signal) -> Grid:
    """The uniform grid through the first and the last time stamp.

    Raises InputError where time stands still or runs backward, or where a stamp is off the grid by more than JITTER
    and by more than its last digit.
    """
    times, steps = stamps.values, np.diff(stamps.values)
    if steps.size == 0:
        raise InputError("the record has 1 sample", where=stamps.where, remedy="widen `rows`")
    if np.any(steps <= 0):
        row = int(np.argmax(steps <= 0)) + 1
        verb = "repeats" if steps[row - 1] == 0 else "runs backward"
        problem = f"time {verb} at {stamps.place(row)}: {times[row]:.9g} s after {times[row - 1]:.9g} s"
        before, after = (stamps.first, stamps.first + row), (stamps.first + row, stamps.first + times.size)
        rows = " and ".join(f"`rows: [{first}, {last}]`" for first, last in (before, after))
        remedy = (
            f"remove the row, give what is before it and after it records of their own with {rows}, or leave `time` "
        )
        remedy += "out and give `sample_rate`"
        raise InputError(problem, where=stamps.where, remedy=remedy)
    dt = float(times[-1] - times[0]) / steps.size
    off = float(np.abs(times - times[0] - dt * np.arange(times.size)).max())
    rounded = last_digit(times, COARSEST * dt) if off > JITTER * dt else 0.0
    if off > max(JITTER * dt, rounded):
        usual = float(np.median(steps))
        row = int(np.argmax(np.abs(steps - usual)))
        step = f"{steps[row]:.6g} s, {steps[row] / usual:.4g} times the usual {usual:.6g} s"
        remedy = "resample the record, or leave `time` out and give `sample_rate` if the stamps are only rounded"
        problem = f"time is not uniform: the step after {stamps.place(row)} is {step}"
        raise InputError(problem, where=stamps.where, remedy=remedy)
    return Grid(dt, float(times[0]), rounded)


def last_digit(times: NDArray[np.float64], most: float) -> float:
    """Their last decimal up to `most`, s, or what their last bit is worth, 0.2 us of seconds that are counted from
    1970; 0 where neither is so small."""
    bit = last_bit(times)
    return last_decimal(times, most) or (bit if bit <= most else 0.0)


def check_rate(grid: Grid, rate: float | None, where: str) -> None:
    """Raises InputError where a sample rate, Hz, differs from that of the grid by more than 1 %."""
    if rate and abs(grid.dt * rate - 1) > 0.01:
        problem = f"sample_rate {rate:g} Hz contradicts the time channel, which has {1 / grid.dt:g} Hz"
        raise InputError(problem, where=where, remedy="leave one of them out, or check the unit of time")


def time_slice(grid: Grid, samples: int, time: tuple[float | None, float | None] | None, where: str) -> slice:
    """The samples from `time[0]` on and before `time[1]`, s; all of them without `time`.

    Raises InputError where the record does not have them.
    """
    if time is None:
        return slice(0, samples)
    last = grid.start + grid.dt * (samples - 1)
    first, end = (grid.start if time[0] is None else time[0]), (last + grid.dt if time[1] is None else time[1])
    lower, upper = (int(np.ceil((t - grid.start) / grid.dt - 1e-6)) for t in (first, end))
    if lower < 0 or upper > samples or lower >= upper:
        problem = f"time [{first:g}, {end:g}] s is out of range"
        raise InputError(problem, where=where, remedy=f"the record runs from {grid.start:g} s to {last:g} s")
    return slice(lower, upper)
