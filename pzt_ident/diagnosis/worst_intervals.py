"""The worst stretches of a residual."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.record import Record

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Interval:
    """From `start` to `end`, s, of a record: its RMSE, and its share of the misfit."""

    record: str
    start: float
    end: float
    rmse: float
    share: float


def worst_intervals(
    records: Sequence[Record], residuals: list[Array], noise: float, most: int = 5
) -> tuple[Interval, ...]:
    """The stretches, apart from each other, whose squared residual exceeds a level by the largest sum, the one with
    most of the misfit first; none has less than a hundredth of it. residuals: scored samples, (samples,) each.

    The level is half as much again as the mean square, or 0.6 of the mean square where the misfit is, if that is more.
    """
    local = [smooth(part**2, max(1, part.size // 200)) for part in residuals]
    squares = np.concatenate(local)
    level = max(1.5 * squares.mean(), 0.6 * (squares**2).sum() / squares.sum())
    total = sum(float((part**2).sum()) - noise**2 * part.size for part in residuals)
    found = []
    for record, part, own_square in zip(records, residuals, local, strict=True):
        for first, last in heaviest(own_square - level, most):
            own = part[first:last]
            share = (float((own**2).sum()) - noise**2 * own.size) / total
            start, end = record.time[record.settle + np.array([first, last - 1])].tolist()
            found.append(Interval(record.name, start, end, float(np.sqrt((own**2).mean())), share))
    return tuple(sorted((one for one in found if one.share >= 0.01), key=lambda one: -one.share)[:most])


def smooth(values: Array, width: int) -> Array:
    """Mean over `width` samples about each, as many as there are at the ends."""
    sums = np.concatenate([[0.0], np.cumsum(values)])
    middle = np.arange(values.size)
    first = np.maximum(middle - width // 2, 0)
    last = np.minimum(middle - width // 2 + width, values.size)
    return (sums[last] - sums[first]) / (last - first)


def heaviest(weights: Array, most: int) -> list[tuple[int, int]]:
    """First index and the one behind the last of up to `most` disjoint runs of positive sum, the heaviest first, each
    the heaviest in what those before it left."""
    left, found = weights.copy(), []
    for _ in range(most):
        sums = np.concatenate([[0.0], np.cumsum(left)])
        gains = sums - np.minimum.accumulate(sums)
        last = int(gains.argmax())
        first = int(sums[: last + 1].argmin())
        if gains[last] <= 0:
            break
        found.append((first, last))
        left[first:last] = -np.abs(weights).sum()  # no later run pays for crossing this one
    return found
