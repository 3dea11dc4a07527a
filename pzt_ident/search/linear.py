"""Parameters that a response is linear in, solved for inside the search instead of searched."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pzt_ident.model.chain import Chain

Array = NDArray[np.float64]
Whole = NDArray[np.intp]
Residuals = Callable[[Array], Array]

PASSES = 4  # at most, where a block behind bends what is linear
STRAIGHT = 1e-9  # of the residual: what one pass may miss
LEAST = 1e-6  # of the largest column: one that no record shows is rounding


class LinearSolution(NamedTuple):
    """values: (linear,), zero where no record shows a parameter. columns: (samples, linear), what one of its size does
    to the residuals, zero there too. prior: rows (n, linear) beside them. residual: (samples,). units: (linear,)."""

    values: Array
    columns: Array
    prior: Array
    residual: Array
    units: Array


class Linear:
    """Some columns of theta that are a function of the others and of the records.

    residuals: theta (candidates, parameters) -> (candidates, samples). units: a size and sign of each.
    """

    def __init__(self, model: Chain, columns: Sequence[int], units: Array, residuals: Residuals) -> None:
        self.columns = np.array(columns, dtype=int)
        self._units, self._residuals = units, residuals
        self._solved = lru_cache(256)(self._solve)
        entries = [model.entries[column] for column in columns]
        names = [f"{entry.axis} {entry.parameter.name}" if entry.parameter.smooth else "" for entry in entries]
        self._curves = [np.flatnonzero(np.array(names) == name) for name in dict.fromkeys(names) if name]
        self._weights = [
            (model.columns(entry.block, entry.axis, entry.axis) or {})[entry.parameter.smooth]
            for entry in entries
            if entry.parameter.smooth
        ]

    def fill(self, theta: Array) -> None:
        """Put the solved values into theta (candidates, parameters)."""
        if self.columns.size:
            theta[:, self.columns] = [self.solved(row).values for row in theta]

    def solved(self, row: Array) -> LinearSolution:
        """Of one candidate, whatever its linear columns hold."""
        others = row.copy()
        others[self.columns] = 0
        return self._solved(others.tobytes())

    def _solve(self, raw: bytes) -> LinearSolution:
        row = np.frombuffer(raw)

        def residuals(values: Array) -> Array:
            theta = np.tile(row, (len(values), 1))
            theta[:, self.columns] = values
            return self._residuals(theta)

        weight = float(row[self._weights[0]]) if self._weights else 0.0  # type: ignore[call-overload]
        return solve(residuals, self._units, self._curves, weight)


def solve(residuals: Residuals, units: Array, curves: Sequence[Whole], weight: float) -> LinearSolution:
    """Non-negative multiples of `units` that leave the least squares, with those of second differences beside them.

    residuals: (candidates, linear) -> (candidates, samples). units: a size and sign of each parameter. curves: the
    places of those that are neighbours of each other. weight: of a squared second difference over the squares of the
    errors, all neighbours alike. Lawson & Hanson (1974), Solving Least Squares Problems, ch. 23; relinearised where one
    pass does not do. Values are NaN where the residuals are not finite.
    """
    from scipy.optimize import nnls

    values = np.zeros(units.size)
    for _ in range(PASSES):
        residual, *moved = residuals(values + np.vstack([np.zeros(units.size), np.diag(units)]))
        columns = (np.array(moved) - residual).T
        if not np.isfinite(columns).all():
            nothing = np.full(units.size, np.nan)
            return LinearSolution(nothing, columns, np.zeros((0, units.size)), residual, units)
        sizes = np.linalg.norm(columns, axis=0)
        seen = sizes > LEAST * sizes.max(initial=0)
        columns[:, ~seen] = 0
        prior = bends(np.where(seen, sizes, 0), curves, weight)
        q, r = np.linalg.qr(columns[:, seen] / sizes[seen])
        target = q.T @ (columns @ (values / units) - residual)
        system = np.vstack([r, prior[:, seen] / sizes[seen]])
        shares = np.zeros(units.size)
        shares[seen] = nnls(system, np.append(target, np.zeros(len(prior))), maxiter=100 * units.size)[0] / sizes[seen]
        expected = residual + columns @ (shares - values / units)
        values = shares * units
        residual = residuals(values[None])[0]
        if np.linalg.norm(residual - expected) <= STRAIGHT * np.linalg.norm(expected):
            break
    return LinearSolution(values, columns, prior, residual, units)


def bends(sizes: Array, curves: Sequence[Whole], weight: float) -> Array:
    """Rows of the second differences along each curve, as large as a typical column that is seen."""
    rows = [np.zeros((0, sizes.size))]
    for places in curves:
        own = np.zeros((max(places.size - 2, 0), sizes.size))
        own[:, places] = np.diff(np.eye(places.size), 2, axis=0)
        shown = sizes[places][sizes[places] > 0]
        rows.append(np.sqrt(weight) * (np.median(shown) if shown.size else 0.0) * own)
    return np.vstack(rows)
