"""The intervals of a residual with the most misfit."""

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
    """The disjoint intervals over which the smoothed squared residual exceeds a level by the largest sum, that with the
    largest share of the misfit first, none below 1 %. residuals: scored samples, (samples,) each.

    The level is 1.5 times the mean square, or 0.6 times the mean square weighted by the square itself if that is more.
    """
    smoothed = [smooth(part**2, max(1, part.size // 200)) for part in residuals]
    squares = np.concatenate(smoothed)
    level = max(1.5 * squares.mean(), 0.6 * (squares**2).sum() / squares.sum())
    total = sum(float((part**2).sum()) - noise**2 * part.size for part in residuals)
    intervals = []
    for record, residual, square in zip(records, residuals, smoothed, strict=True):
        for first, last in heaviest_runs(square - level, most):
            part = residual[first:last]
            share = (float((part**2).sum()) - noise**2 * part.size) / total
            start, end = record.time[record.settle + np.array([first, last - 1])].tolist()
            intervals.append(Interval(record.name, start, end, float(np.sqrt((part**2).mean())), share))
    large = [interval for interval in intervals if interval.share >= 0.01]
    return tuple(sorted(large, key=lambda interval: -interval.share)[:most])


def smooth(values: Array, width: int) -> Array:
    """Moving mean over `width` samples, fewer at the ends."""
    sums = np.concatenate([[0.0], np.cumsum(values)])
    middle = np.arange(values.size)
    first = np.maximum(middle - width // 2, 0)
    last = np.minimum(middle - width // 2 + width, values.size)
    return (sums[last] - sums[first]) / (last - first)


def heaviest_runs(weights: Array, most: int) -> list[tuple[int, int]]:
    """First index and the one after the last of up to `most` disjoint runs of positive sum, each the heaviest beside
    the runs before it."""
    remaining, runs = weights.copy(), []
    for _ in range(most):
        sums = np.concatenate([[0.0], np.cumsum(remaining)])
        gains = sums - np.minimum.accumulate(sums)
        last = int(gains.argmax())
        first = int(sums[: last + 1].argmin())
        if gains[last] <= 0:
            break
        runs.append((first, last))
        remaining[first:last] = -np.abs(weights).sum()  # no later run crosses this one
    return runs
