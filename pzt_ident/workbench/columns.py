"""What a data file holds, and which of its columns look like time, drive and response."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from pzt_ident.errors import InputError
from pzt_ident.readers.column import Column
from pzt_ident.readers.formats import open_table
from pzt_ident.record import Source
from pzt_ident.units import TIME, dimension, is_unit

SHOWN = 5  # values of each column
_LENGTH, _VOLTAGE, _FIELD = (dimension(unit) for unit in ("m", "V", "V/m"))
_NAMES = {
    "time": r"t|time|zeit|timestamp|sec(onds?)?",
    "drive": r"u|v|e|volt.*|drive|input|command|cmd|field|.*voltage",
    "response": r"x|y|z|d|pos.*|disp.*|sensor|resp.*|output|strain|.*displacement|.*position",
}


def columns_of(path: Path) -> dict[str, Any]:
    """The numeric columns of a file with their first values, range, unit and guessed role.

    Raises InputError where the file cannot be read or has fewer than two such columns.
    """
    table = open_table(path, Source(str(path)))
    found = [item for number, column in enumerate(table.columns, 1) if (item := _column(number, column))]
    rows = max((item["rows"] for item in found), default=0)
    found = [item for item in found if item["rows"] == rows]
    if len(found) < 2:
        raise InputError("holds no two columns of numbers", where=path.name, remedy="drop a table of signals")
    _guess(found)
    return {"file": path.name, "rows": rows, "columns": found}


def _column(number: int, column: Column) -> dict[str, Any] | None:
    try:
        values = np.squeeze(np.asarray(column.load(), dtype=float))
    except (ValueError, TypeError):
        return None
    if values.ndim != 1 or values.size < 3 or not np.isfinite(values).any():
        return None
    unit = column.unit if column.unit and is_unit(column.unit) else None
    return {
        "number": number,
        "header": column.header,
        "name": column.name,
        "unit": unit,
        "rows": values.size,
        "first": values[:SHOWN].tolist(),
        "low": float(np.nanmin(values)),
        "high": float(np.nanmax(values)),
        "regular": _regular(values),
        "role": "",
    }


def _regular(values: np.ndarray) -> bool:
    steps = np.diff(values)
    return bool((steps > 0).all() and np.ptp(steps) < 0.01 * np.median(steps))


def _guess(columns: list[dict[str, Any]]) -> None:
    """One column a role: by its unit or its name, and where no column says so by its place."""
    for role, fits in (("time", _is_time), ("drive", _is_drive), ("response", _is_response)):
        _take(columns, role, fits)
    for role in ("drive", "response"):
        if role not in [item["role"] for item in columns]:
            _take(columns, role, lambda item: True)


def _take(columns: list[dict[str, Any]], role: str, fits: Callable[[dict[str, Any]], bool]) -> None:
    """Give a role to the first column that is free, moves and fits."""
    for item in columns:
        if not item["role"] and item["high"] > item["low"] and fits(item):
            item["role"] = role
            return


def _is_time(item: dict[str, Any]) -> bool:
    by_name = _named(item, "time") or not item["name"]
    return bool(item["unit"] and dimension(item["unit"]) == TIME) or (item["regular"] and by_name)


def _is_drive(item: dict[str, Any]) -> bool:
    return _by_unit(item, "drive", (_VOLTAGE, _FIELD))


def _is_response(item: dict[str, Any]) -> bool:
    return _by_unit(item, "response", (_LENGTH,))


def _by_unit(item: dict[str, Any], role: str, kinds: tuple[Any, ...]) -> bool:
    return dimension(item["unit"]) in kinds if item["unit"] else _named(item, role)


def _named(item: dict[str, Any], role: str) -> bool:
    words = re.split(r"[\W_]+", item["name"].lower())
    return any(re.fullmatch(_NAMES[role], word) for word in words if word)
