"""Parameters in which the response is linear, solved for inside the search instead of being searched."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pzt_ident.model.chain import Chain

Array = NDArray[np.float64]
Indices = NDArray[np.intp]
Residuals = Callable[[Array], Array]

MAX_PASSES = 4  # of linearisation, where a block behind makes the response nonlinear
LINEAR = 1e-9  # of the residual: the error of prediction below which no further pass is needed
NEGLIGIBLE = 1e-6  # of the largest column: below it a column is rounding
SOLUTIONS, VALUES = 4, 4096  # that are kept: whole ones, each as large as all columns, and their values


class LinearSolution(NamedTuple):
    """values: (linear,), zero for a parameter that no record depends on. columns: (samples, linear), change of the
    residual by one unit of each parameter, zero there too. prior: (n, linear), rows of the smoothness prior. residual:
    (samples,). units: (linear,), see `Linear`."""

    values: Array
    columns: Array
    prior: Array
    residual: Array
    units: Array


@dataclass(frozen=True)
class Tangent:
    """How what is solved for follows to first order beside a point, where what is zero stays zero.

    values: by name, in SI units. residual: (samples,), there. basis: (samples, active), upper rows of an orthonormal
    basis of the columns and their prior: least squares take basis basis' of a change of the residual away.
    """

    values: Mapping[str, float]
    residual: Array
    basis: Array

    @classmethod
    def of(cls, names: Sequence[str], solution: LinearSolution) -> Tangent:
        stacked = np.vstack([solution.columns, solution.prior])[:, solution.values != 0]
        basis = np.linalg.qr(stacked / np.linalg.norm(stacked, axis=0))[0][: len(solution.columns)]
        return cls(dict(zip(names, solution.values.tolist(), strict=True)), solution.residual, basis)

    def follow(self, residuals: Array) -> Array:
        """Residuals (candidates, samples) with these values, as they are once the values have followed."""
        return residuals - ((residuals - self.residual) @ self.basis) @ self.basis.T


class Linear:
    """The columns of theta that are solved for, as a function of the other columns.

    residuals: theta (candidates, parameters) -> (candidates, samples). units: (linear,), typical size of each parameter
    with the sign that it may have.
    """

    def __init__(self, model: Chain, columns: Sequence[int], units: Array, residuals: Residuals) -> None:
        self.columns = np.array(columns, dtype=int)
        self.units, self._residuals = units, residuals
        self._solved = lru_cache(SOLUTIONS)(self._solve)
        self._values = lru_cache(VALUES)(lambda raw: self._solved(raw).values)
        entries = [model.entries[column] for column in columns]
        names = [f"{entry.axis} {entry.parameter.name}" if entry.parameter.smooth else "" for entry in entries]
        self._curves = [np.flatnonzero(np.array(names) == name) for name in dict.fromkeys(names) if name]
        firsts = [entries[curve[0]] for curve in self._curves]
        self._weights = [
            (model.columns(entry.block, entry.axis, entry.axis) or {})[str(entry.parameter.smooth)] for entry in firsts
        ]

    def fill(self, theta: Array) -> None:
        """Write the solved values into theta (candidates, parameters), in place."""
        if self.columns.size:
            theta[:, self.columns] = [self._values(self._key(row)) for row in theta]

    def solved(self, row: Array) -> LinearSolution:
        """The solution for one candidate."""
        return self._solved(self._key(row))

    def _key(self, row: Array) -> bytes:
        """A candidate without its linear columns, on which the solution does not depend."""
        others = row.copy()
        others[self.columns] = 0
        return others.tobytes()

    def _solve(self, raw: bytes) -> LinearSolution:
        row = np.frombuffer(raw)

        def residuals(values: Array) -> Array:
            theta = np.tile(row, (len(values), 1))
            theta[:, self.columns] = values
            return self._residuals(theta)

        return solve(residuals, self.units, self._curves, row[self._weights])


def solve(residuals: Residuals, units: Array, curves: Sequence[Indices], weights: ArrayLike) -> LinearSolution:
    """Non-negative least squares in multiples of `units`, with squared second differences as a smoothness prior.

    residuals: (candidates, linear) -> (candidates, samples). units: (linear,), size and sign of each parameter. curves:
    indices of the parameters of each smooth curve, in order. weights: of the squared second differences of each curve
    relative to the squared errors. Lawson & Hanson (1974), Solving Least Squares Problems, ch. 23; linearised again
    where the response is not linear. Values are NaN where the residuals are not finite.
    """
    from scipy.optimize import nnls

    values = np.zeros(units.size)
    for _ in range(MAX_PASSES):
        residual, *moved = residuals(values + np.vstack([np.zeros(units.size), np.diag(units)]))
        columns = (np.array(moved) - residual).T
        if not np.isfinite(columns).all():
            unknown = np.full(units.size, np.nan)
            return LinearSolution(unknown, columns, np.zeros((0, units.size)), residual, units)
        sizes = np.linalg.norm(columns, axis=0)
        visible = sizes > NEGLIGIBLE * sizes.max(initial=0)
        columns[:, ~visible] = 0
        prior = second_differences(np.where(visible, sizes, 0), curves, np.asarray(weights))
        scaled = np.column_stack([columns[:, visible] / sizes[visible], columns @ (values / units) - residual])
        triangle = np.asarray(np.linalg.qr(scaled, mode="r"))
        system = np.vstack([triangle[:, :-1], prior[:, visible] / sizes[visible]])
        multiples = np.zeros(units.size)
        solution = nnls(system, np.append(triangle[:, -1], np.zeros(len(prior))), maxiter=100 * units.size)[0]
        multiples[visible] = solution / sizes[visible]
        expected = residual + columns @ (multiples - values / units)
        values = multiples * units
        residual = residuals(values[None])[0]
        if np.linalg.norm(residual - expected) <= LINEAR * np.linalg.norm(expected):
            break
    return LinearSolution(values, columns, prior, residual, units)


def second_differences(sizes: Array, curves: Sequence[Indices], weights: Array) -> Array:
    """Rows of the second differences along each curve, (n, linear), scaled by the median of the visible columns."""
    rows = [np.zeros((0, sizes.size))]
    for curve, weight in zip(curves, weights, strict=True):
        differences = np.zeros((max(curve.size - 2, 0), sizes.size))
        differences[:, curve] = np.diff(np.eye(curve.size), 2, axis=0)
        visible = sizes[curve][sizes[curve] > 0]
        rows.append(np.sqrt(weight) * (np.median(visible) if visible.size else 0.0) * differences)
    return np.vstack(rows)
