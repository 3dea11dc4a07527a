"""Intervals of parameters where the curvature at the minimum misleads: by the profile of the loss."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from pzt_ident.search.descent import descend
from pzt_ident.search.problem import Problem

Array = NDArray[np.float64]

TWO_SIDED = 1.96  # standard errors, of 95 %
CLEAR = 1e-3  # of the search range: with a smaller standard error a parameter is determined whatever the profile
AGREES = 2.0  # times: where the loss rises so little or so much more than expected, it is followed
MISLEADS = 0.25  # of the rise that the curvature expects: with less the curvature misleads
PASSES = 4  # of the descent of the other parameters


def intervals(
    problem: Problem, point: Array, jacobian: Array, errors: Array, going: Callable[[], bool] = lambda: True
) -> Array:
    """Ends of the 95 % interval of each parameter in the unit cube, (free, 2).

    They are those of the standard errors, (free,), where the loss, with the other parameters fitted again, rises there
    as its curvature says; where it hardly rises, they lie where it has risen by as much (Bates & Watts 1988, ch. 6).
    going: whether there is time to look at another parameter; after that the curvature is believed.
    """
    ends = np.column_stack([point - TWO_SIDED * errors, point + TWO_SIDED * errors])
    _, s, vt = np.linalg.svd(jacobian, full_matrices=False)
    inverse = (vt.T / np.maximum(s, 1e-9 * max(s.max(initial=0), 1e-300)) ** 2) @ vt
    least = float(problem.loss(point)[0]) ** 2
    for i in np.flatnonzero((errors > CLEAR) & (np.diag(inverse) > 0)).tolist():
        expected = (TWO_SIDED * errors[i]) ** 2 / inverse[i, i]
        direction = inverse[:, i] / inverse[i, i]
        if not going():
            break
        for side, sign in enumerate((-1, 1)):
            ends[i, side] = end_of(problem, point, i, sign * TWO_SIDED * errors[i], direction, least, expected)
    return ends


def end_of(
    problem: Problem, point: Array, i: int, step: float, direction: Array, least: float, expected: float
) -> float:
    """Where the squared loss has risen from the least by what is expected of a step of parameter i, in the cube. The
    others start along the direction that the curvature gives them."""
    for _ in range(10):
        end = point[i] + step
        if not 0 < end < 1:
            return float(end)
        trial = np.clip(point + step * direction, 0, 1)
        rise = float(problem.loss(trial)[0]) ** 2 - least
        if not expected / AGREES < rise < expected * AGREES:
            rise = float(problem.loss(descend(problem, trial, PASSES, i))[0]) ** 2 - least
        if not rise < MISLEADS * expected:
            return float(end)
        step *= 2
    return float(point[i] + step)
