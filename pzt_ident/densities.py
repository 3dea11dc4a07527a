"""The density of the coercive fields without a form: free weights of the homogenized energy model's plays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pzt_ident.errors import InputError
from pzt_ident.record import Record

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Density:
    """y = gain E + sum_i weights_i (2 Phi(F_i[E] / interaction) - 1) + an offset a record; SI units.

    weights: (nodes,), NaN where no record moved the play of that coercive field, so that the data say nothing of it.
    rmse: over all records. unmoved: the coercive fields of those nodes.
    """

    interaction: float
    gain: float
    coercive: Array
    weights: Array
    rmse: float

    @property
    def unmoved(self) -> Array:
        return self.coercive[np.isnan(self.weights)]


def density_of(
    records: Sequence[Record],
    coercive: Array,
    interaction: tuple[float, float],
    smoothness: float = 0.0,
    axis: int = 0,
    poled: float = 0.0,
) -> Density:
    """The density of one axis by non-negative least squares inside a search over the width of the interaction field.

    The plays do not depend on the weights, so the model is linear in gain and weights (Smith et al., eqs. 12 and 15).
    coercive: (nodes,) rising, V or V/m as the drive. interaction: between which its width is searched. smoothness: of
    the squared second difference of the weights, over the squares of the errors where every weight is alike.
    Raises InputError where no play moves: the drive stays in the linear range.
    """
    memories = [plays(record.drive[axis], coercive, poled) for record in records]
    moved = np.any([np.ptp(memory, axis=0) > 0 for memory in memories], axis=0)
    if not moved.any():
        span = max(float(np.ptp(record.drive[axis])) for record in records)
        problem = f"a drive of {span:.3g} peak to peak moves no play of {coercive.min():.3g} and more"
        raise InputError(problem, where=records[0].name, remedy="drive further, or give smaller coercive fields")
    solve = _Solver([record.drive[axis] for record in records], [record.response[axis] for record in records])
    found = _narrowed(lambda width: solve([memory[:, moved] for memory in memories], width, smoothness), interaction)
    width, (solution, rmse) = found
    weights = np.full(coercive.size, np.nan)
    weights[moved] = solution[1:]
    return Density(width, float(solution[0]), coercive, weights, rmse)


def plays(drive: Array, coercive: Array, poled: float) -> Array:
    """p <- max(E - Ec, min(E + Ec, p)) of every node, from the virgin state by way of `poled`: (samples, nodes)."""
    memory = np.clip(0.0, poled - coercive, poled + coercive)
    found = np.empty((drive.size, coercive.size))
    for k, field in enumerate(drive):
        memory = np.maximum(field - coercive, np.minimum(field + coercive, memory))
        found[k] = memory
    return found


class _Solver:
    """Non-negative gain and weights; the offset of each record is taken out of all columns."""

    def __init__(self, drives: Sequence[Array], responses: Sequence[Array]) -> None:
        self.drives = drives
        self.response = np.concatenate([y - y.mean() for y in responses])

    def __call__(self, memories: Sequence[Array], width: float, smoothness: float) -> tuple[Array, float]:
        from scipy.optimize import nnls
        from scipy.special import erf

        parts = [
            np.column_stack([u, erf(p / (np.sqrt(2) * width))]) for u, p in zip(self.drives, memories, strict=True)
        ]
        columns = np.vstack([part - part.mean(axis=0) for part in parts])
        scale = np.linalg.norm(columns, axis=0)
        q, r = np.linalg.qr(columns / scale)
        curve = np.diff(np.eye(scale.size - 1), 2, axis=0) / scale[1:]
        prior = np.sqrt(smoothness) * np.median(scale[1:]) * np.hstack([np.zeros((len(curve), 1)), curve])
        target = np.concatenate([q.T @ self.response, np.zeros(len(prior))])
        solution = nnls(np.vstack([r, prior]), target)[0] / scale
        left = self.response - columns @ solution
        return solution, float(np.sqrt(np.mean(left**2)))


def _narrowed(solve, between: tuple[float, float]):  # type: ignore[no-untyped-def]
    """The width of least RMSE, over its logarithm, and what was solved there."""
    from scipy.optimize import minimize_scalar

    ends = tuple(np.log(between))
    best = minimize_scalar(lambda z: solve(float(np.exp(z)))[1], bounds=ends, method="bounded", options={"xatol": 1e-3})
    width = float(np.exp(best.x))
    return width, solve(width)
