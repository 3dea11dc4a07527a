"""Fits of a job's model and of the model with effects added, accurate enough to blame the residual on the model."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import cached_property, partial
from itertools import product
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.noise import error_scales, noise_floor, pooled_floor
from pzt_ident.data.record import Record
from pzt_ident.diagnosis.budget import BEHIND, PROVING, WHOLE, Budget
from pzt_ident.engine.simulator import Simulator
from pzt_ident.model.block import Coupling
from pzt_ident.model.chain import Chain
from pzt_ident.model.registry import Choice, blocks, word_of
from pzt_ident.search.cube import FixedValue, ParameterSpec
from pzt_ident.search.descent import descend
from pzt_ident.search.problem import Problem
from pzt_ident.search.uncertainty import Estimate, estimates

Array = NDArray[np.float64]
Item = TypeVar("Item")
Result = TypeVar("Result")
Listener = Callable[[dict[str, Any]], None]

THREADS = max(2, min(6, os.cpu_count() or 2))  # that fit and score effects side by side
EDGE = 1e-4  # of a parameter's range: nearer to a bound it is on it, if the model is no worse there
NO_WORSE = 1e-3  # of the loss
STEP_TOLERANCE = 0.05  # of the noise floor, or of what a fit leaves if that is more: a step is halved that changes more
FINEST = 8  # steps per sample


class Case:
    """A model, its records and its parameter specifications; effects that are not ruled out can be added to it.

    `on_event` is called, from any thread, with every fitted start, scored effect and refitted model; errors are in
    units of the loss. `base_problem` is the problem of the model without further effects, if it exists already.
    `budget` has no end unless it is set.
    """

    def __init__(
        self,
        words: Sequence[str | Choice],
        effects: Sequence[str],
        records: Sequence[Record],
        specs: Any,
        ruled_out: Sequence[str] = (),
        shared: Sequence[str] = (),
        on_event: Listener = lambda event: None,
        base_problem: Problem | None = None,
    ) -> None:
        self.on_event, self._base_problem, self.budget = on_event, base_problem, Budget()
        self.words, self.effects = tuple(words), tuple(effects)
        self.ruled_out, self.shared = tuple(ruled_out), tuple(shared)
        self._resampled: dict[tuple[int, int], Record] = {}
        self.refits: dict[Any, Fit] = {}  # by effects, steps and start
        self.scorers: list[Any] = []  # of the fits that were diagnosed last
        self.records, self.specs, self.error_scales = tuple(records), specs, error_scales(list(records))

    def with_specs(self, specs: Mapping[str, ParameterSpec]) -> Case:
        """The same case with other specifications of some parameters, by their names in the job."""
        return self._altered(self.words, {**self.specs, **specs})

    def with_words(self, words: Sequence[str | Choice]) -> Case:
        """The same case with other blocks."""
        return self._altered(words, self.specs)

    def _altered(self, words: Sequence[str | Choice], specs: Any) -> Case:
        other = Case(words, self.effects, self.records, specs, self.ruled_out, self.shared, self.on_event)
        other._resampled, other.budget = self._resampled, self.budget
        other.error_scales, other.floor = self.error_scales, self.floor
        return other

    def problem(self, effects: Sequence[str], steps: Sequence[int] = (), measured_only: bool = False) -> Problem:
        """steps: simulation steps per sample of each record, by default those of the job; `measured_only` as in
        `Fit`."""
        if self._base_problem and (tuple(effects), tuple(steps), measured_only) == (self.effects, (), False):
            return self._base_problem
        first = self.records[0]
        chain = blocks.chain((*self.words, *effects))
        nulls = self.unmeasured_nulls(effects) if measured_only else {}
        specs = {name: FixedValue(null) for name, null in nulls.items()} | self.specs
        model = Chain(chain, first.axes, first.measured, self.shared, specs)
        counts = steps or [record.steps for record in self.records]
        records = [self.record_with_steps(number, count) for number, count in enumerate(counts)]
        return Problem(model, records, specs, self.error_scales)

    def unmeasured_nulls(self, effects: Sequence[str]) -> dict[str, float]:
        """Parameters, by name, that switch the added effects off on axes without a response: their nulls there, in the
        user's units. Empty where no coupling lets a response depend on such an axis."""
        first, chain = self.records[0], blocks.chain((*self.words, *effects))
        if not any(issubclass(block, Coupling) for block in chain):
            return {}
        unmeasured = [axis for number, axis in enumerate(first.axes) if number not in first.measured]
        added = {word_of(item) for item in effects if item not in self.effects}
        return {
            f"{axis}.{block.name}.{word}": parameter.null
            for axis, block in product(unmeasured, chain)
            for word, parameter in block.parameters().items()
            if {block.name, word_of(parameter.effect or "")} & added
            and parameter.null is not None
            and Chain.allowed_without_response(block, parameter)
            if f"{block.name}.{word}" not in (*self.shared, *self.specs)
        }

    def words_of(self, fit: Fit) -> tuple[str | Choice, ...]:
        """The blocks of this case that are in the model of a fit, which may do without some."""
        names = {block.name for block in fit.problem.model.blocks}
        return tuple(item for item in self.words if word_of(item) in names)

    def record_with_steps(self, number: int, steps: int) -> Record:
        """A record simulated in so many steps per sample; always the same object, so that its signals are prepared
        once."""
        return self._resampled.setdefault((number, steps), replace(self.records[number], steps=steps))

    def descend(self, problem: Problem, point: Array, rival: float = np.inf) -> Array:
        """The point that few steps reach while the budget lasts, of which a descent behind a rival gets no more than a
        part, see `search.descent`."""
        part = self.budget.part(BEHIND)
        return descend(problem, point, going=self.budget.lasts, rival=rival, patient=lambda: not part.spent(WHOLE))

    @cached_property
    def floor(self) -> float:
        """Noise floor of all measured axes together, in units of the loss."""
        return pooled_floor(list(self.records))

    @cached_property
    def floors(self) -> Array:
        """Noise floor of each measured axis, in units of the loss: (measured axes,)."""
        records = list(self.records)
        floors = [noise_floor(records, axis).value for axis in records[0].measured]
        return np.asarray(floors / error_scales(records))


@dataclass(frozen=True)
class Fit:
    """A model with its effects at its best point; `identify` and `validate` are RMSE in units of the loss, `validate`
    None without validation records. `measured_only`: the added effects act on the measured axes only."""

    effects: tuple[str, ...]
    problem: Problem
    point: Array
    identify: float
    validate: float | None
    converged: bool = True
    measured_only: bool = False

    @property
    def freedom(self) -> int:
        """Number of free parameters, with those of which each record has its own."""
        model = self.problem.model
        added = len(model.measured) * sum(block.amounts() for block in model.additions)
        return self.problem.dimensions + len(model.amounts) + added

    @property
    def total(self) -> float:
        """RMSE of both uses together: the criterion by which fits are ranked."""
        errors = [error for error in (self.identify, self.validate) if error is not None]
        return float(np.sqrt(np.mean(np.square(errors))))

    @cached_property
    def by_use(self) -> Array:
        """RMSE of each use, that of the identification records first, and measured axis, in units of the loss: (uses,
        measured axes)."""
        uses = [use for use, error in (("identify", self.identify), ("validate", self.validate)) if error is not None]
        return np.array([self.problem.by_axis(self.point[None], use)[0] / self.problem.sizes for use in uses])

    @property
    def by_axis(self) -> Array:
        """RMSE of both uses together of each measured axis, in units of the loss: (measured axes,)."""
        return np.asarray(np.sqrt(np.mean(np.square(self.by_use), axis=0)))

    @cached_property
    def on_bounds(self) -> tuple[str, ...]:
        """Names of the parameters that ended on a bound, but for those whose range ends there of itself."""
        problem, values = self.problem, self.problem.physical(self.point)[0]
        parameters = [problem.model.entries[column].parameter for column in problem.free]
        rows = zip(problem.names, self._at_edges, values, parameters, strict=True)
        return tuple(name for name, edge, value, parameter in rows if edge and not parameter.ends_at(value))

    @property
    def _at_edges(self) -> NDArray[np.bool_]:
        """Which parameters are on a bound or so near that the model is no worse there: (free,)."""
        bounds = np.round(self.point)
        edges = np.abs(self.point - bounds) <= EDGE
        if (near := np.flatnonzero(edges & (self.point != bounds))).size:
            there = np.tile(self.point, (near.size, 1))
            there[range(near.size), near] = bounds[near]
            edges[near] = self.problem.loss(there) <= (1 + NO_WORSE) * self.identify
        return edges

    @property
    def steps(self) -> tuple[int, ...]:
        """Simulation steps per sample of each record."""
        return tuple(record.steps for record in self.problem.records)

    @property
    def values(self) -> dict[str, float]:
        """The free parameters by name, in the user's units."""
        return dict(zip(self.problem.names, self.problem.physical(self.point)[0].tolist(), strict=True))

    def estimates(self, budget: Budget | None = None) -> list[Estimate]:
        """What the data determine of the parameters: by the curvature of the loss, and with a budget by as many
        profiles of it as that suffices for."""
        word = "profiled" if budget else "curved"
        if word not in self.__dict__:
            going = partial(budget.allows, "intervals by profiles", PROVING) if budget else lambda: False
            self.__dict__[word] = estimates(self.problem, self.point, going)[0]
        return list(self.__dict__[word])


def side_by_side(function: Callable[[Item], Result], items: Iterable[Item]) -> Iterator[Result]:
    """The function of each item, in order, from threads that are as silent about floating point as the caller's."""
    with ThreadPoolExecutor(THREADS, initializer=partial(np.seterr, **np.geterr())) as pool:
        yield from pool.map(function, items)


def fit_at(
    effects: tuple[str, ...], problem: Problem, point: Array, converged: bool = True, measured_only: bool = False
) -> Fit:
    """The fit that a point is, with its errors."""
    loss = float(problem.loss(point, "validate")[0])
    validate = None if np.isnan(loss) else loss
    return Fit(effects, problem, point, float(problem.loss(point)[0]), validate, converged, measured_only)


def refit(case: Case, before: Fit, effects: tuple[str, ...], guess: dict[str, float], rival: float = np.inf) -> Fit:
    """The model with other effects, started from the parameters of the fit `before` and from a guess (user's units) of
    the new ones. The new effects act on all axes or on the measured ones only, whichever fits better. rival: an RMSE
    that a refit which stays far above it is given up for."""
    problem = case.problem(effects, before.steps)
    point = start_of(problem, before, guess)
    key = (effects, before.steps, point.tobytes(), rival)
    if key not in case.refits:
        case.refits[key] = _best_of_axes(case, before, effects, problem, point, rival)
    fit = case.refits[key]
    case.on_event({"event": "refitted", "effects": effects, "identify": fit.identify, "validate": fit.validate})
    return fit


def refit_from(
    case: Case, before: Fit, effects: tuple[str, ...], guesses: Sequence[dict[str, float]], rival: float = np.inf
) -> Fit:
    """The best of the refits from each guess, one after the other."""
    fits: list[Fit] = []
    for guess in guesses or [{}]:
        fits.append(refit(case, before, effects, guess, min([rival, *(fit.identify for fit in fits)])))
    return min(fits, key=lambda fit: fit.total)


def refit_beside(
    case: Case, fits: Sequence[Fit], effects: tuple[str, ...], guess: dict[str, float], rival: float = np.inf
) -> Fit:
    """The refit from the fit whose parameters leave least with the guess."""
    problem = case.problem(effects, fits[0].steps)
    losses = problem.loss(np.array([start_of(problem, fit, guess) for fit in fits]))
    return refit(case, fits[int(np.argmin(losses))], effects, guess, rival)


def start_of(problem: Problem, before: Fit, guess: dict[str, float]) -> Array:
    """The point of the guess, of the fit `before` for other parameters, and of the middle of the range of the rest."""
    known, middle = before.values, problem.physical(np.full(problem.dimensions, 0.5))[0]
    return problem.unit_point(
        {name: guess.get(name, known.get(name, middle[i])) for i, name in enumerate(problem.names)}
    )


def _best_of_axes(
    case: Case, before: Fit, effects: tuple[str, ...], problem: Problem, start: Array, rival: float
) -> Fit:
    """The better of the fits with the effects on all axes and on the measured ones only, where the two differ."""
    variants = [(problem, False)]
    if case.unmeasured_nulls(effects):
        restricted = case.problem(effects, before.steps, True)
        if residuals_differ(case, problem.residuals(start)[0], restricted.residuals(start)[0]):
            variants.append((restricted, True))
    fits = [
        refine_steps(
            case, fit_at(effects, variant, case.descend(variant, start, rival), measured_only=measured_only), rival
        )
        for variant, measured_only in variants
    ]
    return min(fits, key=lambda fit: fit.total)


def residuals_differ(case: Case, one: Array, other: Array) -> bool:
    """Whether two residuals differ by more than halving the simulation's step may change."""
    return bool(np.linalg.norm(one - other) > STEP_TOLERANCE * case.floor)


def refine_steps(
    case: Case, fit: Fit, rival: float = np.inf, fine: bool = False, checked: Sequence[int] | None = None
) -> Fit:
    """The fit, continued with finer simulation steps for the records where halving the step changes the response by
    more than a part of what the fit leaves, or of the noise; `fine`: of the noise even where the fit leaves more.
    checked: the numbers of the records in question, by default of all.

    Where the drive is linear between samples, the signals between blocks are taken as linear too.
    """
    most = STEP_TOLERANCE * (case.floor if fine else max(case.floor, fit.identify))
    numbers = [n for n in (range(len(fit.steps)) if checked is None else checked) if fit.steps[n] < FINEST]
    coarse = [n for n, error in zip(numbers, step_errors(case, fit, numbers), strict=True) if error > most]
    if not coarse:
        return fit
    steps = [count * (2 if n in coarse else 1) for n, count in enumerate(fit.steps)]
    problem = case.problem(fit.effects, steps, fit.measured_only)
    point = case.descend(problem, fit.point, rival)
    finer = fit_at(fit.effects, problem, point, fit.converged, fit.measured_only)
    return refine_steps(case, finer, rival, fine, coarse)


def step_errors(case: Case, fit: Fit, numbers: Iterable[int] | None = None) -> Array:
    """Change of the response of records, by default of all, when the simulation step is halved, root mean square, in
    units of the loss: (records,)."""
    problem, errors = fit.problem, []
    theta = problem.parameters(fit.point)
    for number in range(len(problem.records)) if numbers is None else numbers:
        record = problem.records[number]
        halved = case.record_with_steps(number, 2 * record.steps)
        coarse, fine = (Simulator(problem.model, stepped).simulate(theta)[0] for stepped in (record, halved))
        change = (fine - coarse)[:, record.settle :] / problem.sizes[:, None]
        errors.append(np.sqrt(np.mean(np.var(change, axis=1))))
    return np.array(errors)
