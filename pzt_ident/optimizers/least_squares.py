"""Least squares from many starts."""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pzt_ident.model.optimizer import Array, Budgeted, Search, setting
from pzt_ident.model.registry import optimizers

Mask = NDArray[np.bool_]

ROUNDING = float(np.finfo(np.float64).eps)
STEP = ROUNDING**0.5  # of a forward difference
TOGETHER = 64  # points of a batch
GROWTH = 2.0  # of the damping where a step is not taken, and of itself
SMALLEST = 1e-11  # step below which a start ends


@optimizers.register
@dataclass(frozen=True)
class LeastSquares(Budgeted):
    """Levenberg-Marquardt from many starts: (J' J + mu D) s = -J' r within the bounds, J by a batch of differences.

    Without residuals the model of the loss is quadratic with a BFGS Hessian in place of J' J. Each start is the best of
    `samples` random points.
    """

    source = "Marquardt (1963), J. SIAM 11, 431; Nielsen (1999), IMM-REP-1999-05; Nocedal & Wright (2006), ch. 6 and 10"
    wants = "residuals"

    samples: int = setting(10, "1", (1, 100_000), "Random points of which the best one is a start.")

    def search(self, dimensions: int, rng: np.random.Generator) -> Search:
        while True:
            best, least, answer = np.zeros(dimensions), np.inf, np.array(np.inf)
            points = rng.random((self.samples, dimensions))
            for first in range(0, self.samples, TOGETHER):
                answers = yield points[first : first + TOGETHER]
                sizes = [size(answer) for answer in answers]
                if min(sizes) < least:
                    chosen = int(np.argmin(sizes))
                    best, least, answer = points[first + chosen], sizes[chosen], answers[chosen]
            if least < np.inf:
                yield from descend(best, answer)


def size(answer: Array) -> float:
    """Half the squared norm of residuals, or the loss itself; infinite if not finite."""
    value = 0.5 * float(answer @ answer) if np.ndim(answer) else float(answer)
    return value if np.isfinite(value) else np.inf


def descend(x: Array, answer: Array) -> Generator[Array, Array, None]:
    """From one start to a point at which no step within the bounds reduces the loss. answer: residuals or loss at x.
    Where residuals answer, many points at once cost as much as few: a step is asked for with the differences about
    where it leads, unless one was just refused."""
    by_residuals, hessian = bool(np.ndim(answer)), None
    before: tuple[Array, Array] | None = None
    damping, growth, movable, first = 1e-3, GROWTH, np.ones(x.size, dtype=bool), size(answer)
    steps, around = np.empty(0), None
    while True:
        if around is None:
            sizes = np.full(x.size, STEP) if by_residuals or hessian is None else widths(float(answer), hessian)
            steps, points = differences(x, sizes)
            around = yield np.vstack([x, points]) if by_residuals else points
        if not np.isfinite(around).all():
            return
        if by_residuals:
            answer = around[0]  # residuals of one batch are rotated together
            jacobian = ((around[1:] - answer) / steps[:, None]).T
            gradient, hessian = jacobian.T @ answer, jacobian.T @ jacobian
            movable = 0.5 * STEP**2 * np.diag(hessian) <= first  # without what runs away
        else:
            gradient = (around - answer) / steps
            hessian = secant(hessian, before, x, gradient)
        before = x, gradient
        while True:
            step = bounded_steps(x, gradient, hessian, damping, movable)[0]
            if np.abs(step).max() < SMALLEST or damping > 1e12:
                return
            candidates = np.clip(x + np.outer([1.0, 0.25], step), 0, 1)
            steps, ahead = differences(candidates[0], np.full(x.size, STEP))
            hopeful = by_residuals and growth == GROWTH
            answers = yield np.vstack([candidates, ahead]) if hopeful else candidates
            chosen = int(size(answers[1]) < size(answers[0]))
            expected = -(gradient @ step + 0.5 * step @ hessian @ step)
            gained = size(answer) - size(answers[chosen])
            if gained > 0:
                quality = (size(answer) - size(answers[0])) / max(float(expected), 1e-300)
                damping *= max(1 / 10, 1 - (2 * min(quality, 1.5) - 1) ** 3) if quality > 0 else 4.0
                growth = GROWTH
                x, answer = candidates[chosen], answers[chosen]
                around = np.delete(answers, 1, axis=0) if hopeful and chosen == 0 else None
                break
            damping, growth = damping * growth, growth * 2
        if gained < 1e-14 * size(answer):
            return


def differences(x: Array, sizes: Array) -> tuple[Array, Array]:
    """Steps of forward differences, backward at an upper bound, and the points that they lead to: (free,), (free,
    free)."""
    steps = np.where(x + sizes > 1, -sizes, sizes)
    return steps, np.clip(x + np.diag(steps), 0, 1)


def widths(loss: float, hessian: Array) -> Array:
    """Steps at which the rounding error of a difference equals its curvature error: 2 sqrt(eps |f| / H_ii)."""
    curvature = np.maximum(np.diag(hessian), 1e-300)
    return np.clip(2 * np.sqrt(ROUNDING * abs(loss) / curvature), 1e-10, 1e-6)


def bounded_steps(x: Array, gradient: Array, hessian: Array, dampings: ArrayLike, movable: Mask | bool = True) -> Array:
    """The step of each damping over the coordinates that are free to move, cut at the bounds: (dampings, free).
    movable: which may."""
    dampings = np.atleast_1d(dampings)
    inward = movable & ~(((x <= 0) & (gradient > 0)) | ((x >= 1) & (gradient < 0)))
    scale = np.maximum(np.diag(hessian), 1e-12 * np.diag(hessian).max(where=inward, initial=1e-300))
    steps = np.zeros((len(dampings), x.size))
    waiting = {tuple(inward): np.arange(len(dampings))}
    while waiting:
        word, chosen = waiting.popitem()
        free = np.array(word)
        steps[chosen] = 0
        if not free.any():
            continue
        inside = np.ix_(free, free)
        steps[np.ix_(chosen, free)] = damped(hessian[inside], scale[free], gradient[free], dampings[chosen])
        out = free & (((x <= 0) & (steps[chosen] < 0)) | ((x >= 1) & (steps[chosen] > 0)))
        for place in np.flatnonzero(out.any(axis=1)):
            left = tuple(free & ~out[place])
            waiting[left] = np.append(waiting.get(left, np.empty(0, dtype=int)), chosen[place])
    return np.clip(x + steps, 0, 1) - x


def damped(hessian: Array, scale: Array, gradient: Array, dampings: Array) -> Array:
    """Solutions of (H + mu diag(scale)) s = -g for each mu: (dampings, free). One decomposition serves all."""
    root = np.sqrt(scale)
    values, directions = np.linalg.eigh(hessian / np.outer(root, root))
    curvature = values + dampings[:, None]
    along = gradient / root @ directions
    least = ROUNDING * len(values) * np.abs(curvature).max(axis=1, keepdims=True)
    shares = np.where(np.abs(curvature) > least, along / np.where(curvature == 0, 1, curvature), 0)
    return -(shares @ directions.T) / root


def secant(hessian: Array | None, before: tuple[Array, Array] | None, x: Array, gradient: Array) -> Array:
    """BFGS, damped so that it stays positive definite (Nocedal & Wright, procedure 18.2)."""
    if before is None or hessian is None:
        return np.eye(x.size) * max(float(np.linalg.norm(gradient)), 1e-12)
    s, y = x - before[0], gradient - before[1]
    if not np.any(s):
        return hessian
    along = hessian @ s
    curvature, bent = float(s @ along), float(s @ y)
    if bent < 0.2 * curvature:
        share = 0.8 * curvature / (curvature - bent)
        y = share * y + (1 - share) * along
    return hessian - np.outer(along, along) / curvature + np.outer(y, y) / float(s @ y)
