"""The reference that a stage is to follow, from a file."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from pzt_ident.api.record import Record
from pzt_ident.control.identified import Identified
from pzt_ident.data.readers.open import open_table
from pzt_ident.data.readers.table import Column, unit_of
from pzt_ident.data.record import Source
from pzt_ident.data.units import TIME as SECONDS
from pzt_ident.data.units import dimension
from pzt_ident.errors import InputError

TIME = re.compile(r"t|time|zeit|seconds?", re.IGNORECASE)


def read_reference(path: Path, identified: Identified, rate: str | None = None) -> Record:
    """The displacement that each axis is to follow: a column named like the axis, with a unit in its header, and a
    column of time unless there is a rate. Of an axis that is not measured there may be a column of its drive.

    Raises InputError where a column or a unit is missing.
    """
    columns = open_table(path, Source(str(path))).columns
    time = next((column for column in columns if is_time(column)), None)
    if time is None and rate is None:
        remedy = "add a column `time [s]`, or give --rate"
        raise InputError("has no column of time", where=str(path), remedy=remedy)
    others = [column for column in columns if column is not time]
    needed = {axis: unit for axis, unit in identified.inputs.items() if axis in identified.axes}
    taken = {axis: _column_of(axis, others, needed, path) for axis in needed}
    driven = {axis: _named(axis, others) for axis in identified.inputs if axis not in needed}
    taken |= {axis: matching[0] for axis, matching in driven.items() if matching}

    def channel(column: Column) -> dict[str, Any]:
        return {"column": columns.index(column) + 1, "unit": unit_of(column)}

    chosen = {axis: channel(column) for axis, column in taken.items()}
    stamps = channel(time) if time and not rate else None
    try:
        return Record.read(path, drive=chosen, time=stamps, sample_rate=rate, name=path.stem)
    except InputError as error:
        remedy = error.remedy.replace("the sample rate as t", "--rate")
        raise InputError(error.message, where=error.where.replace(".drive", ""), remedy=remedy) from None


def is_time(column: Column) -> bool:
    unit = unit_of(column)
    return dimension(unit) == SECONDS if unit else bool(TIME.fullmatch(column.name))


def _column_of(axis: str, columns: Sequence[Column], units: Mapping[str, str], path: Path) -> Column:
    matching = _named(axis, columns) or (list(columns) if len(columns) == len(units) == 1 else [])
    header = f"`{axis} [{units[axis]}]`"
    if not matching:
        known = ", ".join(repr(column.header) for column in columns) or "nothing else"
        raise InputError(f"has no column for axis {axis}, but {known}", where=str(path), remedy=f"name it {header}")
    if unit_of(matching[0]) is None:
        remedy = f"write {header} into its header"
        raise InputError(f"column {matching[0].header!r} has no unit", where=str(path), remedy=remedy)
    return matching[0]


def _named(axis: str, columns: Sequence[Column]) -> list[Column]:
    return [c for c in columns if re.fullmatch(rf"{axis}|{axis}[_ ].*|.*[_ ]{axis}", c.name, re.IGNORECASE)]
