"""Long curves by fewer of their points, for figures."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def decimate(values: NDArray[np.float64], bins: int) -> NDArray[np.intp]:
    """Ascending indices of the minimum and maximum in each of `bins` intervals, and of both ends."""
    size = values.size
    if size <= 2 * bins:
        return np.arange(size)
    edges = np.linspace(0, size, bins + 1).astype(int)
    finite = np.nan_to_num(values, nan=0.0, posinf=0.0, neginf=0.0)
    first, lengths = edges[:-1], np.diff(edges)
    within = np.minimum(np.arange(lengths.max()), lengths[:, None] - 1)  # a shorter interval repeats its last value
    blocks = finite[first[:, None] + within]
    return np.unique(np.concatenate([[0], first + blocks.argmin(axis=1), first + blocks.argmax(axis=1), [size - 1]]))


def decimate_curve(xs: NDArray[np.float64], ys: NDArray[np.float64], points: int) -> NDArray[np.intp]:
    """Ascending indices of points at equal distances along a curve, and of the extremes of x."""
    if xs.size <= points:
        return np.arange(xs.size)
    steps = [np.diff(np.nan_to_num(values)) / (float(np.ptp(np.nan_to_num(values))) or 1.0) for values in (xs, ys)]
    length = np.append(0.0, np.cumsum(np.hypot(*steps)))
    return np.union1d(decimate(xs, points // 4), np.searchsorted(length, np.linspace(0.0, length[-1], points)))
