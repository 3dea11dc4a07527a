"""What adds to the response of a record in amounts of that record's own: taken in closed form, together with the free
offset."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.record import Record
from pzt_ident.model.block import Block, asked
from pzt_ident.model.chain import Chain

Array = NDArray[np.float64]


class Additions:
    """The offset and the additions of a model on one record: y = x + a_0 + sum_i a_i b_i(t), the amounts a those of
    least squares over the scored samples."""

    def __init__(self, model: Chain, record: Record) -> None:
        self.model, self.record = model, record

    def remove(self, error: Array, theta: Array) -> None:
        """Take them out of the errors (candidates, measured axes, samples); NaN where they are not finite."""
        settle = self.record.settle
        if not self.model.additions:
            error -= error[:, :, settle:].mean(axis=2, keepdims=True)
            return
        for i, axis in enumerate(self.model.measured):
            shapes = [entry.axis == axis and entry.block in self.model.additions for entry in self.model.entries]
            kinds, which = np.unique(theta[:, shapes], axis=0, return_inverse=True)
            for kind in range(len(kinds)):
                same = np.flatnonzero(which.ravel() == kind)
                self._project(error, same, i, self.basis(axis, theta[same[0]]))

    def _project(self, error: Array, candidates: NDArray[np.intp], i: int, basis: Array) -> None:
        size = np.linalg.norm(basis, axis=0)
        if not np.isfinite(size).all():
            error[candidates, i] = np.nan
            return
        basis /= np.where(size > 0, size, 1)
        scored = basis[self.record.settle :]
        inverse = np.linalg.pinv(scored.T @ scored, rcond=1e-12)
        for _ in range(2):  # the second time takes back the rounding of the first
            residual = error[candidates, i, self.record.settle :].T
            error[candidates, i] -= (basis @ (inverse @ (scored.T @ residual))).T

    def sizes(self, left: Array, theta: Array) -> dict[str, Array]:
        """What each addition puts into the record with one candidate, root mean square about its mean, SI units: by
        name of the effect, (measured axes,). left: measurement minus simulation, (measured axes, samples)."""
        sizes = {block.name: np.zeros(len(left)) for block in self.model.additions}
        for i, axis in enumerate(self.model.measured):
            candidate, settle = np.atleast_2d(theta)[0], self.record.settle
            basis = self.basis(axis, candidate)[settle:]
            amounts = np.linalg.lstsq(basis, left[i, settle:], rcond=1e-12)[0]
            owners = ["", *(b.name for b in self.model.additions for _ in self._signals_of(b, axis, candidate))]
            for name in sizes:
                its_own = [owner == name for owner in owners]
                sizes[name][i] = np.std(basis[:, its_own] @ amounts[its_own])
        return sizes

    def basis(self, axis: int, theta: Array) -> Array:
        """One, and the signals of all additions of an axis: (samples, signals)."""
        additions = [self._signals_of(block, axis, theta) for block in self.model.additions]
        return np.array([np.ones(self.record.samples), *(signal for signals in additions for signal in signals)]).T

    def _signals_of(self, addition: type[Block], axis: int, theta: Array) -> tuple[Array, ...]:
        columns = self.model.columns(addition, axis, axis) or {}
        words = asked(addition.basis)[1:]  # type: ignore[attr-defined]
        signals: tuple[Array, ...] = addition.basis(self.record.time, *(theta[columns[word]] for word in words))  # type: ignore[attr-defined]
        return signals
