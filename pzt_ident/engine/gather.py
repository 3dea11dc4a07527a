"""Inner products of errors, gathered stretch by stretch of the samples: nothing of samples x candidates is kept.

The triangle R of columns A = Q R has their inner products, A' A = R' R, which are the matrix of the normal equations,
and without squaring its condition: what is done with the columns by rotations alone may be done with R instead. It
grows by a stretch of rows at a time (Golub & Van Loan 2013, section 6.5; LAPACK's tpqrt).
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from pzt_ident.libraries import extension

if TYPE_CHECKING:
    from pzt_ident.engine.simulator import Simulator

Array = NDArray[np.float64]

lapack = extension("scipy.linalg", "_flapack")

BLOCK = 8  # columns that LAPACK takes together
DEPENDENT = 1e-6  # of the largest singular value: signals of additions are the same direction below


class Triangle:
    """R of columns whose rows come stretch by stretch: `r`, (columns, columns)."""

    def __init__(self, columns: int) -> None:
        self.r = np.zeros((columns, columns), order="F")

    def add(self, rows: Array) -> tuple[Array, Array]:
        """Take up (columns, samples), which is overwritten; returns the reflectors, as tpqrt has them."""
        if not rows.size:
            return np.zeros((0, 0)), np.zeros((0, 0))
        block = min(BLOCK, len(self.r))
        self.r, reflectors, factors, _ = lapack.dtpqrt(0, block, self.r, rows.T, overwrite_a=1, overwrite_b=1)
        return reflectors, factors


class Remainder:
    """Squared norms of signals (candidates,) without their projection on a basis: `squares`."""

    def __init__(self, basis: int, candidates: int) -> None:
        self.basis, self.inside = Triangle(basis), np.zeros((basis, candidates), order="F")
        self.outside = np.zeros(candidates)

    def add(self, basis: Array, signals: Array) -> None:
        """Take up (signals of the basis, samples) and (candidates, samples), which are overwritten."""
        reflectors, factors = self.basis.add(basis)
        self.inside, rest, _ = lapack.dtpmqrt(
            0, reflectors, factors, self.inside, signals.T, trans="T", overwrite_a=1, overwrite_b=1
        )
        self.outside += np.einsum("sm,sm->m", rest, rest)

    @property
    def squares(self) -> Array:
        """NaN where the basis is not finite."""
        return self.outside + np.square(without(self.basis.r, self.inside)).sum(axis=0)

    @property
    def amounts(self) -> Array:
        """Of the basis in each signal: (signals of the basis, candidates)."""
        basis = self.basis.r
        size = np.linalg.norm(basis, axis=0)
        size[size == 0] = 1
        return np.asarray(np.linalg.pinv(basis / size, rcond=DEPENDENT) @ self.inside / size[:, None])


def without(basis: Array, signals: Array) -> Array:
    """Signals (rows, candidates) without their least-squares fit by a basis (rows, signals)."""
    if not np.isfinite(basis).all():
        return np.full_like(signals, np.nan)
    size = np.linalg.norm(basis, axis=0)
    u, s, _ = np.linalg.svd(basis / np.where(size > 0, size, 1), full_matrices=False)
    kept = u[:, s > DEPENDENT * s.max(initial=1e-300)]
    return np.asarray(signals - kept @ (kept.T @ signals))


def remainders(simulator: Simulator, theta: Array) -> list[list[tuple[NDArray[np.intp], Remainder]]]:
    """For each measured axis the candidates with the same signals of additions, and what these leave of the errors."""
    additions = simulator.additions
    groups = [
        [(group, Remainder(additions.count(axis), len(group))) for group in additions.groups(axis, theta)]
        for axis in simulator.model.measured
    ]
    for at, error in simulator.tiles(theta):
        for i, axis in enumerate(simulator.model.measured):
            for group, remainder in groups[i]:
                remainder.add(additions.stretch(axis, theta[group[0]], at), error[group, i])
    return groups


def squares(simulator: Simulator, theta: Array) -> Array:
    """Sum of squared errors without offset and additions: (candidates, measured axes)."""
    sums = np.empty((len(theta), len(simulator.model.measured)))
    for i, groups in enumerate(remainders(simulator, theta)):
        for group, remainder in groups:
            sums[group, i] = remainder.squares
    return sums


def stretches(simulator: Simulator, theta: Array) -> Iterator[tuple[int, Array]]:
    """Errors without offset and additions, stretch by stretch: the number of a measured axis, and its errors
    (candidates, samples)."""
    amounts = [[(group, part.amounts) for group, part in groups] for groups in remainders(simulator, theta)]
    for at, error in simulator.tiles(theta):
        for i, axis in enumerate(simulator.model.measured):
            for group, amount in amounts[i]:
                error[group, i] -= amount.T @ simulator.additions.stretch(axis, theta[group[0]], at)
            yield i, error[:, i]


def rotated(simulator: Simulator, theta: Array, weights: Array) -> tuple[list[Array], NDArray[np.bool_]]:
    """Combinations `weights`, (combinations, candidates), of the errors without offset and additions, rotated so that
    few rows are left: for each measured axis (rows, combinations). And which candidates failed: (candidates,); their
    errors are taken as zero."""
    fewer = simulator.distinct(theta)
    sums = [
        Rotated(simulator, axis, fewer.theta, weights @ fewer.chosen(i))
        for i, axis in enumerate(simulator.model.measured)
    ]
    failed = np.zeros((len(fewer.theta), len(sums)), dtype=bool)
    for at, error in simulator.deviations(fewer.theta):
        with np.errstate(all="ignore"):
            failed |= ~(np.einsum("mas,mas->ma", error, error) < np.inf)
        error[failed] = 0
        for i, axis in enumerate(sums):
            failed[:, i] |= axis.add(at, error[:, i])
    return [axis.combinations for axis in sums], np.asarray(fewer.of_candidates(failed).any(axis=1))


class Rotated:
    """Those of one axis. Errors that are combined and have the same signals of additions are combined sample by sample,
    before they are rotated; the others afterwards. Combinations of nothing are left out."""

    def __init__(self, simulator: Simulator, axis: int, theta: Array, weights: Array) -> None:
        self.additions, self.axis, self.theta = simulator.additions, axis, theta
        self.combined = np.asarray(weights.any(axis=1))
        self.weights = weights[self.combined]
        self.groups, self.count = self.additions.groups(axis, theta), self.additions.count(axis)
        self.alike = len(self.groups) == 1
        self.triangle = Triangle(len(self.groups) * self.count + len(self.weights if self.alike else theta))

    def add(self, at: slice, error: Array) -> NDArray[np.bool_]:
        """Take up the errors (candidates, samples) of a stretch; which candidates have signals that are not finite."""
        failed, rows = np.zeros(len(error), dtype=bool), np.empty((len(self.triangle.r), error.shape[1]))
        bases, errors = np.split(rows, [len(self.groups) * self.count])
        for group, basis in zip(self.groups, np.split(bases, len(self.groups)), strict=True):
            basis[:] = self.additions.stretch(self.axis, self.theta[group[0]], at)
            if not np.isfinite(basis.sum()):
                failed[group], basis[:] = True, 0
        if self.alike:
            np.matmul(self.weights, error, out=errors)
        else:
            errors[:] = error
        self.triangle.add(rows)
        return failed

    @property
    def combinations(self) -> Array:
        """(rows, combinations)"""
        combined = self._combined
        combinations = np.zeros((len(combined), len(self.combined)))
        combinations[:, self.combined] = combined
        return combinations

    @property
    def _combined(self) -> Array:
        bases, errors = np.split(self.triangle.r, [len(self.groups) * self.count], axis=1)
        if self.count == 1:
            return errors[1:]  # the ones alone have their row
        if self.alike:
            return without(bases, errors)
        of_groups = np.split(bases, len(self.groups), axis=1)
        for group, basis in zip(self.groups, of_groups, strict=True):
            errors[:, group] = without(basis, errors[:, group])
        return errors @ self.weights.T
