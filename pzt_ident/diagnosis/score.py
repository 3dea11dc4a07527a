"""Which effect would explain what the model leaves: projected scores, without fitting anything.

For each effect the change of the response as it leaves its null, less what the fitted parameters could do as well
(projection out of their derivatives), is held against the residual.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from itertools import product

import numpy as np
from numpy.typing import NDArray

from pzt_ident.diagnosis.refit import Case, Fit
from pzt_ident.model.block import Addition, Coupling, Term
from pzt_ident.model.registry import blocks
from pzt_ident.search.problem import Problem

Array = NDArray[np.float64]

BATCH = 48  # candidates that are simulated together
TRACE = 1e-9  # of what is left: less is rounding
TRIALS = 5  # values over the range of a parameter that means nothing at the null


@dataclass
class Score:
    """What the data say of an effect without a refit. `guess` in the user's `units`; `explained` as if there were no
    bounds, which may be too narrow, and `within` them; `visibility` is the share of its trace, at the least size that
    leaves one, that the fitted parameters cannot take up, `power` that share of the largest plausible rms, in noise
    floors."""

    effect: str
    explained: float = 0.0
    within: float = 0.0
    guess: dict[str, float] = field(default_factory=dict)
    units: dict[str, str] = field(default_factory=dict)
    visibility: float = 0.0
    power: float = 0.0
    trace: Array = field(default_factory=lambda: np.zeros(0), repr=False)


@dataclass(frozen=True)
class Trial:
    """Free parameters in the user's units at an effect's null, and the steps of those that grow from it."""

    size: float
    start: Array
    growing: list[int]
    shapes: list[int]
    steps: Array

    @property
    def moved(self) -> Array:
        """One row for each step: (growing, free)."""
        rows = np.tile(self.start, (len(self.growing), 1))
        rows[np.arange(len(self.growing)), self.growing] += self.steps
        return rows


def applicable(case: Case, effects: tuple[str, ...]) -> list[str]:
    """The effects that this model can take and does not have."""
    chain = blocks.chain((*case.words, *effects))
    terms = {parameter.effect for block in chain for parameter in block.parameters().values()}
    axes = len(case.records[0].axes)
    found = []
    for word in blocks.effects():
        block = blocks[word]
        fits = (not issubclass(block, Term) or word in terms) and (not issubclass(block, Coupling) or axes > 1)
        if fits and word not in (*effects, *case.ruled_out):
            found.append(word)
    return found


class Scorer:
    """The residual of a fit and what its parameters could have done, both over the scored samples."""

    def __init__(self, case: Case, fit: Fit) -> None:
        self.case, self.fit = case, fit
        jacobian = fit.problem.jacobian(fit.point)
        size = np.linalg.norm(jacobian, axis=0)
        u, s, _ = np.linalg.svd(jacobian / np.where(size > 0, size, 1), full_matrices=False)
        self.basis = u[:, s > 1e-7 * s.max(initial=1e-300)]
        self.raw = fit.problem.residuals(fit.point)[0]
        self.residual = self.project(self.raw)
        self.misfit = misfit(case, fit)

    def project(self, signals: Array) -> Array:
        return signals - self.basis @ (self.basis.T @ signals)

    def score(self, effect: str) -> Score:
        """The best of the ways in which the effect may act on axes without a response: as the effects of the fit do."""
        case, fit, effects = self.case, self.fit, (*self.fit.effects, effect)
        new = case.silent(effects) and not case.silent(fit.effects)
        ways = (False, True) if new else (fit.alone,)
        found = [self._score(effect, case.problem(effects, fit.steps, alone)) for alone in ways]
        return max(found, key=lambda score: score.explained)

    def _score(self, effect: str, problem: Problem) -> Score:
        found = (self._addition if issubclass(blocks[effect], Addition) else self._growth)(effect, problem)
        units = zip(problem.names, problem.units, strict=True)
        return replace(found, units={name: unit for name, unit in units if name in found.guess})

    def _growth(self, effect: str, problem: Problem) -> Score:
        """What the response does as the effect leaves its null."""
        found, visible, most = Score(effect), dict[float, float](), 0.0
        guesses: list[dict[str, float]] = []
        for trial, columns in self._trials(effect, problem):
            trace = self.project(columns.T)
            left_over, whole = np.linalg.norm(trace, axis=0).max(), np.linalg.norm(columns, axis=1).max()
            if whole > TRACE * np.linalg.norm(self.raw):
                visible[trial.size] = max(visible.get(trial.size, 0.0), float(left_over / whole))
            if trial.size == max(blocks[effect].sizes):
                most = max(most, float(whole / trial.size / self.case.floor))
            amounts = self._amounts(trace, problem.lower[trial.growing] >= trial.start[trial.growing])
            left = self.residual + trace @ amounts
            explained = (self.residual @ self.residual - left @ left) / self.misfit
            if explained > found.explained:
                found.explained, found.trace = float(explained), trace @ amounts
                guesses = [self._scaled(problem, trial, each) for each in (amounts, np.ones(amounts.size))]
        lefts = [(self._left(problem, guess), guess) for guess in guesses]
        least, found.guess = min(lefts, key=lambda pair: pair[0], default=(0.0, {}))
        found.within = found.explained
        if on_bound(problem, found.guess):
            reached = (self.residual @ self.residual - least**2) / self.misfit
            found.within = float(np.clip(reached, 0, found.explained))
        share = visible[min(visible)] if visible else 0.0
        return replace(found, visibility=share, power=share * most)

    def _amounts(self, trace: Array, one_sided: NDArray[np.bool_]) -> Array:
        """How much of each trace fits best, as if the effect were linear; none where the bounds allow no way back, as
        for a damping of one axis where that of another is missing."""
        amounts, free = np.zeros(trace.shape[1]), np.ones(trace.shape[1], dtype=bool)
        while free.any():
            amounts[~free] = 0
            amounts[free] = np.linalg.lstsq(trace[:, free], -self.residual, rcond=1e-8)[0]
            if not (one_sided & (amounts < 0)).any():
                return amounts
            free &= ~(one_sided & (amounts < 0))
        return np.zeros(trace.shape[1])

    def _scaled(self, problem: Problem, trial: Trial, amounts: Array) -> dict[str, float]:
        values = trial.start.copy()
        values[trial.growing] += amounts * trial.steps
        values = np.clip(values, problem.lower, problem.upper)
        return {problem.names[i]: float(values[i]) for i in (*trial.growing, *trial.shapes)}

    def _left(self, problem: Problem, guess: dict[str, float]) -> float:
        """What a guess leaves, as it is and not as if the effect were linear."""
        known = self.fit.values | guess
        values = np.array([known[name] for name in problem.names])
        return float(np.linalg.norm(self.project(self._residuals(problem, values[None])[0])))

    def _trials(self, effect: str, problem: Problem) -> Iterator[tuple[Trial, Array]]:
        """Each size and shape, and the traces (growing, samples) of what grows from its null."""
        trials = list(self._planned(effect, problem))
        each = max(1, BATCH // max(1, len(trials[0].growing)))
        for first in range(0, len(trials), each):
            some = trials[first : first + each]
            moved = self._residuals(problem, np.concatenate([trial.moved for trial in some]))
            for trial, own in zip(some, np.split(moved, len(some)), strict=True):
                if np.isfinite(own).all():
                    yield trial, own - self.raw

    def _planned(self, effect: str, problem: Problem) -> Iterator[Trial]:
        new = [i for i, name in enumerate(problem.names) if name not in self.fit.problem.names]
        nulls = {i: problem.model.entries[problem.free[i]].parameter.null for i in new}
        growing = [i for i in new if nulls[i] is not None]
        shapes = [i for i in new if i not in growing]
        old = self.fit.values
        start = np.array([old.get(name, nulls.get(i) or 0) for i, name in enumerate(problem.names)], float)
        ends = np.where(problem.upper != start, problem.upper, problem.lower)[growing] - start[growing]
        for values in spread(problem, shapes, blocks[effect].trials):
            start[shapes] = values
            for size in blocks[effect].sizes:
                yield Trial(size, start.copy(), growing, shapes, size * ends)

    def _residuals(self, problem: Problem, physical: Array) -> Array:
        return problem.residuals(
            np.array([problem.unit_point(dict(zip(problem.names, row, strict=True))) for row in physical])
        )

    def _addition(self, effect: str, problem: Problem) -> Score:
        """What a record may add of its own is not in the chain: what it leaves says all."""
        found, block = Score(effect), blocks[effect]
        shapes = [i for i, name in enumerate(problem.names) if name not in self.fit.problem.names]
        old = self.fit.values
        guess = getattr(block, "guess", None)
        trials: Iterator[tuple[float, ...]] = spread(problem, shapes, block.trials)
        simulators = self.fit.problem.simulators["identify"]
        if guess:
            measured = problem.model.measured
            parts = np.split(self.raw, np.cumsum([simulator.scored * len(measured) for simulator in simulators])[:-1])
            times = [simulator.record.time[simulator.record.settle :] for simulator in simulators]
            drives = [simulator.record.drive[:, simulator.record.settle :] for simulator in simulators]
            own = [measured.index(problem.model.entries[problem.free[i]].axis) for i in shapes]
            lines = [[part.reshape(len(measured), -1)[axis] for part in parts] for axis in own]
            bounds = [(problem.lower[i], problem.upper[i]) for i in shapes]
            axes = [[drive[measured[axis]] for drive in drives] for axis in own]
            each = zip(axes, lines, bounds, strict=True)
            trials = product(*(guess(times, axis, line, *bound) for axis, line, bound in each))
        for values in trials:
            start = np.array([old.get(name, 0.0) for name in problem.names])
            start[shapes] = values
            left = self.project(self._residuals(problem, start[None])[0])
            explained = (self.residual @ self.residual - left @ left) / self.misfit
            if explained > found.explained:
                found.explained, found.trace = float(explained), left - self.residual
                found.guess = {problem.names[i]: float(value) for i, value in zip(shapes, values, strict=True)}
        found.within, found.visibility, found.power = found.explained, 1.0, float("inf")
        return found


def on_bound(problem: Problem, guess: Mapping[str, float]) -> bool:
    """Whether a value of a guess is at an end of its range which is not its null."""
    places = [problem.names.index(name) for name in guess]
    nulls = [problem.model.entries[problem.free[i]].parameter.null for i in places]
    ends = [value in (problem.lower[i], problem.upper[i]) for i, value in zip(places, guess.values(), strict=True)]
    return any(end and value != null for end, value, null in zip(ends, guess.values(), nulls, strict=True))


def misfit(case: Case, fit: Fit) -> float:
    """Mean square above the noise floor; where it is lost in the noise, the least that could be told from it."""
    return max(fit.identify**2 - case.floor**2, (0.3 * case.floor) ** 2)


def spread(problem: Problem, columns: list[int], counts: Mapping[str, int]) -> Iterator[tuple[float, ...]]:
    """Values of parameters over their ranges, in the user's units; on each axis the same share of them."""
    words = [problem.model.entries[problem.free[i]].word for i in columns]
    own = list(dict.fromkeys(words))
    for shares in product(*(((np.arange(n) + 0.5) / n) for n in (counts.get(word, TRIALS) for word in own))):
        point = np.full(problem.dimensions, 0.5)
        point[columns] = [shares[own.index(word)] for word in words]
        yield tuple(problem.physical(point)[0][columns])
