"""What a data file holds, and which of its columns look like time, drive and response."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from pzt_ident.data.readers.open import open_table, parts_of
from pzt_ident.data.readers.table import Column, Table
from pzt_ident.data.record import Source
from pzt_ident.data.units import FREQUENCY, TIME, dimension, factor, is_unit
from pzt_ident.errors import InputError

SHOWN = 5  # values of each column
LEAST = 3  # values of a column
MOST = 40  # columns of an array
BINS = 60  # of its shape
AXES = "xyz"
_LENGTH, _VOLTAGE, _FIELD, _CHARGE, _POLARIZATION = map(dimension, ("m", "V", "V/m", "C", "C/m2"))
_NAMES = {
    "time": r"t|time|zeit|clock|timestamp|sec(onds?)?",
    "drive": r"u|v|vplus|e|volt.*|drive|input|command|cmd|field|.*voltage",
    "response": r"x|y|z|d|pos.*|disp.*|sensor|resp.*|output|strain|.*displacement|.*position",
}

_RATES = {"fs": FREQUENCY, "rate": FREQUENCY, "samplerate": FREQUENCY, "dt": TIME, "ts": TIME, "increment": TIME}


def columns_of(*files: tuple[Path, str | None]) -> dict[str, Any]:
    """The numeric columns of the files of a record with their first values, range, unit and guessed role, and which
    of the files each is `of`: of a table or sheet where one is named, else of the first that holds any. `rate` is the
    sample rate that a file states.

    Raises InputError where a file cannot be read or has no such column, or files differ in length.
    """
    about, columns, rate = list[dict[str, Any]](), list[dict[str, Any]](), ""
    for path, part in files:
        facts, table = _of_file(path, part)
        columns += [item | {"of": len(about)} for item in _columns(table)]
        rate = rate or _rate(table)
        about.append(facts)
    rows = {item["rows"] for item in columns}
    if len(rows) > 1:
        lengths = ", ".join(
            f"{name} {next(c['rows'] for c in columns if c['of'] == i)}"
            for i, name in enumerate(facts["file"] for facts in about)
        )
        raise InputError(f"the files of a record differ in rows: {lengths}", remedy="drop files of one measurement")
    _guess(columns)
    return {"files": about, "rows": rows.pop(), "rate": rate, "columns": columns}


def _of_file(path: Path, part: str | None) -> tuple[dict[str, Any], Table]:
    """Facts of a file, and its table: that which is named, else the first that holds columns of numbers."""
    kind, parts = parts_of(path)
    about = {"file": path.name, "kind": kind, "parts": parts}
    *others, last = [part] if part or not parts else parts
    for tried in others:
        with suppress(InputError):
            table = open_table(path, Source(str(path), **{kind: tried}))  # type: ignore[arg-type]
            _columns(table)
            return about | {"part": tried}, table
    return about | {"part": last}, open_table(path, Source(str(path), **({kind: last} if kind else {})))  # type: ignore[arg-type]


def _columns(table: Table) -> list[dict[str, Any]]:
    """The longest that it holds. Raises InputError where it holds none."""
    found = [item for number, column in enumerate(_apart(table.columns), 1) if (item := _column(number, column))]
    rows = max((item["rows"] for item in found), default=0)
    if not rows:
        remedy = "drop a table of signals; of an array of more than two dimensions a job file takes slices by `index`"
        raise InputError(f"holds no column of at least {LEAST} numbers", where=table.path.name, remedy=remedy)
    return [item for item in found if item["rows"] == rows]


def _rate(table: Table) -> str:
    """The sample rate, by a value that stands for one or for the sample time."""
    for column in table.scalars:
        word = re.split(r"[\W_]+", column.name.lower())[-1]
        kind = dimension(column.unit) if column.unit and is_unit(column.unit) else _RATES.get(word)
        if kind not in (TIME, FREQUENCY):
            continue
        with suppress(ValueError, TypeError):
            value = float(np.squeeze(column.load())) * factor(column.unit or ("s" if kind == TIME else "Hz"))
            if 0 < value < np.inf:
                return f"{1 / value if kind == TIME else value:.9g} Hz"
    return ""


def _apart(columns: Sequence[Column]) -> Sequence[Column]:
    """The columns of the array, where a file has nothing but one of two dimensions."""
    if len(columns) != 1:
        return columns
    array = columns[0].load()
    if np.ndim(array) != 2 or 1 in np.shape(array):
        return columns
    return [Column("", partial(array.__getitem__, np.s_[:, i])) for i in range(min(np.shape(array)[1], MOST))]


def _column(number: int, column: Column) -> dict[str, Any] | None:
    try:
        values = np.squeeze(np.asarray(column.load(), dtype=float))
    except (ValueError, TypeError):
        return None
    if values.ndim != 1 or values.size < LEAST or not np.isfinite(values).any():
        return None
    return {
        "number": number,
        "header": column.header,
        "name": column.name,
        "unit": _unit(column),
        "rows": values.size,
        "first": values[:SHOWN].tolist(),
        "low": float(np.nanmin(values)),
        "high": float(np.nanmax(values)),
        "regular": _regular(values),
        "shape": _shape(values),
        "rough": _rough(values),
        "role": "",
    }


def _unit(column: Column) -> str | None:
    """As the header says, or as its name ends: `disp_nm`."""
    if column.unit:
        return column.unit if is_unit(column.unit) else None
    end = column.name.rpartition("_")[2]
    named = end != column.name and is_unit(end) and dimension(end) in (TIME, _LENGTH, _VOLTAGE)
    return end if named else None


def _regular(values: np.ndarray) -> bool:
    steps = np.diff(values)
    return bool((steps > 0).all() and np.ptp(steps) < 0.01 * np.median(steps))


def _shape(values: np.ndarray) -> list[float]:
    """Lowest and highest value of each of some bins, from 0 to 1: what a small picture is drawn from."""
    low, span = np.nanmin(values), np.nanmax(values) - np.nanmin(values)
    bins = np.array_split(np.nan_to_num((values - low) / (span or 1)), min(BINS, values.size))
    return [round(float(end), 3) for part in bins for end in (part.min(), part.max())]


def _rough(values: np.ndarray) -> float:
    """Third difference over the span: a sensor's noise stands out."""
    span = np.nanmax(values) - np.nanmin(values)
    return float(np.nanmedian(np.abs(np.diff(values, 3))) / (span or 1)) if values.size > 3 else 0.0


def _guess(columns: list[dict[str, Any]]) -> None:
    """One column a role: by its unit or its name, and where no column says so by its place, of two without a name the
    smoother one being the drive. Another axis where one letter tells both its signals from those of the first."""
    by_sign = (("time", _is_time), ("x.drive", _is_drive), ("x.response", _is_length), ("x.response", _is_charge))
    for role, fits in by_sign:
        _take(columns, role, fits)
    for role in ("x.drive", "x.response") if len(columns) > 1 else ():
        _take(columns, role, lambda item: True)
    first = [item for role in ("x.drive", "x.response") for item in columns if item["role"] == role]
    if len(first) == 2 and not first[0]["name"] and first[0]["rough"] > 2 * first[1]["rough"]:
        first[0]["role"], first[1]["role"] = "x.response", "x.drive"
    for axis in AXES[1:]:
        pair = [next((item for item in columns if _beside(item, one)), None) for one in first]
        if len(pair) == 2 and pair[0] and pair[1]:
            pair[0]["role"], pair[1]["role"] = f"{axis}.drive", f"{axis}.response"


def _beside(item: dict[str, Any], first: dict[str, Any]) -> bool:
    """Whether a column without a role is called as another one, but for the sign of its axis, and moves."""
    alike = first["name"] != item["name"] and _unsigned(first["name"]) == _unsigned(item["name"])
    return not item["role"] and alike and item["unit"] == first["unit"] and item["high"] > item["low"]


def _unsigned(name: str) -> str:
    """A name less what may tell one axis from another: a digit or a letter of x y z a b c by itself or at an end."""
    return re.sub(r"(?<![0-9])[0-9](?![0-9])|(?<![a-z])[xyzabc](?![a-z])|(?<=[0-9_])[xyzabc]|[xyz]$", "", name.lower())


def _take(columns: list[dict[str, Any]], role: str, fits: Callable[[dict[str, Any]], bool]) -> None:
    """Give a role that none has to the first column that is free, moves and fits."""
    for item in columns if role not in [item["role"] for item in columns] else ():
        if not item["role"] and item["high"] > item["low"] and fits(item):
            item["role"] = role
            return


def _is_time(item: dict[str, Any]) -> bool:
    by_name = _named(item, "time") or not item["name"]
    return bool(item["unit"] and dimension(item["unit"]) == TIME) or (item["regular"] and by_name)


def _is_drive(item: dict[str, Any]) -> bool:
    return _by_unit(item, "drive", (_VOLTAGE, _FIELD))


def _is_length(item: dict[str, Any]) -> bool:
    return _by_unit(item, "response", (_LENGTH,))


def _is_charge(item: dict[str, Any]) -> bool:
    return bool(item["unit"]) and dimension(item["unit"]) in (_CHARGE, _POLARIZATION)


def _by_unit(item: dict[str, Any], role: str, kinds: Sequence[Any]) -> bool:
    return dimension(item["unit"]) in kinds if item["unit"] else _named(item, role)


def _named(item: dict[str, Any], role: str) -> bool:
    words = re.split(r"[\W_]+", item["name"].lower())
    return any(re.fullmatch(_NAMES[role], word) for word in words if word)
