"""The free offset of a record and the disturbances that add to its response, solved for in closed form."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from pzt_ident.engine.program import Program
from pzt_ident.model.block import TILES

Array = NDArray[np.float64]

SURE = 1e-8  # share of a sum of squares that is left, and still has half of its digits


class Additions:
    """The offset and the additions of a model on one record: y = x + a_0 + sum_i a_i b_i(t), with the amounts a from
    least squares over the scored samples. follow: by measured axis (n, samples), signals that are subtracted as well.
    """

    def __init__(self, program: Program, follow: Mapping[int, Array] | None = None) -> None:
        self.program, self.model, self.record = program, program.model, program.record
        self.follow = follow or {}
        self.signals = sum(block.amounts() for block in self.model.additions)
        pairs = (self.signals + 1) * (self.signals + 2) // 2
        self.tiles = 1 + self.signals if self.signals else 0
        self.sums = 2 + self.tiles + pairs if self.signals else 0

    def steps(self, axis: int) -> list[tuple[int, ...]]:
        """Rows for the kernel that make the signals of an axis."""
        return [(self.program.address(item), item.row, 0, item.tile, 0) for item in self.program.additions[axis]]

    def begin(self, sums: Array) -> None:
        """Say to kernel.products where the signals are; sums: (groups, its rows of all measured axes, lanes)."""
        for i, axis in enumerate(self.model.measured if self.signals else ()):
            sums[:, i * self.sums] = self.signals
            sums[:, i * self.sums + 1] = self.program.tiles - TILES * axis

    def remove(self, error: Array, theta: Array) -> None:
        """Subtract them from the errors (candidates, measured axes, samples), in place; NaN if they are not finite."""
        from pzt_ident.engine.kernel import WIDTH

        if not self.model.additions and not self.follow:
            error -= error[:, :, self.record.settle :].mean(axis=2, keepdims=True)
            return
        for i, axis in enumerate(self.model.measured):
            groups = self.groups(axis, theta)
            for begin in range(0, len(groups), WIDTH):
                several = groups[begin : begin + WIDTH]
                for same, basis in zip(several, self.bases(axis, theta[[same[0] for same in several]]), strict=True):
                    self._project(error, same, i, basis.T)

    def groups(self, axis: int, theta: Array) -> list[NDArray[np.intp]]:
        """The candidates that have the same signals on an axis, group by group."""
        if not self.signals:
            return [np.arange(len(theta))]
        entries = enumerate(self.model.entries)
        columns = [i for i, entry in entries if entry.axis == axis and entry.block in self.model.additions]
        distinct, index = np.unique(theta[:, columns], axis=0, return_inverse=True)
        return [np.flatnonzero(index.ravel() == number) for number in range(len(distinct))]

    def _project(self, error: Array, candidates: NDArray[np.intp], i: int, basis: Array) -> None:
        """Subtract the least-squares fit of the basis from the errors of measured axis i, in place."""
        size = np.linalg.norm(basis, axis=0)
        if not np.isfinite(size).all():
            error[candidates, i] = np.nan
            return
        basis /= np.where(size > 0, size, 1)
        scored = basis[self.record.settle :]
        inverse = np.linalg.pinv(scored.T @ scored, rcond=1e-12)
        for _ in range(2):  # the second pass removes the rounding of the first
            residual = error[candidates, i, self.record.settle :].T
            error[candidates, i] -= (basis @ (inverse @ (scored.T @ residual))).T

    def squares(self, sums: Array, scored: int) -> tuple[Array, NDArray[np.bool_]]:
        """Sums of squared errors from the sums of kernel.products, (candidates, measured axes, sums): (candidates,
        measured axes), and of which candidates rounding leaves enough digits."""
        with np.errstate(all="ignore"):
            table = self._table(sums, scored)
            raw = np.diagonal(table, axis1=-2, axis2=-1).copy()
            sure = np.ones(len(sums), dtype=bool)
            for k in range(table.shape[-1] - 1, -1, -1):  # each signal is taken out of the others, the error is left
                pivot, column = table[..., k, k].copy(), table[..., k].copy()
                sure &= ~((pivot < SURE * raw[..., k]) & (raw[..., k] > 0)).any(axis=1)
                if k > 0:
                    table -= column[..., None] * (column / np.where(pivot > 0, pivot, 1)[..., None])[..., None, :]
            return pivot, sure

    def _table(self, sums: Array, scored: int) -> Array:
        """Products of the error, the signals and the offset: (candidates, measured axes, 2 + signals, 2 + signals)."""
        table, row = np.full((*sums.shape[:2], self.tiles + 1, self.tiles + 1), float(scored)), 2
        for k in range(self.tiles):
            table[..., k, -1] = table[..., -1, k] = sums[..., row]
            table[..., k, : k + 1] = table[..., : k + 1, k] = sums[..., row + 1 : row + 2 + k]
            row += 2 + k
        return table

    def sizes(self, residual: Array, theta: Array) -> dict[str, Array]:
        """Standard deviation over time of each addition with one candidate, SI units: by name of the effect, (measured
        axes,). residual: measurement minus simulation, (measured axes, samples)."""
        sizes = {block.name: np.zeros(len(residual)) for block in self.model.additions}
        owners = ["", *(block.name for block in self.model.additions for _ in range(block.amounts()))]
        for i, axis in enumerate(self.model.measured if sizes else ()):
            basis = self.basis(axis, np.atleast_2d(theta)[0])[self.record.settle :]
            amounts = np.linalg.lstsq(basis, residual[i, self.record.settle :], rcond=1e-12)[0]
            for name in sizes:
                columns = [owner == name for owner in owners]
                sizes[name][i] = np.std(basis[:, columns] @ amounts[columns])
        return sizes

    def basis(self, axis: int, theta: Array) -> Array:
        """Ones and the signals of an axis with one candidate: (samples, signals)."""
        return self.bases(axis, np.atleast_2d(theta))[0].T

    def count(self, axis: int) -> int:
        """Number of signals of an axis, the ones included."""
        return 1 + self.signals + len(self.follow.get(axis, ()))

    def stretch(self, axis: int, theta: Array, at: slice) -> Array:
        """Ones and the signals of an axis at some samples: (signals, samples)."""
        return self.bases(axis, np.atleast_2d(theta), at)[0]

    def bases(self, axis: int, theta: Array, at: slice | None = None) -> Array:
        """Ones and the signals with many candidates, at some samples or all: (candidates, signals, samples)."""
        from pzt_ident.engine.kernel import TILE, run

        at = at or slice(0, self.record.samples)
        bases = np.ones((len(theta), self.count(axis), at.stop - at.start))
        if self.follow:
            bases[:, 1 + self.signals :] = self.follow[axis][:, at]
        if self.signals:
            program, lead = self.program, self.program.lead
            steps, tiles = np.array(self.steps(axis), dtype=np.int64), program.tiles + 1 + np.arange(self.signals)
            begin, since, count = (lead + at.start) // TILE * TILE, lead + at.start, program.tiles + self.tiles
            scratch, output = program.scratch(theta, program.rows), np.empty_like(bases[:, 1 : 1 + self.signals])
            run(steps, np.zeros((1, 1)), scratch, len(theta), count, begin, lead + at.stop, since, 1, output, tiles)
            bases[:, 1 : 1 + self.signals] = output
        return bases
