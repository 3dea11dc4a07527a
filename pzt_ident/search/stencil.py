"""Points of differences in the unit cube."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

DIFFERENCE, NARROW = 1e-5, 1e-8  # half their width; beside what bends within it, and from one side
BENT = 0.01  # of the change between the ends, by which their mean differs from the middle


def stencil(
    point: Array, half_width: Array | float = DIFFERENCE, failed: NDArray[np.bool_] | None = None
) -> tuple[Array, Array]:
    """Points about a point, itself the first, one-sided on the faces of the cube and beside points that `failed`, none
    between two failed ones: (2 free + 1, free). And the weights of what is there in the value at the point and in its
    derivatives: (1 + free, 2 free + 1). half_width: one, or (free,)."""
    point = np.asarray(point, dtype=float)
    count = point.size
    steps = half_width * np.eye(count)
    points = np.clip(point + np.vstack([np.zeros(count), steps, -steps]), 0, 1)
    if failed is not None:
        points[failed] = point
    ends = points[1:].reshape(2, count, count).diagonal(axis1=1, axis2=2)
    width = ends[0] - ends[1]
    slope = np.diag(1 / np.where(width > 0, width, np.inf))
    weights = np.zeros((1 + count, 1 + 2 * count))
    weights[0, 0], weights[1:, 1 : 1 + count], weights[1:, 1 + count :] = 1, slope, -slope
    return points, weights


def forward(point: Array) -> tuple[Array, Array]:
    """A point and points narrowly beside it, inward: (1 + free, free). And the weights as of `stencil`: (1 + free,
    1 + free). From one side an error is of first order in the width."""
    point = np.asarray(point, dtype=float)
    steps = np.where(point < 0.5, NARROW, -NARROW)
    weights = np.vstack([np.zeros(point.size), np.diag(1 / steps)])
    first = np.append(1.0, -1 / steps)
    return np.vstack([point, point + np.diag(steps)]), np.column_stack([first, weights])


def half_widths(point: Array, residuals: Callable[[Array], Array]) -> Array:
    """DIFFERENCE, and NARROW for parameters along which residuals of points, (candidates, samples), bend within it, as
    those of a mode do that rings through a long record: (free,)."""
    middle = np.clip(point, DIFFERENCE, 1 - DIFFERENCE)
    rows = residuals(stencil(middle)[0])
    with np.errstate(invalid="ignore"):
        forth, back = (rows[1:] - rows[0]).reshape(2, point.size, -1)
    bend, change = np.linalg.norm(forth + back, axis=1), np.linalg.norm(forth - back, axis=1)
    return np.where(bend > BENT * change, NARROW, DIFFERENCE)
