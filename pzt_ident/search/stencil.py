"""Points of central differences in the unit cube."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

DIFFERENCE = 1e-5  # half their width


def stencil(point: Array, failed: NDArray[np.bool_] | None = None) -> tuple[Array, Array]:
    """Points about a point, itself the first, one-sided on the faces of the cube and beside points that `failed`, none
    between two failed ones: (2 free + 1, free). And the weights of what is there in the value at the point and in its
    derivatives: (1 + free, 2 free + 1)."""
    point = np.asarray(point, dtype=float)
    count = point.size
    steps = DIFFERENCE * np.eye(count)
    points = np.clip(point + np.vstack([np.zeros(count), steps, -steps]), 0, 1)
    if failed is not None:
        points[failed] = point
    ends = points[1:].reshape(2, count, count).diagonal(axis1=1, axis2=2)
    width = ends[0] - ends[1]
    slope = np.diag(1 / np.where(width > 0, width, np.inf))
    weights = np.zeros((1 + count, 1 + 2 * count))
    weights[0, 0], weights[1:, 1 : 1 + count], weights[1:, 1 + count :] = 1, slope, -slope
    return points, weights
