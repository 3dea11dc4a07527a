"""The column of a file that a channel of the job names."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.readers.table import Column, Table
from pzt_ident.data.record import Channel, Source
from pzt_ident.data.units import plain
from pzt_ident.errors import InputError, in_words, nearest


def select_column(table: Table, source: Source, channel: Channel, where: str) -> tuple[Column, NDArray[Any]]:
    """The column that `channel` names, and its values, (samples,).

    A name or data set is looked up below `source.dataset`: with its unit, without it, then ignoring case. A number
    counts from 1, along the second axis of an array. Raises InputError where no column fits or several do.
    """
    columns, scalars = (_columns_below(items, source.dataset) for items in (table.columns, table.scalars))
    if source.dataset and not columns:
        groups = {
            "/".join(parts[:n]) for parts in (_path(c.header).split("/") for c in table.columns) for n in range(1, 9)
        }
        raise InputError(f"has no data set {source.dataset!r}", where=where, remedy=nearest(source.dataset, groups))
    name, number = channel.dataset or channel.name, channel.column
    if name:
        column = _column_named([*columns, *scalars], name, source.dataset, where)
    elif len(columns) == 1 and np.ndim(_loaded(columns[0], where)) > 1:
        column = columns[0]
    else:
        column, number = _column_numbered(columns, number, where), None
    index = channel.index or source.index
    return column, _vector(column, _sliced_array(_loaded(column, where), index, where), number, where)


def _loaded(column: Column, where: str) -> NDArray[Any]:
    try:
        return column.load()
    except InputError as error:
        raise InputError(error.message, where=where, remedy=error.remedy) from None
    except Exception as error:  # a damaged file can raise anything in the library that reads its format
        problem = f"cannot be read: {in_words(error)}"
        raise InputError(problem, where=where, remedy="is the file complete?") from error


def _path(text: str) -> str:
    return plain(text).replace(".", "/").strip("/")


def _columns_below(columns: Sequence[Column], dataset: str | None) -> list[Column]:
    """The columns in a group, or the one data set of exactly that path."""
    if not dataset:
        return list(columns)
    prefix = _path(dataset)
    return [column for column in columns if (_path(column.header) + "/").startswith(prefix + "/")]


def _column_named(columns: Sequence[Column], name: str, dataset: str | None, where: str) -> Column:
    group = _path(dataset or "")
    path = _path(f"{group}/{name}")
    spellings: tuple[Callable[[Column], str], ...] = (
        lambda column: _path(column.header),
        lambda column: _path(column.name),
        lambda column: _path(column.header).lower(),
        lambda column: _path(column.name).lower(),
    )
    for n, spelling in enumerate(spellings):
        matches = [i for i, column in enumerate(columns) if spelling(column) == (path.lower() if n > 1 else path)]
        if len(matches) == 1:
            return columns[matches[0]]
        if matches:
            numbers = " and ".join(str(i + 1) for i in matches)
            raise InputError(
                f"column {name!r} occurs {len(matches)} times", where=where, remedy=f"give `column:` {numbers}"
            )
    known = [column.header.strip("/")[len(group) :].lstrip("/") for column in columns]
    remedy = (
        nearest(name, filter(None, known)) if any(known) else f"it has no header: give `column:` 1 to {len(columns)}"
    )
    raise InputError(f"has no column {name!r}", where=where, remedy=remedy)


def _column_numbered(columns: Sequence[Column], number: int | None, where: str) -> Column:
    if number is None and len(columns) != 1:
        names = ", ".join(repr(column.header) for column in columns if column.header)
        raise InputError(
            f"holds {len(columns)} columns", where=where, remedy=f"say which by name or `column:`; {names}"
        )
    number = 1 if number is None else number
    if not 1 <= number <= len(columns):
        remedy = f"columns count from 1 to {len(columns)}"
        raise InputError(f"column {number} is out of range", where=where, remedy=remedy)
    return columns[number - 1]


def _sliced_array(values: NDArray[Any], index: tuple[int | str, ...] | None, where: str) -> NDArray[Any]:
    if index is None:
        return values
    try:
        return values[tuple(_slice(item) for item in index)]
    except (IndexError, ValueError):
        text = ", ".join(map(str, index))
        remedy = f"the array has the shape {values.shape}; indices count from 0, ':' takes all"
        raise InputError(f"index [{text}] is wrong", where=where, remedy=remedy) from None


def _slice(item: int | str) -> int | slice:
    if isinstance(item, int):
        return item
    if ":" not in item:
        return int(item)
    return slice(*(int(part) if part.strip() else None for part in item.split(":")))


def _vector(column: Column, values: NDArray[Any], number: int | None, where: str) -> NDArray[Any]:
    values = np.squeeze(values)
    if values.size == 0:
        raise InputError("holds no values", where=where, remedy="was the recording stopped before it was saved?")
    if number is not None and values.ndim < 3:
        matrix = values.reshape(len(np.atleast_1d(values)), -1)
        if not 1 <= number <= matrix.shape[1]:
            remedy = f"columns count from 1 to {matrix.shape[1]}"
            raise InputError(f"column {number} is out of range", where=where, remedy=remedy)
        values = matrix[:, number - 1]
    if values.ndim > 1:
        problem = f"{column.header!r} is an array of shape {values.shape}, not one signal"
        raise InputError(problem, where=where, remedy="take one with `column: 1` or `index: [':', 0]`")
    if values.dtype.kind in "cmM":
        problem = f"{column.header!r} holds values of type {values.dtype}, not real numbers"
        raise InputError(problem, where=where, remedy="store real signals, and time in s")
    return np.atleast_1d(values)
