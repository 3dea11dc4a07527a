"""Fits of a job's model with effects added, good enough that what is left is the model's fault."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.noise import pooled_floor, sizes
from pzt_ident.data.record import Record
from pzt_ident.engine.simulator import Simulator
from pzt_ident.model.block import Coupling
from pzt_ident.model.chain import Chain
from pzt_ident.model.registry import Choice, blocks
from pzt_ident.search.problem import FixedValue, Problem

Array = NDArray[np.float64]
Tell = Callable[[dict[str, Any]], None]

STARTS = 240  # chance points, of which the best few are refined, so many at a time until two agree
REFINED, MOST = 4, 24
AGREE = 0.01  # of the loss, between the two best of them
ELSEWHERE = 2  # chance points of one block that are refined
EDGE = 1e-4  # of a parameter's range: as near to its end it is on the bound
COARSE = 0.05  # noise floors of a record: what halving the step may change before the simulation takes finer steps
FINEST = 8  # steps a sample
DAMPINGS = 10.0 ** np.arange(-5, 4)


class Case:
    """A model, its records and what is free, to which effects can be added that are not ruled out.

    `tell` hears of every start that was fitted, effect that was scored and model that was refitted, as it happens, from
    any thread; errors are in units of the loss. `given` is the problem of the model as it is, where it is made already.
    """

    def __init__(
        self,
        words: Sequence[str | Choice],
        effects: Sequence[str],
        records: Sequence[Record],
        specs: Any,
        ruled_out: Sequence[str] = (),
        shared: Sequence[str] = (),
        tell: Tell = lambda event: None,
        given: Problem | None = None,
    ) -> None:
        self.tell, self._given = tell, given
        self.words, self.effects = tuple(words), tuple(effects)
        self.ruled_out, self.shared = tuple(ruled_out), tuple(shared)
        self._at: dict[tuple[int, int], Record] = {}
        self.refits: dict[Any, Fit] = {}  # by effects, steps and start
        self.records, self.specs, self.sizes = tuple(records), specs, sizes(list(records))

    def problem(self, effects: Sequence[str], steps: Sequence[int] = (), alone: bool = False) -> Problem:
        """`steps` a sample of each record, by default those of the job; `alone` as in a fit."""
        if self._given and (tuple(effects), tuple(steps), alone) == (self.effects, (), False):
            return self._given
        first = self.records[0]
        chain = blocks.chain((*self.words, *effects))
        silent = self.silent(effects) if alone else {}
        specs = {name: FixedValue(null) for name, null in silent.items()} | self.specs
        model = Chain(chain, first.axes, first.measured, self.shared, specs)
        own = steps or [record.steps for record in self.records]
        records = [self.at(number, count) for number, count in enumerate(own)]
        return Problem(model, records, specs, self.sizes)

    def silent(self, effects: Sequence[str]) -> dict[str, float]:
        """What keeps effects that were added off the axes without a response, by name: their nulls there, in the user's
        units. Empty where no coupling lets such an axis be seen."""
        first, chain = self.records[0], blocks.chain((*self.words, *effects))
        if not any(issubclass(block, Coupling) for block in chain):
            return {}
        others = [axis for number, axis in enumerate(first.axes) if number not in first.measured]
        own = {word for word in effects if word not in self.effects}
        return {
            f"{axis}.{block.name}.{word}": parameter.null
            for axis, block in product(others, chain)
            for word, parameter in block.parameters().items()
            if {block.name, parameter.effect} & own and parameter.null is not None and Chain.alone(block, parameter)
            if f"{block.name}.{word}" not in (*self.shared, *self.specs)
        }

    def at(self, number: int, steps: int) -> Record:
        """A record, simulated in so many steps a sample; the same one each time, whose signals are made ready once."""
        return self._at.setdefault((number, steps), replace(self.records[number], steps=steps))

    @cached_property
    def floor(self) -> float:
        """Noise floor of all measured axes together, in units of the loss."""
        return pooled_floor(list(self.records))


@dataclass(frozen=True)
class Fit:
    """A model with its effects at its best point; RMSE in SI units, validate None without such records. `alone`: the
    effects that were added act on the measured axes alone."""

    effects: tuple[str, ...]
    problem: Problem
    point: Array
    identify: float
    validate: float | None
    converged: bool = True
    alone: bool = False

    @property
    def total(self) -> float:
        """RMSE of both uses together: what fits are ranked by, so that the fitted records alone never choose."""
        return float(np.sqrt(np.mean(np.square([use for use in (self.identify, self.validate) if use is not None]))))

    @property
    def on_bounds(self) -> tuple[str, ...]:
        """Names of the parameters that ended on a bound which is not their null."""
        problem, values = self.problem, self.problem.physical(self.point)[0]
        nulls = [problem.model.entries[column].parameter.null for column in problem.free]
        ends = (self.point <= EDGE) | (self.point >= 1 - EDGE)
        found = zip(problem.names, ends, values, nulls, strict=True)
        return tuple(name for name, end, value, null in found if end and (null is None or not np.isclose(value, null)))

    @property
    def steps(self) -> tuple[int, ...]:
        """Of the simulation in a sample of each record."""
        return tuple(record.steps for record in self.problem.records)

    @property
    def values(self) -> dict[str, float]:
        """Of the free parameters, in the user's units."""
        return dict(zip(self.problem.names, self.problem.physical(self.point)[0].tolist(), strict=True))


def made(effects: tuple[str, ...], problem: Problem, point: Array, converged: bool = True, alone: bool = False) -> Fit:
    validate = float(problem.loss(point, "validate")[0])
    unseen = None if np.isnan(validate) else validate
    return Fit(effects, problem, point, float(problem.loss(point)[0]), unseen, converged, alone)


def first_fit(case: Case, seed: int) -> Fit:
    """The job's own model, from chance points; not converged where the two best of their minima differ."""
    problem = case.problem(case.effects)
    rng = np.random.default_rng(seed)
    starts = rng.uniform(size=(STARTS, problem.dimensions))
    order = np.argsort(problem.loss(starts), kind="stable")[:MOST]
    ends, agreed = np.empty((0, problem.dimensions)), False
    while len(ends) < MOST and not agreed:
        own = starts[order[len(ends) : len(ends) + REFINED]]
        with ThreadPoolExecutor(2) as pool:
            for end in pool.map(lambda start: descend(problem, start), own):
                ends = np.vstack([ends, end])
                case.tell({"event": "fitted", "done": len(ends), "of": len(order)})
        losses = problem.loss(ends)
        best, second = np.sort(losses)[:2]
        agreed = bool(second <= (1 + AGREE) * best + 0.1 * case.floor and np.isfinite(best))
    return resolved(case, made(case.effects, problem, ends[np.argmin(losses)], agreed))


def refit(case: Case, before: Fit, effects: tuple[str, ...], guess: dict[str, float]) -> Fit:
    """The model with other effects, from the parameters it had and a guess (user's units) of the new ones. Where that
    makes a difference the effects act on axes without a response as well, or on the measured ones alone: the better."""
    problem = case.problem(effects, before.steps)
    old = before.values
    middle = problem.physical(np.full(problem.dimensions, 0.5))[0]
    start = {name: guess.get(name, old.get(name, middle[i])) for i, name in enumerate(problem.names)}
    point = problem.unit_point(start)
    key = (effects, before.steps, point.tobytes())
    if key not in case.refits:
        ways = [(problem, False)]
        if case.silent(effects):
            ways.append((case.problem(effects, before.steps, True), True))
        if len(ways) > 1 and not apart(case, *(way.residuals(point)[0] for way, _ in ways)):
            ways.pop()
        fits = [resolved(case, made(effects, way, descend(way, point), alone=alone)) for way, alone in ways]
        case.refits[key] = min(fits, key=lambda fit: fit.total)
    found = case.refits[key]
    case.tell({"event": "refitted", "effects": effects, "identify": found.identify, "validate": found.validate})
    return found


def apart(case: Case, one: Array, other: Array) -> bool:
    """Whether two residuals differ by more than the simulation's step may change."""
    return bool(np.linalg.norm(one - other) > COARSE * case.floor)


def resolved(case: Case, fit: Fit) -> Fit:
    """The fit, gone on with at finer steps of the records where halving the step would show.

    Where the drive is linear between samples, what each block hands on to the next is taken for linear too.
    """
    coarse = (step_errors(case, fit) > COARSE * case.floor) & (np.array(fit.steps) < FINEST)
    if not coarse.any():
        return fit
    steps = [count * (2 if more else 1) for count, more in zip(fit.steps, coarse, strict=True)]
    problem = case.problem(fit.effects, steps, fit.alone)
    return resolved(case, made(fit.effects, problem, descend(problem, fit.point), fit.converged, fit.alone))


def step_errors(case: Case, fit: Fit) -> Array:
    """What halving the step of the simulation changes in each record, root mean square, in units of the loss."""
    problem, found = fit.problem, []
    theta = problem.parameters(fit.point)
    for number, record in enumerate(problem.records):
        finer = case.at(number, 2 * record.steps)
        one, two = (Simulator(problem.model, each).simulate(theta)[0] for each in (record, finer))
        change = (two - one)[:, record.settle :] / problem.sizes[:, None]
        found.append(np.sqrt(np.mean(np.var(change, axis=1))))
    return np.array(found)


def elsewhere(fit: Fit, only: str = "", most: int = ELSEWHERE) -> Fit:
    """The fit, or a better one that starts from other values of one block on one axis, the others kept: of each block
    in turn, or of `only` one. Beside a greater misfit, since explained, or for want of a better guess, a block may
    have come to rest in a side minimum, such as a resonance far off."""
    problem = fit.problem
    entries = [problem.model.entries[column] for column in problem.free]
    owners = [(entry.axis, entry.block.name) for entry in entries]
    rng = np.random.default_rng(0)
    found = [fit]
    for owner in dict.fromkeys(owner for owner in owners if only in ("", owner[1])):
        own = np.array([each == owner for each in owners])
        starts = np.where(own, scattered(problem, rng), fit.point)
        for start in starts[np.argsort(problem.loss(starts))[:most]]:
            found.append(made(fit.effects, problem, descend(problem, start), fit.converged, fit.alone))
    return min(found, key=lambda each: each.total)


def scattered(problem: Problem, rng: np.random.Generator) -> Array:
    """Chance points; half of them keep near 0 what may range from there over decades, such as a damping."""
    points = rng.uniform(size=(STARTS, problem.dimensions))
    near = (problem.lower == 0) & (rng.random((STARTS, 1)) < 0.5)
    return np.where(near, points**4, points)


def descend(problem: Problem, point: Array, most: int = 30) -> Array:
    """Levenberg-Marquardt in the cube on normal equations, all dampings tried in one batch; the point reached."""
    point = np.clip(point, 0, 1)
    loss, slow = problem.loss(point)[0], 0
    for _ in range(most if np.isfinite(loss) else 0):
        jacobian, residual = problem.jacobian(point), problem.residuals(point)[0]
        gradient, curvature = jacobian.T @ residual, jacobian.T @ jacobian
        free = ~(((point <= 0) & (gradient > 0)) | ((point >= 1) & (gradient < 0)))
        tries = np.array([stepped(point, gradient, curvature, free, damping) for damping in DAMPINGS])
        losses = problem.loss(tries)
        best = int(np.argmin(losses))
        if not losses[best] < loss:
            break
        slow = slow + 1 if losses[best] > (1 - 1e-4) * loss else 0
        point, loss = tries[best], losses[best]
        if slow == 3:
            break
    return point


def stepped(point: Array, gradient: Array, curvature: Array, free: NDArray[np.bool_], damping: float) -> Array:
    if not free.any():
        return point
    own = curvature[np.ix_(free, free)]
    scale = np.maximum(np.diag(own), 1e-12 * max(np.diag(own).max(), 1e-300))
    step = np.zeros(point.size)
    step[free] = -np.linalg.lstsq(own + damping * np.diag(scale), gradient[free], rcond=None)[0]
    return np.clip(point + np.clip(step, -0.3, 0.3), 0, 1)
