"""Candidates whose axes do not act on each other: an axis is simulated once for all candidates that have it alike."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pzt_ident.model.block import Coupling, Modes
from pzt_ident.model.chain import Chain

Array = NDArray[np.float64]
Columns = NDArray[np.intp]


class Distinct(NamedTuple):
    """theta: (simulated, parameters), candidates with each axis of those that were asked for at least once. rows:
    (measured axes, candidates), which of them has the axis of a candidate; None where they are the candidates."""

    theta: Array
    rows: Columns | None = None

    def of_candidates(self, values: NDArray[Any]) -> NDArray[Any]:
        """What was simulated, (simulated, measured axes, ...), as (candidates, measured axes, ...)."""
        if self.rows is None:
            return values
        return np.stack([values[rows, i] for i, rows in enumerate(self.rows)], axis=1)

    def put(self, values: Array, axis: int, out: Array) -> None:
        """Put what was simulated of a measured axis, (simulated, samples), into `out`, (candidates, samples)."""
        if self.rows is None:
            out[:] = values
            return
        for place, row in zip(out, self.rows[axis].tolist(), strict=True):
            place[:] = values[row]

    def chosen(self, axis: int) -> Array:
        """Of each candidate (rows) a one for what has its measured axis of this number (columns)."""
        rows = np.arange(len(self.theta)) if self.rows is None else self.rows[axis]
        return np.asarray(np.eye(len(self.theta))[rows])


def columns_of_axes(model: Chain) -> list[Columns]:
    """The columns of a complete theta that each measured axis depends on; empty where an axis depends on those of
    another one."""
    if len(model.measured) < 2 or any(issubclass(block, Coupling | Modes) for block in model.blocks):
        return []
    columns = [columns_of_axis(model, axis) for axis in model.measured]
    return columns if np.unique(np.hstack(columns)).size == sum(map(len, columns)) else []


def columns_of_axis(model: Chain, axis: int) -> Columns:
    """Columns of a complete theta that hold the parameters of all blocks on an axis."""
    by_block = [model.columns(block, axis, axis) or {} for block in (*model.blocks, *model.additions)]
    columns = [np.atleast_1d(np.array(column)) for words in by_block for column in words.values()]
    return np.hstack([np.zeros(0, dtype=np.intp), *columns])


def distinct(theta: Array, columns: Sequence[Columns]) -> Distinct:
    """The fewest candidates that have each axis of those of theta; columns: of each axis, as of `columns_of_axes`."""
    if not columns or len(theta) < 3:
        return Distinct(theta)
    firsts, rows = zip(*(distinct_rows(theta[:, own[own < theta.shape[1]]]) for own in columns), strict=True)
    count = max(map(len, firsts))
    if count == len(theta):
        return Distinct(theta)
    fewer = theta[:count].copy()
    for own, first in zip(columns, firsts, strict=True):
        own = own[own < theta.shape[1]]
        fewer[:, own] = theta[np.ix_(np.resize(first, count), own)]
    return Distinct(fewer, np.array(rows))


def distinct_rows(table: Array) -> tuple[Columns, Columns]:
    """The first of each kind of rows, and of which kind each row is."""
    rows = np.ascontiguousarray(table)
    if not rows.shape[1]:
        return np.zeros(1, dtype=np.intp), np.zeros(len(rows), dtype=np.intp)
    kinds = rows.view(np.dtype((np.void, rows.itemsize * rows.shape[1]))).ravel()
    _, first, kind = np.unique(kinds, return_index=True, return_inverse=True)
    return first, kind.ravel()
