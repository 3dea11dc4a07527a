"""Descent to the minimum next to a point of the unit cube."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from pzt_ident.search.problem import Problem

Array = NDArray[np.float64]

DAMPINGS = 10.0 ** np.arange(-5, 4)


def descend(
    problem: Problem,
    point: Array,
    most: int = 30,
    held: int | None = None,
    going: Callable[[], bool] = lambda: True,
) -> Array:
    """The point that Levenberg-Marquardt on the normal equations reaches in the unit cube, all dampings in one batch.
    held: a parameter that stays where it is. going: whether there is time for another step."""
    point = np.clip(point, 0, 1)
    loss, slow = problem.loss(point)[0], 0
    for _ in range(most if np.isfinite(loss) else 0):
        if not going():
            break
        jacobian, residual = problem.jacobian(point), problem.residuals(point)[0]
        gradient, curvature = jacobian.T @ residual, jacobian.T @ jacobian
        free = ~(((point <= 0) & (gradient > 0)) | ((point >= 1) & (gradient < 0)))
        free[[] if held is None else [held]] = False
        trials = np.array([damped_step(point, gradient, curvature, free, damping) for damping in DAMPINGS])
        best, least = problem.best(trials, point)
        if not least < loss:
            break
        slow = slow + 1 if least > (1 - 1e-4) * loss else 0
        point, loss = best, least
        if slow == 3:
            break
    return point


def damped_step(point: Array, gradient: Array, curvature: Array, free: NDArray[np.bool_], damping: float) -> Array:
    """The point after one Levenberg-Marquardt step of the free parameters, inside the unit cube."""
    if not free.any():
        return point
    block = curvature[np.ix_(free, free)]
    scale = np.maximum(np.diag(block), 1e-12 * max(np.diag(block).max(), 1e-300))
    step = np.zeros(point.size)
    step[free] = -np.linalg.lstsq(block + damping * np.diag(scale), gradient[free], rcond=None)[0]
    return np.clip(point + np.clip(step, -0.3, 0.3), 0, 1)
