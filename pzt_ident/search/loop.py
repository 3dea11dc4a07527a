"""The search of the unit cube: when to stop an optimizer, and the loop that runs it."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, fields
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pzt_ident.errors import InputError, RunError
from pzt_ident.model.optimizer import Array, Optimizer, Search
from pzt_ident.model.registry import optimizers

Function = Callable[[Array], Array]


@dataclass(frozen=True)
class Stop:
    """The limits of a search, which ends at the first one reached; the evaluations are never exceeded.

    seconds: of wall time. target: a loss that is good enough. stagnation: number of generations in which the best loss
    has not fallen by more than the fraction `tolerance`.
    """

    evaluations: int
    seconds: float | None = None
    target: float | None = None
    stagnation: int | None = None
    tolerance: float = 1e-12

    def __post_init__(self) -> None:
        for item in fields(self):
            value = getattr(self, item.name)
            low = 1 if item.name in ("evaluations", "stagnation") else 0
            if item.name != "target" and value is not None and not value >= low:
                raise InputError(f"{value!r} is too small", where=f"stop.{item.name}", remedy=f"give at least {low}")


class State(NamedTuple):
    """Argument of the callback after each generation: the best point so far, and the losses (M,) of this generation."""

    generation: int
    evaluations: int
    loss: float
    point: Array
    losses: Array
    seconds: float


class History(NamedTuple):
    """Evaluations, seconds and best loss so far, after each generation: (generations,) each."""

    evaluations: NDArray[np.int64]
    seconds: Array
    best: Array


class Outcome(NamedTuple):
    """The best point (P,) and its loss; NaN and inf if every candidate failed.

    `stopped_by` is the field of Stop that ended the search, or `callback`.
    """

    point: Array
    loss: float
    evaluations: int
    history: History
    stopped_by: str


def norms(residuals: Array) -> Array:
    """Norm of each row, inf for a row that is not finite: (M, N) -> (M,)."""
    return finite(np.sqrt(np.sum(np.square(residuals), axis=1)))


def finite(losses: ArrayLike) -> Array:
    """The losses with inf in place of all values that are not finite, NaN and -inf included."""
    losses = np.asarray(losses, dtype=np.float64)
    return np.where(np.isfinite(losses), losses, np.inf)


def optimize(
    optimizer: Optimizer,
    dimensions: int,
    evaluate: Function,
    seed: Any,
    stop: Stop,
    residuals: Function | None = None,
    callback: Callable[[State], bool | None] | None = None,
    earlier_losses: Iterable[ArrayLike] = (),
) -> Outcome:
    """Run an optimizer until `stop` ends it.

    evaluate: candidates (M, P) in the unit cube -> losses (M,). residuals: candidates -> (M, N), the loss being the
    norm of a row; used instead of evaluate by an optimizer that wants them. seed: anything that NumPy's
    default_rng takes; the outcome depends on nothing else. callback: called after each generation; True ends the
    search. earlier_losses: the losses of each generation of an earlier run, which is continued bit for bit without
    evaluating them again (residuals are evaluated again). Raises InputError if they belong to another run, RunError if
    the optimizer ends by itself or leaves the cube.
    """
    by_residuals = residuals is not None and optimizer.wants == "residuals"
    search = optimizer.search(dimensions, np.random.default_rng(seed))
    progress = _Progress(stop, dimensions)
    replay = iter(earlier_losses)
    answer = None
    while True:
        points = _candidates(search, answer, optimizer.name, progress)
        recorded = next(replay, None)
        if by_residuals and residuals is not None:
            answer = np.asarray(residuals(points), dtype=np.float64)
            losses = norms(answer)
        else:
            losses = finite(evaluate(points) if recorded is None else recorded)
            answer = losses.copy()
        _check_shape(losses, points, "function" if recorded is None else "checkpoint")
        state = progress.record(points, losses)
        ended = progress.ended_by()
        if recorded is None and callback is not None and callback(state):
            ended = ended or "callback"
        if ended:
            search.close()
            return progress.outcome(ended)


def _candidates(search: Search, answer: Any, name: str, progress: _Progress) -> Array:
    """The next candidates (M, P) of a search, as many as the budget allows; answer: None for the first ones.

    Raises RunError where the search ends by itself, or gives something else than candidates in the unit cube.
    """
    evaluations, budget, dimensions = progress.evaluations, progress.stop.evaluations, len(progress.point)
    try:
        points = np.asarray(search.send(answer), dtype=np.float64)
    except StopIteration:
        message = f"{name} ended by itself after {evaluations} of {budget} evaluations"
        raise RunError(f"{message}: its `search` must yield candidates until it is closed") from None
    if points.ndim != 2 or not len(points) or points.shape[1] != dimensions:
        raise RunError(
            f"{name} gave candidates of shape {points.shape}: its `search` must yield an array (M, {dimensions})"
        )
    low, high = points.min(), points.max()
    if not (low >= 0 and high <= 1):
        raise RunError(f"{name} gave a candidate from {low:g} to {high:g}: each coordinate must lie from 0 to 1")
    return points[: budget - evaluations]


def _check_shape(losses: Array, points: Array, where: str) -> None:
    """Raises InputError unless there is one loss for each candidate."""
    if losses.shape != points.shape[:1]:
        message = f"losses of shape {losses.shape} for {len(points)} candidates"
        raise InputError(message, where=where, remedy="one loss for each candidate, from the same job and seed")


class _Progress:
    """The best point so far, and a row of the history per generation."""

    def __init__(self, stop: Stop, dimensions: int) -> None:
        self.stop, self.started = stop, time.perf_counter()
        self.evaluations, self.loss, self.point = 0, math.inf, np.full(dimensions, np.nan)
        self.rows: list[tuple[int, float, float]] = []
        self.improved, self.threshold = 0, math.inf

    def record(self, points: Array, losses: Array) -> State:
        """Add a generation."""
        self.evaluations += len(losses)
        best = int(np.argmin(losses))
        if losses[best] < self.loss:
            self.loss, self.point = float(losses[best]), points[best].copy()
        seconds = time.perf_counter() - self.started
        self.rows.append((self.evaluations, seconds, self.loss))
        if self.loss < self.threshold:
            self.threshold = self.loss - self.stop.tolerance * abs(self.loss)
            self.improved = len(self.rows)
        return State(len(self.rows), self.evaluations, self.loss, self.point, losses, seconds)

    def ended_by(self) -> str:
        """The field of Stop whose limit is reached, or nothing."""
        generation, (_, seconds, loss) = len(self.rows), self.rows[-1]
        stop = self.stop
        if stop.target is not None and loss <= stop.target:
            return "target"
        if self.evaluations >= stop.evaluations:
            return "evaluations"
        if stop.seconds is not None and seconds >= stop.seconds:
            return "seconds"
        if stop.stagnation is not None and generation - self.improved >= stop.stagnation:
            return "stagnation"
        return ""

    def outcome(self, stopped_by: str) -> Outcome:
        evaluations, seconds, best = zip(*self.rows, strict=True)
        history = History(np.array(evaluations), np.array(seconds), np.array(best))
        return Outcome(self.point, self.loss, self.evaluations, history, stopped_by)


def minimize(
    function: Callable[[Array], Any],
    bounds: Sequence[tuple[float, float]],
    optimizer: str = "pso",
    seed: Any = 0,
    evaluations: int = 10_000,
    vectorized: bool = False,
    **settings: Any,
) -> Outcome:
    """Minimize a function of a point (P,) within bounds, a (low, high) for each coordinate.

    vectorized: the function takes points (M, P) and returns losses (M,). settings: of the optimizer, see
    `pzt-ident show NAME`. The outcome's point is in the function's coordinates and depends on the seed alone.
    Raises InputError for infinite or reversed bounds and for an unknown optimizer or setting.
    """
    low, high = _box(bounds)
    chosen = optimizers[optimizer].make(**settings).with_budget(evaluations)

    def evaluate(cube: Array) -> Array:
        points = low + (high - low) * cube
        return function(points) if vectorized else np.array([function(point) for point in points], dtype=np.float64)

    outcome = optimize(chosen, len(low), evaluate, seed, Stop(evaluations))
    return outcome._replace(point=low + (high - low) * outcome.point)


def _box(bounds: Sequence[tuple[float, float]]) -> tuple[Array, Array]:
    """Lower and upper bounds (P,). Raises InputError for infinite or reversed ones."""
    remedy = "give a (low, high) for each coordinate"
    try:
        box = np.asarray(bounds, dtype=np.float64)
    except (TypeError, ValueError):
        raise InputError(f"{bounds!r} are no numbers", where="bounds", remedy=remedy) from None
    if box.ndim != 2 or box.shape[1] != 2 or not len(box):
        raise InputError(f"shape {box.shape}", where="bounds", remedy=remedy)
    for i, (low, high) in enumerate(box):
        if not (math.isfinite(low) and math.isfinite(high) and low < high):
            raise InputError(f"({low:g}, {high:g})", where=f"bounds[{i}]", remedy="give finite numbers, low < high")
    return box[:, 0], box[:, 1]
