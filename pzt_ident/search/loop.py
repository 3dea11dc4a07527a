"""Search the unit cube: when to stop an optimizer, and the loop that drives it."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, fields
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pzt_ident.errors import InputError
from pzt_ident.model.optimizer import Array, Optimizer
from pzt_ident.model.registry import optimizers

Function = Callable[[Array], Array]


@dataclass(frozen=True)
class Stop:
    """When a search ends, whichever comes first; the evaluations are never exceeded.

    evaluations; seconds of wall time; target: a loss that is good enough; stagnation: generations in which the best
    loss has not fallen by more than the share `tolerance`.
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
    """What a callback is told once a generation: the best so far and the losses (M,) of this generation."""

    generation: int
    evaluations: int
    loss: float
    point: Array
    losses: Array
    seconds: float


class History(NamedTuple):
    """One number each per generation: evaluations so far, seconds so far, best loss so far."""

    evaluations: NDArray[np.int64]
    seconds: Array
    best: Array


class Outcome(NamedTuple):
    """The best point (P,) and its loss, NaN and inf where every candidate failed.

    `stopped_by` is the word of Stop that ended the search, or `callback`.
    """

    point: Array
    loss: float
    evaluations: int
    history: History
    stopped_by: str


def rms(residuals: Array) -> Array:
    """Root mean square of each row, inf for a row that is not finite: (M, N) -> (M,)."""
    return finite(np.sqrt(np.mean(np.square(residuals), axis=1)))


def finite(losses: ArrayLike) -> Array:
    """The losses with inf for whatever is not finite, NaN included, so that a failure is never good."""
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
    told: Iterable[ArrayLike] = (),
) -> Outcome:
    """Run an optimizer until `stop` ends it.

    evaluate: candidates (M, P) in the unit cube to losses (M,). residuals: to (M, N), the root mean square of a row
    being its loss; used instead of evaluate by an optimizer that wants them. seed: anything that NumPy's default_rng
    takes; the outcome is a function of it alone. callback: once a generation; True ends the search. told: the losses
    of the generations of an earlier run, which is continued bit for bit without evaluating them again (residuals are
    evaluated again). Raises InputError where they belong to another run.
    """
    by_residuals = residuals is not None and optimizer.wants == "residuals"
    search = optimizer.search(dimensions, np.random.default_rng(seed))
    progress = _Progress(stop, dimensions)
    replay = iter(told)
    points = next(search)
    while True:
        points = points[: stop.evaluations - progress.evaluations]
        known = next(replay, None)
        if by_residuals and residuals is not None:
            answer = np.asarray(residuals(points), dtype=np.float64)
            losses = rms(answer)
        else:
            losses = finite(evaluate(points) if known is None else known)
            answer = losses.copy()
        _same_shape(losses, points, "function" if known is None else "checkpoint")
        state = progress.take(points, losses)
        ended = progress.ended_by()
        if known is None and callback is not None and callback(state):
            ended = ended or "callback"
        if ended:
            search.close()
            return progress.outcome(ended)
        points = search.send(answer)


def _same_shape(losses: Array, points: Array, where: str) -> None:
    if losses.shape != points.shape[:1]:
        message = f"losses of shape {losses.shape} for {len(points)} candidates"
        raise InputError(message, where=where, remedy="one loss for each candidate, from the same job and seed")


class _Progress:
    """The best so far and three numbers a generation."""

    def __init__(self, stop: Stop, dimensions: int) -> None:
        self.stop, self.started = stop, time.perf_counter()
        self.evaluations, self.loss, self.point = 0, math.inf, np.full(dimensions, np.nan)
        self.rows: list[tuple[int, float, float]] = []
        self.improved, self.threshold = 0, math.inf

    def take(self, points: Array, losses: Array) -> State:
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
    """Minimize your own function of a point (P,) within bounds, a (low, high) for each coordinate.

    vectorized: the function takes points (M, P) and returns losses (M,). settings: those of the optimizer, see
    `pzt-ident show NAME`. The outcome's point is in your coordinates and a function of the seed alone.
    Raises InputError for bounds that are not finite or reversed, and for an unknown optimizer or setting.
    """
    low, high = _box(bounds)
    chosen = optimizers[optimizer].make(**settings).with_budget(evaluations)

    def evaluate(cube: Array) -> Array:
        points = low + (high - low) * cube
        return function(points) if vectorized else np.array([function(point) for point in points], dtype=np.float64)

    outcome = optimize(chosen, len(low), evaluate, seed, Stop(evaluations))
    return outcome._replace(point=low + (high - low) * outcome.point)


def _box(bounds: Sequence[tuple[float, float]]) -> tuple[Array, Array]:
    box = np.asarray(bounds, dtype=np.float64)
    if box.ndim != 2 or box.shape[1] != 2 or not len(box):
        raise InputError(f"shape {box.shape}", where="bounds", remedy="give a (low, high) for each coordinate")
    for i, (low, high) in enumerate(box):
        if not (math.isfinite(low) and math.isfinite(high) and low < high):
            raise InputError(f"({low:g}, {high:g})", where=f"bounds[{i}]", remedy="give finite numbers, low < high")
    return box[:, 0], box[:, 1]
