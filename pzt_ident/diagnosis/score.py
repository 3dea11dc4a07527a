"""Which effect would explain the residual of a fit: scores by projection, without fitting anything.

The change of the response as an effect leaves its null, less the part that the fitted parameters can produce as well
(projected out along their derivatives), is compared with the residual.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import chain
from operator import itemgetter

import numpy as np
from numpy.typing import NDArray

from pzt_ident.diagnosis import misfit
from pzt_ident.diagnosis.baseline import Baseline, coarsest
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.cost import MOST_SIMULATIONS, has_many_trials, is_costly, simulations
from pzt_ident.diagnosis.fit import Fit
from pzt_ident.diagnosis.possible import fitting_forms
from pzt_ident.diagnosis.projection import Projection, Sets, Split
from pzt_ident.diagnosis.trials import MOST_SHAPES, ShapesByAxis, Trial, parameter_grid, planned_trials, trials_beside
from pzt_ident.model.block import Place
from pzt_ident.model.registry import blocks
from pzt_ident.search.problem import Problem

Array = NDArray[np.float64]

BATCH = 48  # candidates that are simulated together, of those that differ on one axis
LEAST_TRACE = 1e-9  # of the residual: less is rounding
LEAST_SCORE = 0.02  # of the misfit: an effect that scores less is not refitted
KEPT = 4  # scorers
FINER, MOST_SCALES = 0.93, 40  # from multiple to multiple of a trial's steps
AS_GOOD, MOST_GUESSES = 0.9, 4  # of the share explained by the best guess of a disturbance; guesses that are kept


@dataclass
class Score:
    """What the data say of an effect without a refit.

    explained: share of the misfit that the effect would remove if it were linear and without bounds;
    explained_in_bounds: the share within the bounds. guesses: expected parameters, in the user's `units`, the best
    first, and others of a disturbance that explain nearly as much. shapes: where an effect has many trials, its
    parameters without a null in those that explain at least half as much as the best. visibility: share of the effect's
    clearest trace, at the least size that leaves one, that the fitted parameters cannot produce. power: that share of
    the largest plausible trace, root mean square in noise floors.
    """

    effect: str
    explained: float = 0.0
    explained_in_bounds: float = 0.0
    guesses: list[dict[str, float]] = field(default_factory=list)
    units: dict[str, str] = field(default_factory=dict)
    shapes: list[dict[str, float]] = field(default_factory=list)
    visibility: float = 0.0
    power: float = 0.0

    @property
    def guess(self) -> dict[str, float]:
        """The best guess; empty where there is none."""
        return self.guesses[0] if self.guesses else {}


def enters_drive(item: str) -> bool:
    """Whether a form of an effect adds to the drive, ahead of all else."""
    return getattr(blocks[item], "place", None) == Place.SUPPLY


def scorer_of(case: Case, fit: Fit) -> Scorer:
    """The scorer of a fit; those of the last fits are kept: no effect is scored twice beside one of them."""
    scorer = next((item for item in case.scorers if item.fit is fit), None) or Scorer(case, fit)
    case.scorers = [scorer, *(item for item in case.scorers if item is not scorer)][:KEPT]
    return scorer


class Scorer:
    """The residual of a fit and the derivatives of its parameters, both over the scored samples. Traces of effects are
    those in coarser steps of the simulation where these change the response little."""

    def __init__(self, case: Case, fit: Fit) -> None:
        self.case, self.fit = case, fit
        self.fine = Baseline(case, fit, fit.steps)
        self.residual = self.fine.residual
        self.coarse = coarsest(case, fit, self.fine)
        self.projection = Projection(self.coarse.problem.jacobian(fit.point), fit.point, self.residual)
        self.left = float(self.projection.left(self.projection.signal)[0])
        self.misfit = squared_misfit(case, fit)
        self._scores: dict[str, Score] = {}

    def explained(self, left: float) -> float:
        """Share of the misfit that is gone where a residual of so large a norm is left."""
        return (self.left**2 - left**2) / self.misfit

    def scores(self, effect: str, in_every_form: bool = True) -> list[Score]:
        """The scores of an effect, the first form first, and of its other forms; of what is costly only where the first
        explains some, and near the shapes with which it does, unless it enters the drive, whose hysteresis the first
        form tells nothing of, and none that takes MOST_SIMULATIONS."""
        usual, *others = fitting_forms(self.case, self.fit.effects, effect)
        others = [item for item in others if in_every_form and simulations(self.case, item) < MOST_SIMULATIONS]
        first = self.score(usual)
        if first.explained <= LEAST_SCORE:
            costly = is_costly(blocks[effect])
            others = [item for item in others if enters_drive(item) or not (costly or is_costly(blocks[item]))]
        return [first, *(self.score(item, first.shapes) for item in others)]

    def score(self, effect: str, near: Sequence[Mapping[str, float]] = ()) -> Score:
        """The score of an effect. On axes without a response it acts as the effects of the fit do; if it is the first
        for which that matters, the better of both ways counts. near: shapes that are tried, by default all."""
        if effect not in self._scores:
            self._scores[effect] = self._best_score(effect, near)
        return self._scores[effect]

    def _best_score(self, effect: str, near: Sequence[Mapping[str, float]]) -> Score:
        case, fit, effects = self.case, self.fit, (*self.fit.effects, effect)
        first = case.unmeasured_nulls(effects) and not case.unmeasured_nulls(fit.effects)
        variants = (False, True) if first else (fit.measured_only,)
        baseline = self.fine if blocks[effect].amounts() else self.coarse
        models = (case.problem(effects, baseline.steps, measured_only) for measured_only in variants)
        problems = [model.along(*baseline.followed) for model in models]
        scores = [self._score(effect, problem, near) for problem in problems]
        return max(scores, key=lambda score: score.explained)

    def _score(self, effect: str, problem: Problem, near: Sequence[Mapping[str, float]]) -> Score:
        solved = blocks[effect].amounts()
        score = (self._score_disturbance if solved else self._score_block)(effect, problem, near)
        units = zip(problem.names, problem.units, strict=True)
        return replace(score, units={name: unit for name, unit in units if name in score.guess})

    def _score_block(self, effect: str, problem: Problem, near: Sequence[Mapping[str, float]]) -> Score:
        """The score of an effect in the chain, by the change of the response as it leaves its null."""
        score, least, strongest, order = Score(effect), self.left, 0.0, (np.inf, 0.0)
        clearest: Split | None = None
        guesses, tried = list[dict[str, float]](), list[tuple[float, Trial]]()
        by_axis, counts = ShapesByAxis(self.projection, problem, self.left), blocks[effect].trials
        known = self.fit.values
        plans: list[Iterable[Trial]] = [planned_trials(effect, problem, known, counts, near)]
        if has_many_trials(blocks[effect]) and not near:
            one_by_one = {word: count if count == max(counts.values()) else 1 for word, count in counts.items()}
            first = planned_trials(effect, problem, known, one_by_one)
            plans = [first, trials_beside(effect, problem, known, tried)]
        for trials, sets in chain.from_iterable(self._trials(problem, plan) for plan in (*plans, by_axis)):
            for number, trial in enumerate(trials):
                traces = sets.traces[number]
                norm = traces.norms.max()
                if norm > LEAST_TRACE * self.projection.signal.norms[0]:
                    place = (trial.size, -float(traces.norms_outside.max() / norm))
                    order, clearest = (place, traces) if place < order else (order, clearest)
                if trial.size == max(blocks[effect].sizes):
                    strongest = max(strongest, float(norm / trial.size / self.case.floor))
                by_axis.take(trial, sets.signals[number], traces)
            tried += zip(sets.least.tolist(), trials, strict=True)
            for number in np.argsort(sets.least, kind="stable"):
                if sets.least[number] >= least:
                    break
                trial = trials[number]
                one_sided = trial.one_sided(problem)
                if self.projection.fit(sets.signals[number], sets.traces[number], one_sided, least)[1] >= least:
                    continue
                amounts, left = self.projection.fit(*sets.exact(number), one_sided, least)
                if self.explained(left) > score.explained:
                    score.explained, least = self.explained(left), left
                    scales = scales_of(amounts) if score.explained > LEAST_SCORE else amounts[None]
                    guesses = [self._guess(problem, trial, multiples) for multiples in scales]
        if has_many_trials(blocks[effect]):
            good = [(left, trial) for left, trial in tried if 2 * self.explained(left) >= score.explained]
            score.shapes = [trial.shape(problem) for _, trial in sorted(good, key=itemgetter(0))[:MOST_SHAPES]]
        self._take_best_guess(score, problem, guesses)
        visibility = float(self.projection.left(clearest).max() / clearest.norms.max()) if clearest else 0.0
        return replace(score, visibility=visibility, power=visibility * strongest)

    def _take_best_guess(self, score: Score, problem: Problem, guesses: list[dict[str, float]]) -> None:
        """Put the guess of the least residual into the score, and what it explains within the bounds."""
        score.explained_in_bounds = score.explained
        score.guesses, least = guesses[:1], np.inf
        if len(guesses) > 1 or on_bound(problem, score.guess):
            known = self.fit.values
            points = np.array([[(known | guess)[name] for name in problem.names] for guess in guesses])
            least, guess = min(zip(self._left(problem, points), guesses, strict=True), key=itemgetter(0))
            score.guesses = [guess]
        if on_bound(problem, score.guess):
            score.explained_in_bounds = float(np.clip(self.explained(least), 0, score.explained))

    def _guess(self, problem: Problem, trial: Trial, amounts: Array) -> dict[str, float]:
        """The effect's parameters at multiples of the trial's steps, within their bounds."""
        values = trial.start.copy()
        values[trial.amplitudes] += amounts * trial.steps
        values = np.clip(values, problem.lower, problem.upper)
        return {problem.names[i]: float(values[i]) for i in (*trial.amplitudes, *trial.shapes)}

    def _left(self, problem: Problem, physical: Array) -> Array:
        """Norms of the residuals that are left at points (candidates, free) in the user's units, simulated and not
        linearised: (candidates,)."""
        return self.projection.left_of(self._residuals(problem, physical))

    def _trials(self, problem: Problem, planned: Iterable[Trial]) -> Iterator[tuple[list[Trial], Sets]]:
        """Trials side by side, and beside the residual the changes of the response by the steps of each, one of each
        amplitude."""
        trials = list(planned)
        axes = [problem.model.entries[problem.free[i]].axis for i in trials[0].amplitudes] if trials else []
        batch_size = max(1, BATCH // max(map(axes.count, axes), default=1))
        for first in range(0, len(trials), batch_size):
            batch = trials[first : first + batch_size]
            stepped = [trial.stepped(problem, trials[0].start) for trial in batch]
            residuals = self._residuals(problem, np.concatenate(stepped))
            held = np.isfinite(residuals[:, 0])  # all of those that failed are infinite
            count = len(trials[0].amplitudes)
            whole = np.asarray(held.reshape(-1, count).all(axis=1))
            if whole.any():
                traces = residuals if whole.all() else residuals[np.repeat(whole, count)]
                traces -= self.residual
                sets = self.projection.split_sets(traces, count)
                yield [trial for trial, kept in zip(batch, whole, strict=True) if kept], sets

    def _residuals(self, problem: Problem, physical: Array) -> Array:
        """(candidates, samples) at points (candidates, free) in the user's units, as if the steps were those of the
        fit."""
        points = [problem.unit_point(dict(zip(problem.names, row, strict=True))) for row in physical]
        residuals = problem.residuals(np.array(points))
        if tuple(record.steps for record in problem.records) != self.fit.steps:
            residuals += self.residual - self.coarse.residual
        return residuals

    def _score_disturbance(self, effect: str, problem: Problem, near: Sequence[Mapping[str, float]]) -> Score:
        """The score of an effect in amounts of each record, which are solved for and not stepped: at the guesses that
        its block makes from the residuals, one column after the other, else on a grid. near: as of `score`."""
        columns = [i for i, name in enumerate(problem.names) if name not in self.fit.problem.names]
        start = np.array([self.fit.values.get(name, 0.0) for name in problem.names])
        rough, shares = problem.rough(), dict[tuple[float, ...], float]()

        def take(tried: list[tuple[float, ...]]) -> None:
            if new := [values for values in dict.fromkeys(tried) if values not in shares]:
                points = np.tile(start, (len(new), 1))
                points[:, columns] = new
                shares.update(zip(new, map(self.explained, self._left(rough, points).tolist()), strict=True))

        if (options_of := self._guesses(effect, problem, columns)) is not None:
            if not any(options_of):
                return Score(effect)
            options_of = [options or [problem.lower[i]] for i, options in zip(columns, options_of, strict=True)]
            best = tuple(options[0] for options in options_of)
            for place, options in enumerate(options_of):
                take([(*best[:place], option, *best[place + 1 :]) for option in options])
                best = max(shares, key=shares.__getitem__)
        else:
            take(list(parameter_grid(problem, columns, blocks[effect].trials, near)))
        tried = sorted(shares, key=shares.__getitem__, reverse=True)
        if not tried:
            return Score(effect)
        share = max(shares[tried[0]], 0.0)
        close = [values for values in tried if shares[values] >= AS_GOOD * share > 0][:MOST_GUESSES]
        guesses = [{problem.names[i]: value for i, value in zip(columns, values, strict=True)} for values in close]
        return Score(effect, share, share, guesses, visibility=1.0, power=float("inf"))

    def _guesses(self, effect: str, problem: Problem, columns: list[int]) -> list[list[float]] | None:
        """Values of each of a disturbance's parameters, in the user's units, from the residuals of its axis, which may
        be too short for any; None where the block makes no guesses."""
        guess = getattr(blocks[effect], "guess", None)
        if not guess:
            return None
        measured, simulators = problem.model.measured, self.fit.problem.simulators["identify"]
        ends = np.cumsum([simulator.scored * len(measured) for simulator in simulators])
        residuals = [part.reshape(len(measured), -1) for part in np.split(self.residual, ends[:-1])]
        times = [simulator.record.elapsed[simulator.record.settle :] for simulator in simulators]
        drives = [simulator.record.drive[:, simulator.record.settle :] for simulator in simulators]
        guesses = []
        for i in columns:
            row = measured.index(problem.model.entries[problem.free[i]].axis)
            axis_drives = [drive[measured[row]] for drive in drives]
            axis_residuals = [residual[row] for residual in residuals]
            guesses.append(guess(times, axis_drives, axis_residuals, problem.lower[i], problem.upper[i]).tolist())
        return guesses


def scales_of(amounts: Array) -> Array:
    """Multiples of the steps of a trial that may be the guess: those that are best if the effect is linear, and the
    steps themselves; far below these, all that lie between, since a limit is felt from some size on. (scales,
    amplitudes)."""
    shrunk = np.where((amounts > 0) & (amounts < 1), amounts, 1.0)
    count = min(1 + int(np.log(shrunk.min()) / np.log(FINER)), MOST_SCALES)
    return np.vstack([amounts, shrunk ** np.linspace(0, 1, count, endpoint=False)[:, None]])


def on_bound(problem: Problem, guess: Mapping[str, float]) -> bool:
    """Whether a value of a guess is at an end of its range which is not its null."""
    columns = [problem.names.index(name) for name in guess]
    nulls = [problem.model.entries[problem.free[i]].parameter.null for i in columns]
    at_end = [value in (problem.lower[i], problem.upper[i]) for i, value in zip(columns, guess.values(), strict=True)]
    return any(end and value != null for end, value, null in zip(at_end, guess.values(), nulls, strict=True))


def squared_misfit(case: Case, fit: Fit) -> float:
    """That of a fit on the identification records."""
    return misfit.squared_misfit(fit.identify, case.floor)
