"""Parameters in which the response is linear, solved for inside the search instead of being searched."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pzt_ident.model.chain import Chain

Array = NDArray[np.float64]
Indices = NDArray[np.intp]
Changes = Callable[[Array], Array]  # (candidates, ...) -> (rows, candidates)

MAX_PASSES = 4  # of linearisation, where a block behind makes the response nonlinear
STEPS = np.array([1, 1 / 2, 1 / 4, 1 / 8, 0])  # of the way to a solution, the best of which is taken
ROUGH = 2  # passes, after which candidates are told from each other
LINEAR = 1e-9  # of the residual: the error of prediction below which no further pass is needed
NEGLIGIBLE = 1e-6  # of the largest column: below it a column is rounding
SOLUTIONS, VALUES = 4, 4096  # that are kept: whole ones, and their values


class LinearSolution(NamedTuple):
    """values: (linear,), zero for a parameter that no record depends on. columns: (rows, linear), change of the
    residual by one unit of each parameter, zero there too. prior: (n, linear), rows of the smoothness prior. units:
    (linear,), see `Linear`."""

    values: Array
    columns: Array
    prior: Array
    units: Array


@dataclass(frozen=True)
class Tangent:
    """How what is solved for follows to first order beside a point, where what is zero stays zero: as least squares
    with its prior take a change of the residual away.

    values: by name, in SI units. theta: parameters of the model by name, at the point and beside it by a unit of each
    value that is not zero: (1 + active,). prior: (n, active). residual: (samples,), there, and basis: (samples,
    active), see `basis_of`, where `follow` is asked for.
    """

    values: Mapping[str, float]
    theta: Mapping[str, Array]
    prior: Array
    residual: Array | None = None
    basis: Array | None = None

    @classmethod
    def of(cls, model: Chain, linear: Linear, row: Array) -> Tangent:
        """row: (parameters,), the point."""
        solution = linear.solved(row)
        active = np.flatnonzero(solution.values)
        theta = np.tile(row, (1 + active.size, 1))
        theta[1 + np.arange(active.size), linear.columns[active]] += solution.units[active]
        names = model.names
        values = dict(zip([names[i] for i in linear.columns], solution.values.tolist(), strict=True))
        return cls(values, dict(zip(names, theta.T, strict=True)), solution.prior[:, active])

    def of_samples(self, residuals: Array) -> Tangent:
        """One that can `follow`. residuals: (1 + active, samples), of `theta`."""
        basis = basis_of((residuals[1:] - residuals[0]).T, self.prior)
        return replace(self, residual=residuals[0], basis=basis)

    def follow(self, residuals: Array) -> Array:
        """Residuals (candidates, samples) with these values, as they are once the values have followed."""
        assert self.residual is not None and self.basis is not None
        return residuals - ((residuals - self.residual) @ self.basis) @ self.basis.T

    def beside(self, model: Chain, theta: Array) -> Array:
        """The candidates of the tangent ahead of others: (1 + active + candidates, parameters). The model may have more
        blocks than that of the tangent, which are at their null in it."""
        own = np.empty((1 + self.prior.shape[1], len(model.names)))
        for i, entry in enumerate(model.entries):
            null = entry.parameter.null
            own[:, i] = self.theta[entry.name] if entry.name in self.theta else theta[0, i] if null is None else null
        return np.vstack([own, theta])

    def beside_weights(self, weights: Array) -> Array:
        """Those of the residual and the columns ahead of others."""
        own = 1 + self.prior.shape[1]
        both = np.zeros(np.add(weights.shape, own))
        both[:own, :own], both[own:, own:] = differences(own), weights
        return both

    def followed(self, rows: Array, weights: Array) -> Array:
        """Combinations as of `follow`, from rows (rows, 1 + active + combinations) of what is `beside`."""
        residual, columns, others = self._parts(rows)
        basis = basis_of(columns, self.prior)
        return np.asarray(others - basis @ (basis.T @ (others - np.outer(residual, weights.sum(axis=1)))))

    def amounts(self, rows: Array, weights: Array) -> Array:
        """Of the columns in what `followed` takes away: (active, combinations)."""
        residual, columns, others = self._parts(rows)
        changes = others - np.outer(residual, weights.sum(axis=1))
        held = np.vstack([changes, np.zeros((len(self.prior), len(weights)))])
        return np.asarray(np.linalg.lstsq(np.vstack([columns, self.prior]), held, rcond=None)[0])

    def _parts(self, rows: Array) -> tuple[Array, Array, Array]:
        active = self.prior.shape[1]
        return rows[:, 0], rows[:, 1 : 1 + active], rows[:, 1 + active :]


def basis_of(columns: Array, prior: Array) -> Array:
    """Upper rows of an orthonormal basis of columns (rows, active) and their prior: least squares take basis basis' of
    a signal away."""
    stacked = np.vstack([columns, prior])
    return np.asarray(np.linalg.qr(stacked / np.linalg.norm(stacked, axis=0))[0][: len(columns)])


def differences(candidates: int) -> Array:
    """Weights of the first candidate, and of the difference of each other from it: (candidates, candidates)."""
    weights = np.eye(candidates)
    weights[1:, 0] = -1
    return weights


class Linear:
    """The columns of theta that are solved for, as a function of the other columns.

    changes: theta (candidates, parameters) -> (rows, candidates), the residual of the first and how that of each other
    differs from it, rotated so that a few rows are left. units: (linear,), a change of each parameter that is small
    beside its typical size, with the sign that it may have. passes: of linearisation, at most. beside: a candidate and
    its solution, from whose values those of others are sought.
    """

    def __init__(
        self,
        model: Chain,
        columns: Sequence[int] | Indices,
        units: Array,
        changes: Changes,
        passes: int = MAX_PASSES,
        beside: tuple[bytes, LinearSolution] | None = None,
    ) -> None:
        self.columns = np.array(columns, dtype=int)
        self.model, self.units, self.passes, self._changes, self._beside = model, units, passes, changes, beside
        self._solved = lru_cache(SOLUTIONS)(self._solve)
        self._values = lru_cache(VALUES)(lambda raw: self._solved(raw).values)
        entries = [model.entries[column] for column in columns]
        names = [f"{entry.axis} {entry.parameter.name}" if entry.parameter.smooth else "" for entry in entries]
        self._curves = [np.flatnonzero(np.array(names) == name) for name in dict.fromkeys(names) if name]
        firsts = [entries[curve[0]] for curve in self._curves]
        self._weights = [
            (model.columns(entry.block, entry.axis, entry.axis) or {})[str(entry.parameter.smooth)] for entry in firsts
        ]

    def rough(self) -> Linear:
        """Those whose solution ends as soon as it tells candidates from each other."""
        return Linear(self.model, self.columns, self.units, self._changes, ROUGH)

    def begun_at(self, row: Array, changes: Changes) -> Linear:
        """Those that are sought from the solution of a candidate, in fewer passes."""
        beside = self._key(row), self.solved(row)
        return Linear(self.model, self.columns, self.units, changes, ROUGH, beside)

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

        def changes(values: Array) -> Array:
            theta = np.tile(row, (len(values), 1))
            theta[:, self.columns] = values
            return self._changes(theta)

        def begin() -> Array:
            return self.solved(plain).values

        if self._beside is not None:
            place, solution = self._beside
            if raw == place or not np.isfinite(solution.values).all():
                return solution
            return solve(changes, self.units, self._curves, row[self._weights], self.passes, first=solution.values)
        plain = self._without_effects(row)
        bends = None if self._key(plain) == raw else begin
        return solve(changes, self.units, self._curves, row[self._weights], self.passes, bends)

    def _without_effects(self, row: Array) -> Array:
        nulls = [entry.parameter.null for entry in self.model.entries]
        return np.array([value if null is None else null for value, null in zip(row, nulls, strict=True)])


def solve(
    changes: Changes,
    units: Array,
    curves: Sequence[Indices],
    weights: ArrayLike,
    passes: int = MAX_PASSES,
    begin: Callable[[], Array] | None = None,
    first: Array | None = None,
) -> LinearSolution:
    """Non-negative least squares in multiples of `units`, with squared second differences as a smoothness prior.

    changes, units: as of `Linear`. curves: indices of the parameters of each smooth curve, in order. weights: of the
    squared second differences of each curve relative to the squared errors. Lawson & Hanson (1974), Solving Least
    Squares Problems, ch. 23; linearised again, `passes` in all, where the response is not linear, which half of a step
    tells, and how much is left after it, from the best place on the way there. The first pass begins at `first`, by
    default at zero, where a cyclic error is a slope; the next one at the values of `begin` if these leave less. Values
    are NaN where the residuals are not finite.
    """
    values = np.zeros(units.size) if first is None else first
    for number in range(passes):
        residual, columns = np.split(changes(values + np.vstack([np.zeros(units.size), np.diag(units)])), [1], axis=1)
        if not np.isfinite(columns).all():
            unknown = np.full(units.size, np.nan)
            return LinearSolution(unknown, columns, np.zeros((0, units.size)), units)
        sizes = np.linalg.norm(columns, axis=0)
        visible = sizes > NEGLIGIBLE * sizes.max(initial=0)
        columns[:, ~visible] = 0
        prior = second_differences(np.where(visible, sizes, 0), curves, np.asarray(weights))
        multiples = non_negative(columns, columns @ (values / units) - residual[:, 0], prior, visible)
        expected = np.linalg.norm(residual[:, 0] + columns @ (multiples - values / units))
        tried = values + STEPS[:, None] * (multiples * units - values)
        changed = changes(tried).T
        left = norms_of(changed)
        values = tried[np.argmin(np.hypot(left, np.linalg.norm((tried / units) @ prior.T, axis=1)))]
        bend = np.linalg.norm(2 * changed[1] - changed[-1])
        if 2 * bend <= LINEAR * expected and abs(left[0] - expected) <= LINEAR * expected:
            break
        if number == 0 and begin is not None:
            both = np.array([values, begin()])
            values = both[int(np.nan_to_num(norms_of(changes(both).T), nan=np.inf).argmin())]
    return LinearSolution(values, columns, prior, units)


def non_negative(columns: Array, target: Array, prior: Array, visible: NDArray[np.bool_]) -> Array:
    """Multiples of the columns, (rows, linear), that lead next to a target, (rows,), and keep to a prior; zero of those
    that are not visible."""
    from scipy.optimize import nnls

    multiples = np.zeros(visible.size)
    if not visible.any():
        return multiples
    sizes = np.linalg.norm(columns[:, visible], axis=0)
    triangle = np.asarray(np.linalg.qr(np.column_stack([columns[:, visible] / sizes, target]), mode="r"))
    system = np.vstack([triangle[:, :-1], prior[:, visible] / sizes])
    rows = np.append(triangle[:, -1], np.zeros(len(prior)))
    multiples[visible] = nnls(system, rows, maxiter=100 * visible.size)[0] / sizes
    return multiples


def norms_of(changed: Array) -> Array:
    """Of the residual of a first candidate, and of those of others that are given as how they differ from it."""
    return np.linalg.norm(np.vstack([changed[:1], changed[:1] + changed[1:]]), axis=1)


def second_differences(sizes: Array, curves: Sequence[Indices], weights: Array) -> Array:
    """Rows of the second differences along each curve, (n, linear), scaled by the median of the visible columns."""
    rows = [np.zeros((0, sizes.size))]
    for curve, weight in zip(curves, weights, strict=True):
        differences = np.zeros((max(curve.size - 2, 0), sizes.size))
        differences[:, curve] = np.diff(np.eye(curve.size), 2, axis=0)
        visible = sizes[curve][sizes[curve] > 0]
        rows.append(np.sqrt(weight) * (np.median(visible) if visible.size else 0.0) * differences)
    return np.vstack(rows)
