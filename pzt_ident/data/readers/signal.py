"""A channel of a record as numbers in SI units, with the place of every row for error messages."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.readers.table import Column
from pzt_ident.data.units import factor, plain
from pzt_ident.errors import InputError

USUAL = {"time": "s", "drive": "V"}  # units, that of a response is um
LARGEST = 1e11
"""In SI units: no rig measures as much, and squares of much more overflow."""


@dataclass(frozen=True)
class Signal:
    """`values`: (samples,), in SI units, from row `first` of the column on. `unit`: as the user gave it."""

    column: Column
    values: NDArray[np.float64]
    unit: str
    where: str
    first: int = 0

    def place(self, row: int) -> str:
        return self.column.place(self.first + row)

    def cut(self, part: slice) -> Signal:
        return replace(self, values=self.values[part], first=self.first + (part.start or 0))

    def complete(self) -> Signal:
        """The signal itself. Raises InputError that names the rows without a finite number."""
        gaps = np.flatnonzero(~np.isfinite(self.values))
        if gaps.size:
            runs = np.split(gaps, np.flatnonzero(np.diff(gaps) > 1) + 1)
            places = [self.place(run[0]) + (f" to {self.place(run[-1])}" if len(run) > 1 else "") for run in runs[:3]]
            count = "1 value is" if gaps.size == 1 else f"{gaps.size} values are"
            which = "infinite" if np.isinf(self.values[gaps]).all() else "missing"
            problem = f"{count} {which}: {', '.join(places)}{', ...' if len(runs) > 3 else ''}"
            raise InputError(problem, where=self.where, remedy="fill the gap, or leave it out with `rows`")
        largest = int(np.abs(self.values).argmax())
        if abs(self.values[largest]) > LARGEST:
            problem = f"{self.place(largest)} holds {self.values[largest]:.4g} in SI units, beyond all measure"
            raise InputError(problem, where=self.where, remedy="correct the value, or leave the row out with `rows`")
        return self


def signal_of(
    column: Column, values: NDArray[Any], rows: tuple[int | None, int | None] | None, unit: str | None, where: str
) -> Signal:
    """The rows of a column in SI units; the unit is that of the job, else that of the file.

    Raises InputError on text, on rows out of range, and on a unit that is missing or unknown.
    """
    first, end = _bounds(rows, len(values), where)
    numbers, unit = _numbers(column, values[first:end], first, where), unit or column.unit
    if unit is None:
        usual = next((unit_of_kind for kind, unit_of_kind in USUAL.items() if where.endswith(kind)), "um")
        header = f"`{column.name or 'x'} [{usual}]`"
        remedy = f"write it in the header, as in {header}, or in the job: `unit: {usual}` of this channel"
        raise InputError("has no unit", where=where, remedy=remedy)
    try:
        scale = factor(unit)
    except InputError as error:
        raise InputError(error.message, where=where, remedy=error.remedy) from None
    return Signal(column, scale * numbers, unit, where, first)


def _bounds(rows: tuple[int | None, int | None] | None, total: int, where: str) -> tuple[int, int]:
    first, end = rows or (None, None)
    first, end = first or 0, total if end is None else end
    if not 0 <= first < end <= total:
        problem = f"rows [{first}, {end}] are out of range"
        raise InputError(problem, where=where, remedy=f"there are {total} rows, [0, {total}] takes all")
    return first, end


def _numbers(column: Column, values: NDArray[Any], first: int, where: str) -> NDArray[np.float64]:
    if values.dtype.kind in "biuf" or all(map(_is_number, values)):
        return np.asarray(values, dtype=float)
    row = next(i for i, value in enumerate(values) if not _is_number(value))
    problem = f"{column.place(first + row)} holds {str(values[row])!r} instead of a number"
    remedy = "correct the value, or leave the row out with `rows`"
    if plain(str(values[row])) in (plain(column.header), plain(column.name)):
        parts = f"`rows: [{first}, {first + row}]` and `rows: [{first + row + 1}, {first + len(values)}]`"
        remedy = f"another measurement begins there: give each a record of its own, by {parts}"
    elif re.fullmatch(r"[+-]?\d{1,3}([,'’ \u00a0\u202f]\d{3})+(\.\d*)?", str(values[row])):
        remedy = "export the numbers without signs between the thousands"
    elif re.search(r"\d[:-]\d", str(values[row])):
        remedy = "dates and times of day are not read: leave `time` out and give `sample_rate`"
    raise InputError(problem, where=where, remedy=remedy)


def _is_number(value: Any) -> bool:
    """Python reads 1_0 as 10, a table does not."""
    try:
        float(value)
    except (TypeError, ValueError):
        return False
    return "_" not in str(value)
