"""Descent to the minimum next to a point of the unit cube: the least squares of the polish and of every refit."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from pzt_ident.engine.simulator import Simulator
from pzt_ident.optimizers.least_squares import bounded_steps
from pzt_ident.search.problem import Problem, Squares, exact_squares
from pzt_ident.search.stencil import NARROW

Array = NDArray[np.float64]

DAMPINGS = 10.0 ** np.arange(-12, 4)  # of the curvature, tried side by side, which costs lanes as much as one
FARTHEST = 0.3  # of a parameter's range in a step
REFINED, PATIENCE = 1e-4, 3  # of the loss: so many steps in a row that take less off end a descent
PROMISED = 1e-8  # of the loss: a step that would take less off ends it, too
FAR = 2.0  # times the loss of a rival
CRAWLING = 1e-3  # of the loss: so many steps in a row that take less off end a rough descent, and one far above a rival
BEHIND, FEW = 1.1, 5  # times the loss of a rival: what is above it after so many steps ends where there is no patience
SETTLED = 1e-11  # of the loss: a step that takes less off, or would, ends a polish
NEXT = 1e-3  # of a parameter's range: twice the longest step that still leads to the minimum next to it
ROUNDING = 1e-10  # of the loss: it rises by less where only its digits end


def descend(
    problem: Problem,
    point: Array,
    most: int = 30,
    held: int | None = None,
    going: Callable[[], bool] = lambda: True,
    rival: float = np.inf,
    patient: Callable[[], bool] = lambda: True,
    rough: bool = False,
) -> Array:
    """The point that few steps reach. held: a parameter that stays where it is. going: whether there is time for
    another step. rival: the loss of another model; a descent is given up far above it where it crawls, and behind it
    where `patient` says that it took long. rough: whether it ends anywhere where it crawls."""
    best, falls = np.clip(point, 0, 1), [1.0]
    for step, loss, fall in islice(steps(problem, best, PROMISED, held, going, Simulator.sure_squares), most):
        best = step
        falls.append(fall)
        crawls = max(falls[-PATIENCE:]) < (CRAWLING if rough or loss > FAR * rival else REFINED)
        if crawls or (loss > BEHIND * rival and len(falls) > FEW and not patient()):
            break
    return best


def polish(problem: Problem, point: Array, evaluations: int = 2000) -> tuple[Array, int]:
    """The minimum next to a point, as exactly as the loss tells, and the number of simulations."""
    a_step = problem.dimensions + 1 + len(DAMPINGS)
    most = max(1, evaluations // a_step)
    best, number = settling(problem, np.clip(point, 0, 1), most)
    narrowed = problem.narrowed(best)
    if narrowed is not problem:
        best, more = settling(narrowed, best, max(1, most - number))
        number += more
    return settled(narrowed, best), number * a_step + 1


def steep(problem: Problem, jacobian: Array) -> NDArray[np.bool_]:
    """Parameters along which the narrowest difference changes more than the whole response, (free,): a hysteresis that
    runs away has no slope that a step can follow, such as where its share is zero and its decay is a growth."""
    return np.asarray(np.linalg.norm(jacobian, axis=0) * NARROW > problem.swing)


def settling(problem: Problem, point: Array, most: int) -> tuple[Array, int]:
    """Where so many steps end, or fewer where the loss falls no more, and how many they are."""
    number = 0
    for step, _, fall in islice(steps(problem, point, SETTLED), most):
        point, number = step, number + 1
        if fall < SETTLED:
            break
    return point, number


def settled(problem: Problem, point: Array) -> Array:
    """The point where the gradient vanishes next to a minimum, by steps of Gauss and Newton for as long as they get
    shorter: the loss tells half as many digits of it."""
    loss, length = problem.best(point[None], point)[1], NEXT
    while 0 < loss < np.inf:
        jacobian, residual = problem.equations(point)
        movable, jacobian, residual = ~steep(problem, jacobian), jacobian / loss, residual / loss
        move = bounded_steps(point, jacobian.T @ residual, jacobian.T @ jacobian, DAMPINGS[0], movable)[0]
        moved, least = problem.best(np.clip(point + move, 0, 1)[None], point)
        if not np.abs(moved - point).max() < length / 2 or least > (1 + ROUNDING) * loss:
            break
        length, point = np.abs(moved - point).max(), moved
    return point


def steps(
    problem: Problem,
    point: Array,
    least: float,
    held: int | None = None,
    going: Callable[[], bool] = lambda: True,
    squares: Squares = exact_squares,
) -> Iterator[tuple[Array, float, float]]:
    """Steps of Levenberg and Marquardt: points of lower and lower loss in the unit cube, their losses, and by which
    share each fell, until none is lower or the residuals, if they were linear, would promise none that falls by the
    least. squares: by which losses are told from each other."""
    loss = np.nan
    while going():
        problem = problem.begun_at(point)
        jacobian, residual = problem.equations(point, central=False)
        loss = float(np.linalg.norm(residual)) if np.isnan(loss) else loss
        if not 0 < loss < np.inf:
            break
        movable = (np.arange(point.size) != held) & ~steep(problem, jacobian)
        jacobian, residual = jacobian / loss, residual / loss
        gradient, curvature = jacobian.T @ residual, jacobian.T @ jacobian
        moves = np.clip(bounded_steps(point, gradient, curvature, DAMPINGS, movable), -FARTHEST, FARTHEST)
        if 1 - np.linalg.norm(residual[:, None] + jacobian @ moves.T, axis=0).min() < least:
            break
        best, reached = problem.best(np.clip(point + moves, 0, 1), point, squares)
        if not reached < loss:
            break
        yield best, reached, 1 - reached / loss
        point, loss = best, reached
