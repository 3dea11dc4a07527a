"""The columns of a data file, and a guess which are time, drive and response."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import lru_cache, partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.readers.open import open_table, parts_of
from pzt_ident.data.readers.table import Column, Table, unit_of
from pzt_ident.data.record import Source
from pzt_ident.data.units import FREQUENCY, TIME, dimension, factor, is_unit
from pzt_ident.errors import InputError

FIRST_VALUES = 5  # of each column, to be shown
MIN_ROWS = 3  # of a column
MAX_COLUMNS = 40  # of an array
SHAPE_BINS = 60  # of the preview of a column
AXES = "xyz"
_LENGTH, _VOLTAGE, _FIELD, _CHARGE, _POLARIZATION = map(dimension, ("m", "V", "V/m", "C", "C/m2"))
_NAMES = {
    "time": r"t|time|zeit|clock|timestamp|sec(onds?)?",
    "drive": r"u|v|vplus|e|volt.*|drive|input|command|cmd|field|.*voltage",
    "response": r"x|y|z|d|pos.*|disp.*|sensor|resp.*|output|strain|.*displacement|.*position",
}

_RATES = {"fs": FREQUENCY, "rate": FREQUENCY, "samplerate": FREQUENCY, "dt": TIME, "ts": TIME, "increment": TIME}


def columns_of(*files: tuple[Path, str | None]) -> dict[str, Any]:
    """The numeric columns of the files of one record: first values, range, unit, guessed role, and as `of` the index
    of the file. `files`: paths, each with a table or sheet or None for the first that has numeric columns. `rate`: the
    sample rate if a file states it.

    Raises InputError if a file cannot be read or has no numeric column, or if the files differ in length.
    """
    sources, columns, rate = list[dict[str, Any]](), list[dict[str, Any]](), ""
    for path, part in files:
        read = _opened(path, part)
        columns += [column | {"of": len(sources)} for column in read.columns]
        rate = rate or read.rate
        sources.append(dict(read.source))
    rows = {column["rows"] for column in columns}
    if len(rows) > 1:
        lengths = ", ".join(
            f"{source['file']} {next(column['rows'] for column in columns if column['of'] == i)}"
            for i, source in enumerate(sources)
        )
        raise InputError(f"the files of a record differ in rows: {lengths}", remedy="drop files of one measurement")
    _guess(columns)
    return {"files": sources, "rows": rows.pop(), "rate": rate, "columns": columns}


def values_of(*files: tuple[Path, str | None]) -> dict[tuple[int, int], NDArray[np.float64]]:
    """The numeric columns of the files of one record by index of the file and number of the column."""
    columns = dict[tuple[int, int], NDArray[np.float64]]()
    for index, (path, part) in enumerate(files):
        columns |= {(index, number): values for number, values in _opened(path, part).values.items()}
    return columns


class _File(NamedTuple):
    """Name, kind and parts of a file, its numeric columns, the sample rate that it states, and the values by number of
    the column."""

    source: dict[str, Any]
    columns: list[dict[str, Any]]
    rate: str
    values: dict[int, NDArray[np.float64]]


def _opened(path: Path, part: str | None) -> _File:
    """A file; read again when it changes."""
    try:
        stamp = path.stat().st_mtime_ns
    except OSError:
        stamp = 0
    return _read(path, part, stamp)


@lru_cache(4)
def _read(path: Path, part: str | None, stamp: int) -> _File:
    """The named part of a file, else the first that has numeric columns."""
    kind, parts = parts_of(path)
    source = {"file": path.name, "kind": kind, "parts": parts}
    *first, last = [part] if part or not parts else parts
    for name in first:
        with suppress(InputError):
            return _file(source | {"part": name}, open_table(path, Source(str(path), **{kind: name})))  # type: ignore[arg-type]
    table = open_table(path, Source(str(path), **({kind: last} if kind else {})))  # type: ignore[arg-type]
    return _file(source | {"part": last}, table)


def _file(source: dict[str, Any], table: Table) -> _File:
    """What a table holds. Raises InputError if it has no numeric columns."""
    columns = dict(enumerate(_split_array(table.columns), 1))
    values = {number: found for number, column in columns.items() if (found := _numbers(column)) is not None}
    rows = max((column.size for column in values.values()), default=0)
    if not rows:
        remedy = "drop a table of signals; for an array of more than two dimensions write a job file with `index`"
        raise InputError(f"holds no column of at least {MIN_ROWS} numbers", where=table.path.name, remedy=remedy)
    longest = [_facts(number, columns[number], found) for number, found in values.items() if found.size == rows]
    return _File(source, longest, _rate(table), values)


def hertz(rate: str) -> float:
    """A sample rate such as `200 Hz`. Raises ValueError for what is none."""
    number, unit = re.fullmatch(r"\s*([\d.eE+-]+)\s*(\w+)\s*", rate).groups()  # type: ignore[union-attr]
    return float(number) * factor(unit)


def _rate(table: Table) -> str:
    """The sample rate as text, from a scalar that is a sample rate or a sample time; empty if there is none."""
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


def _split_array(columns: Sequence[Column]) -> Sequence[Column]:
    """The columns of the array if the file holds a single two-dimensional array, else `columns`."""
    if len(columns) != 1:
        return columns
    array = columns[0].load()
    if np.ndim(array) != 2 or 1 in np.shape(array):
        return columns
    return [Column("", partial(array.__getitem__, np.s_[:, i])) for i in range(min(np.shape(array)[1], MAX_COLUMNS))]


def _facts(number: int, column: Column, values: NDArray[np.float64]) -> dict[str, Any]:
    return {
        "number": number,
        "header": column.header,
        "name": column.name,
        "unit": unit_of(column),
        "rows": values.size,
        "missing": int((~np.isfinite(values)).sum()),
        "first": [float(value) if np.isfinite(value) else None for value in values[:FIRST_VALUES]],
        "low": float(np.nanmin(values)),
        "high": float(np.nanmax(values)),
        "regular": _regular(values),
        "shape": _shape(values),
        "rough": _roughness(values),
        "role": "",
    }


def _numbers(column: Column) -> NDArray[np.float64] | None:
    """The values of a column, None unless it holds some numbers."""
    try:
        values = np.squeeze(np.asarray(column.load(), dtype=float))
    except (ValueError, TypeError):
        return None
    numeric = values.ndim == 1 and values.size >= MIN_ROWS and np.isfinite(values).any()
    return values if numeric else None


def _regular(values: np.ndarray) -> bool:
    """Whether the values rise by equal steps."""
    steps = np.diff(values)
    return bool((steps > 0).all() and np.ptp(steps) < 0.01 * np.median(steps))


def _shape(values: np.ndarray) -> list[float]:
    """Minimum and maximum of each bin, scaled to 0 to 1, for a small preview."""
    low, span = np.nanmin(values), np.nanmax(values) - np.nanmin(values)
    bins = np.array_split(np.nan_to_num((values - low) / (span or 1)), min(SHAPE_BINS, values.size))
    return [round(float(value), 3) for block in bins for value in (block.min(), block.max())]


def _roughness(values: np.ndarray) -> float:
    """Median absolute third difference over the span, large for a noisy sensor; NaN where too few values follow each
    other."""
    span, third = np.nanmax(values) - np.nanmin(values), np.abs(np.diff(values, 3))
    finite = third[np.isfinite(third)]
    return float(np.median(finite) / (span or 1)) if finite.size else float("nan")


def _guess(columns: list[dict[str, Any]]) -> None:
    """Give each role to one column: by unit or name, else by order, where the smoother of two unnamed columns is the
    drive. A uniform ramp counts samples: it is a drive only where its unit says so, and nothing else is one. A column
    that rests has a role where its unit or name says so, since it may move in another record. A further axis is
    recognised where both its names differ from those of the first by one letter or digit."""
    by_evidence = (("time", _is_time), ("x.drive", _is_drive), ("x.response", _is_length), ("x.response", _is_charge))
    for role, fits in by_evidence:
        _assign(columns, role, fits, ramps=role == "time")
    _assign(columns, "x.drive", lambda column: bool(column["unit"]) and _is_drive(column), ramps=True)
    for role, fits in by_evidence[1:]:
        _assign(columns, role, fits, still=True)
    for role in ("x.drive", "x.response") if len(columns) > 1 else ():
        _assign(columns, role, lambda column: True)
    first = [column for role in ("x.drive", "x.response") for column in columns if column["role"] == role]
    if len(first) == 2 and not first[0]["name"] and first[0]["rough"] > 2 * first[1]["rough"]:
        first[0]["role"], first[1]["role"] = "x.response", "x.drive"
    for axis in AXES[1:]:
        pair = [next((column for column in columns if _is_counterpart(column, signal)), None) for signal in first]
        if len(pair) == 2 and pair[0] and pair[1]:
            pair[0]["role"], pair[1]["role"] = f"{axis}.drive", f"{axis}.response"


def _is_counterpart(item: dict[str, Any], first: dict[str, Any]) -> bool:
    """Whether a column without a role is not constant and has the name of another but for the sign of its axis."""
    same_name = first["name"] != item["name"] and _without_axis(first["name"]) == _without_axis(item["name"])
    return not item["role"] and same_name and item["unit"] == first["unit"] and item["high"] > item["low"]


def _without_axis(name: str) -> str:
    """A name without its axis: a single digit, or one of the letters x y z a b c by itself or at an end."""
    return re.sub(r"(?<![0-9])[0-9](?![0-9])|(?<![a-z])[xyzabc](?![a-z])|(?<=[0-9_])[xyzabc]|[xyz]$", "", name.lower())


def _assign(
    columns: list[dict[str, Any]],
    role: str,
    fits: Callable[[dict[str, Any]], bool],
    still: bool = False,
    ramps: bool = False,
) -> None:
    """Give a role that no column has to the first column that is free and `fits`; constant if `still`, else not; no
    uniform ramp unless `ramps`."""
    for item in columns if role not in [item["role"] for item in columns] else ():
        constant = not item["high"] > item["low"]
        if not item["role"] and constant == still and (ramps or not item["regular"]) and fits(item):
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
