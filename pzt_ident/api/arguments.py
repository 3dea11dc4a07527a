"""What users of the library pass as time, signals, units and paths, each as the rest takes it."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.units import FREQUENCY, TIME, Dimension, dimension, factor
from pzt_ident.errors import InputError

Array = NDArray[np.float64]
Signals = Any  # an array, or one by axis
Units = str | Mapping[str, str]
AXES = "xyzabc"
QUANTITY = re.compile(r"^([-+]?[\d.]+(?:[eE][-+]?\d+)?)\s*(\D.*)$")


def rate_or_stamps(t: Any, where: str) -> tuple[float | None, Array | None]:
    """Sample rate, Hz, or time stamps, s: one of the two. Dates and time differences become stamps."""
    remedy = "give time stamps in s, a rate in Hz, or text such as '5 kHz'"
    if t is None or isinstance(t, str | bool):
        rate = _quantity(t, FREQUENCY)
        if rate is None:
            raise InputError(f"{t!r} is no sample rate", where=where, remedy=remedy)
        return _positive(rate, where, remedy), None
    values = _flat(t if isinstance(t, np.ma.MaskedArray) else np.asarray(t))
    if values.dtype.kind == "O" and values.size and all(hasattr(each, "timestamp") for each in values.flat):
        values = np.array([each.timestamp() for each in values.flat])
        values -= values[0]
    if values.dtype.kind == "M":
        values = values - values[0]
    if values.dtype.kind == "m":
        values = values / np.timedelta64(1, "s")
    values = numbers(values, where)
    if values.ndim > 1:
        raise InputError(f"an array of shape {values.shape}", where=where, remedy=remedy)
    return (None, values) if values.ndim else (_positive(float(values), where, remedy), None)


def check_indices(*signals: Any, where: str) -> None:
    """Raises InputError for pandas objects whose indices say another order than their places: those that do not rise,
    and two that differ, but for one that only counts."""
    every = [each for signal in signals for each in (signal.values() if isinstance(signal, dict) else [signal])]
    indices = [each.index for each in every if hasattr(each, "iloc")]
    telling = [index for index in indices if not np.array_equal(index, range(len(index)))]
    if any(not index.is_monotonic_increasing or not index.equals(telling[0]) for index in telling):
        remedy = "align them, as in a frame that holds all of them, or give their `.to_numpy()`"
        raise InputError("the signals have different indices", where=where, remedy=remedy)


def seconds(value: Any, where: str) -> float:
    """A number, or text such as `0.5 s` or `20 ms`."""
    number = _quantity(value, TIME) if isinstance(value, str) else value
    if isinstance(number, bool) or not isinstance(number, int | float | np.number) or not 0 <= number < math.inf:
        raise InputError(f"{value!r} is no time", where=where, remedy="give s, or text such as '20 ms'")
    return float(number)


def by_axis(signals: Signals, samples: int | None, where: str, axes: Sequence[str] = AXES) -> dict[str, Array]:
    """Each axis' signal (samples,). Raises InputError where lengths or axes do not fit."""
    if signals is None:
        raise InputError("is missing", where=where, remedy="give an array, or a dict of them by axis")
    if isinstance(signals, Mapping) or hasattr(signals, "columns"):
        signal_of = {str(axis): _flat(numbers(values, where)) for axis, values in signals.items()}
    else:
        signal_of = dict(zip(axes, _rows(numbers(signals, where), samples, axes, where), strict=False))
    if not signal_of:
        raise InputError("holds no axis", where=where, remedy="give an array, or a dict such as {'x': array}")
    for axis, values in signal_of.items():
        length = samples if samples is not None else next(iter(signal_of.values())).size
        if values.ndim != 1 or values.size != length:
            problem = f"axis {axis} has the shape {values.shape}, not ({length},)"
            raise InputError(problem, where=where, remedy="give time, drive and response over the same samples")
        if axes is not AXES and axis not in axes:
            remedy = f"give its drive too, or call it one of {', '.join(axes)}"
            raise InputError(f"axis {axis!r} has no drive", where=where, remedy=remedy)
    return signal_of


def numbers(values: Any, where: str) -> Array:
    """Real numbers, in an array of their own; what is masked is a gap."""
    try:
        if np.iscomplexobj(values) or np.asarray(values).dtype.kind == "b":
            raise TypeError
        if isinstance(values, np.ma.MaskedArray):
            return np.ma.filled(values.astype(np.float64), np.nan)
        return np.array(values, dtype=np.float64)
    except (TypeError, ValueError):
        remedy = "give plain real numbers, NaN where one is missing"
        raise InputError("holds something that is no number", where=where, remedy=remedy) from None


def by_unit(units: Units, axes: Sequence[str], where: str, usual: str) -> dict[str, str]:
    """The unit of each axis. Raises InputError for one that is missing or unknown."""
    given = dict(units) if isinstance(units, Mapping) else dict.fromkeys(axes, units)
    for axis in axes:
        if axis not in given:
            raise InputError(f"no unit of axis {axis}", where=where, remedy=f"give {{{axis!r}: {usual!r}}}")
        if not isinstance(given[axis], str):
            remedy = f"give text such as {usual!r}, or a dict by axis"
            raise InputError(f"{given[axis]!r} is no unit", where=where, remedy=remedy)
        try:
            factor(given[axis])
        except InputError as error:
            raise InputError(error.message, where=where, remedy=error.remedy) from None
    return {axis: given[axis] for axis in axes}


def by_level(levels: Any, units: Mapping[str, str], where: str) -> dict[str, float]:
    """A constant drive of each axis in its unit, of a number or text such as `0 V` for all axes or by axis; empty for
    None. Raises InputError where one is no number, or in another kind of unit, and for an axis that has no drive."""
    given = {} if levels is None else levels if isinstance(levels, Mapping) else dict.fromkeys(units, levels)
    for axis in given:
        if axis not in units:
            raise InputError(f"axis {axis!r} has no drive", where=where, remedy=f"name {' or '.join(units)}")
    return {axis: _level(level, units[axis], where) for axis, level in given.items()}


def _level(level: Any, unit: str, where: str) -> float:
    number = _quantity(level, dimension(unit)) if isinstance(level, str) else level
    if isinstance(number, bool) or not isinstance(number, int | float | np.number) or not math.isfinite(number):
        remedy = f"give a number, or text such as '0 {unit}'"
        raise InputError(f"{level!r} is no drive in {unit}", where=where, remedy=remedy)
    return float(number) / (factor(unit) if isinstance(level, str) else 1)


def path_of(path: Any, where: str) -> Path:
    if not isinstance(path, str | PathLike) or not str(path):
        raise InputError(f"{path!r} is no path", where=where, remedy="give text such as 'run', or a pathlib.Path")
    return Path(path)


@contextmanager
def writable(path: Path) -> Iterator[None]:
    """An OSError of the block as InputError."""
    try:
        yield
    except OSError as error:
        problem = f"cannot be written: {error.strerror or error}"
        raise InputError(problem, where=str(path), remedy="give another path or shorter names") from None


def of_kind(value: Any, kind: type, where: str, remedy: str) -> None:
    """Raises InputError where an argument is something else."""
    if not isinstance(value, kind):
        raise InputError(f"{type(value).__name__} is no {kind.__name__}", where=where, remedy=remedy)


def quantity_of(text: str, unit: str) -> float | None:
    """A number with a unit of the kind of another one, in SI units; None if it is none."""
    return _quantity(text, dimension(unit))


def _quantity(text: Any, kind: Dimension) -> float | None:
    """A number with a unit of a kind, in SI units."""
    parts = QUANTITY.match(text.strip()) if isinstance(text, str) else None
    try:
        return float(parts[1]) * factor(parts[2]) if parts and dimension(parts[2]) == kind else None
    except ValueError:  # InputError is one
        return None


def _positive(rate: float, where: str, remedy: str) -> float:
    if not 0 < rate < math.inf:
        raise InputError(f"the sample rate {rate:g} Hz is not positive", where=where, remedy=remedy)
    return rate


def _rows(values: Array, samples: int | None, axes: Sequence[str], where: str) -> Array:
    """(axes, samples) of an array (samples,), (samples, axes) or, where only that fits, (axes, samples)."""
    length = max(values.shape, default=0) if samples is None else samples
    rows = np.atleast_2d(values)
    if values.ndim == 2 and length != values.shape[1]:
        rows = values.T
    if values.ndim not in (1, 2) or len(rows) > len(axes):
        driven = "" if axes is AXES else f" for the drive of {', '.join(axes)}"
        remedy = "give (samples,) for one axis, (samples, axes) for more, or a dict by axis"
        raise InputError(f"an array of shape {values.shape}{driven}", where=where, remedy=remedy)
    return rows


def _flat(values: NDArray[Any]) -> NDArray[Any]:
    """One column or row as (samples,)."""
    return values.reshape(-1) if values.ndim == 2 and 1 in values.shape else values
