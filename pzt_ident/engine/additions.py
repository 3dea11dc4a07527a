"""The free offset of a record and the disturbances that add to its response, solved for in closed form."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.record import Record
from pzt_ident.model.block import Block, argument_names
from pzt_ident.model.chain import Chain

Array = NDArray[np.float64]


class Additions:
    """The offset and the additions of a model on one record: y = x + a_0 + sum_i a_i b_i(t), with the amounts a from
    least squares over the scored samples."""

    def __init__(self, model: Chain, record: Record) -> None:
        self.model, self.record = model, record

    def remove(self, error: Array, theta: Array) -> None:
        """Subtract them from the errors (candidates, measured axes, samples), in place; NaN if they are not finite."""
        settle = self.record.settle
        if not self.model.additions:
            error -= error[:, :, settle:].mean(axis=2, keepdims=True)
            return
        for i, axis in enumerate(self.model.measured):
            of_additions = [entry.axis == axis and entry.block in self.model.additions for entry in self.model.entries]
            distinct, index = np.unique(theta[:, of_additions], axis=0, return_inverse=True)
            for number in range(len(distinct)):
                same = np.flatnonzero(index.ravel() == number)
                self._project(error, same, i, self.basis(axis, theta[same[0]]))

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

    def sizes(self, residual: Array, theta: Array) -> dict[str, Array]:
        """Standard deviation over time of each addition with one candidate, SI units: by name of the effect, (measured
        axes,). residual: measurement minus simulation, (measured axes, samples)."""
        sizes = {block.name: np.zeros(len(residual)) for block in self.model.additions}
        for i, axis in enumerate(self.model.measured):
            candidate, settle = np.atleast_2d(theta)[0], self.record.settle
            basis = self.basis(axis, candidate)[settle:]
            amounts = np.linalg.lstsq(basis, residual[i, settle:], rcond=1e-12)[0]
            owners = ["", *(b.name for b in self.model.additions for _ in self._signals_of(b, axis, candidate))]
            for name in sizes:
                columns = [owner == name for owner in owners]
                sizes[name][i] = np.std(basis[:, columns] @ amounts[columns])
        return sizes

    def basis(self, axis: int, theta: Array) -> Array:
        """Ones and the signals of all additions of an axis: (samples, 1 + signals)."""
        additions = [self._signals_of(block, axis, theta) for block in self.model.additions]
        return np.array([np.ones(self.record.samples), *(signal for signals in additions for signal in signals)]).T

    def _signals_of(self, addition: type[Block], axis: int, theta: Array) -> tuple[Array, ...]:
        columns = self.model.columns(addition, axis, axis) or {}
        words = argument_names(addition.basis)[1:]  # type: ignore[attr-defined]
        signals: tuple[Array, ...] = addition.basis(self.record.time, *(theta[columns[word]] for word in words))  # type: ignore[attr-defined]
        return signals
