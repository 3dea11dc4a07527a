"""Values at which an effect is scored: steps of its amplitudes from the null, at values of its shape parameters."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from operator import itemgetter

import numpy as np
from numpy.typing import NDArray

from pzt_ident.diagnosis.projection import Projection, Split
from pzt_ident.model.registry import blocks
from pzt_ident.search.problem import Problem

Array = NDArray[np.float64]

ROUNDING = 1e-9  # of a step
MOST_SHAPES = 12  # beside which others are tried
TRIALS = 5  # values over the range of a parameter that means nothing at the null


@dataclass(frozen=True)
class Trial:
    """Free parameters in the user's units at an effect's null, and the steps that its amplitudes take from there.

    amplitudes and shapes: columns of the effect's parameters that have a null and of those that have none; size: the
    steps as a share of the way to the bounds.
    """

    size: float
    start: Array
    amplitudes: list[int]
    shapes: list[int]
    steps: Array

    def stepped(self, problem: Problem, usual: Array) -> Array:
        """One row for each step: (amplitudes, free). An axis without a step has its shape parameters from `usual`: they
        mean nothing there, and the axis is that of other trials."""
        axes = np.array([problem.model.entries[column].axis for column in problem.free])
        rows = np.tile(self.start, (len(self.amplitudes), 1))
        for row, amplitude, step in zip(rows, self.amplitudes, self.steps, strict=True):
            others = [i for i in self.shapes if axes[i] != axes[amplitude]]
            row[others] = usual[others]
            row[amplitude] += step
        return rows

    def shape(self, problem: Problem) -> dict[str, float]:
        """The shape parameters by name."""
        return {problem.names[i]: float(self.start[i]) for i in self.shapes}

    def one_sided(self, problem: Problem) -> NDArray[np.bool_]:
        """Of each amplitude, whether it may only grow."""
        return np.asarray(problem.lower[self.amplitudes] >= self.start[self.amplitudes])


class ShapesByAxis:
    """Trials in which each axis has the shape parameters that explain most there: axes with one effect, such as two
    gratings of one pitch and strokes of their own, need not have them at the same share of their ranges.

    left: norm of what no trial explains.
    """

    def __init__(self, projection: Projection, problem: Problem, left: float) -> None:
        self.projection, self.problem, self.least = projection, problem, left
        self.axes = [problem.model.entries[column].axis for column in problem.free]
        self.best: dict[str, tuple[float, Trial]] = {}

    def take(self, trial: Trial, signal: Split, traces: Split) -> None:
        """Take up a trial and its traces beside the signal, see `Projection.fit`."""
        owners = [self.axes[i] for i in trial.amplitudes]
        both = {self.axes[i] for i in trial.shapes} & set(owners)
        if len(both) < 2:
            return
        own = {axis: [row for row, owner in enumerate(owners) if owner == axis] for axis in sorted(both)}
        one_sided = trial.one_sided(self.problem)
        for axis, rows in own.items():
            least, _ = self.best.get(axis, (self.least, None))
            _, left = self.projection.fit(signal, traces[rows], one_sided[rows], least)
            if left < least:
                self.best[axis] = left, trial

    def __iter__(self) -> Iterator[Trial]:
        trials = [trial for _, trial in self.best.values()]
        if len({trial.start.tobytes() for trial in trials}) < 2:
            return
        start = trials[0].start.copy()
        for axis, (_, trial) in self.best.items():
            columns = [i for i in trial.shapes if self.axes[i] == axis]
            start[columns] = trial.start[columns]
        for size in sorted({trial.size for trial in trials}):
            yield replace(trials[0], size=size, start=start, steps=trials[0].steps * size / trials[0].size)


def planned_trials(
    effect: str,
    problem: Problem,
    known: Mapping[str, float],
    counts: Mapping[str, int],
    near: Sequence[Mapping[str, float]] = (),
) -> Iterator[Trial]:
    """A trial for each value of the shape parameters of an effect, see `parameter_grid`, and each size. known: the
    values of the other parameters, by name. counts: how many values of a parameter are tried, by its word."""
    new = [i for i, name in enumerate(problem.names) if name not in known]
    entries = {i: problem.model.entries[problem.free[i]] for i in new}
    nulls = {i: entry.parameter.null for i, entry in entries.items()}
    amplitudes = [i for i in new if nulls[i] is not None and entries[i].word not in counts]
    shapes = [i for i in new if i not in amplitudes]
    start = np.array([known.get(name, nulls.get(i) or 0) for i, name in enumerate(problem.names)], float)
    bounds = np.where(problem.upper != start, problem.upper, problem.lower)[amplitudes]
    full_steps = bounds - start[amplitudes]
    for values in parameter_grid(problem, shapes, counts, near):
        start[shapes] = values
        for size in blocks[effect].sizes:
            yield Trial(size, start.copy(), amplitudes, shapes, size * full_steps)


def trials_beside(
    effect: str, problem: Problem, known: Mapping[str, float], tried: Sequence[tuple[float, Trial]]
) -> Iterator[Trial]:
    """The planned trials beside the best of those that were tried when the first is asked for, less these. tried: what
    each leaves, and the trial."""
    best = sorted(tried, key=itemgetter(0))[:MOST_SHAPES]
    starts = {trial.start.tobytes() for _, trial in tried}
    shapes = [trial.shape(problem) for _, trial in best]
    if shapes:
        trials = planned_trials(effect, problem, known, blocks[effect].trials, shapes)
        yield from (trial for trial in trials if trial.start.tobytes() not in starts)


def parameter_grid(
    problem: Problem, columns: list[int], counts: Mapping[str, int], near: Sequence[Mapping[str, float]] = ()
) -> Iterator[tuple[float, ...]]:
    """Values of some parameters over their ranges, in the user's units; the same shares of the range on every axis.
    No frequency is above all sampling rates: what it does to a record is that of a lower one. near: values by name, of
    which one must be a step away at most, where there are any."""
    words = [problem.model.entries[problem.free[i]].word for i in columns]
    most = max(1 / record.dt for record in problem.records)
    above = np.array([most if problem.units[i] == "Hz" else np.inf for i in columns])
    number = {word: counts.get(word, TRIALS) for word in dict.fromkeys(words)}
    places, steps = places_of(problem, columns, near), np.array([1 / number[word] for word in words])
    for shares in product(*((np.arange(n) + 0.5) / n for n in number.values())):
        place = np.array([dict(zip(number, shares, strict=True))[word] for word in words])
        if len(near) and (np.abs(places - place) > (1 + ROUNDING) * steps).any(axis=1).all():
            continue
        point = np.full(problem.dimensions, 0.5)
        point[columns] = place
        values = problem.physical(point)[0][columns]
        if not (values > above).any():
            yield tuple(values)


def places_of(problem: Problem, columns: list[int], known: Sequence[Mapping[str, float]]) -> Array:
    """Where in their ranges values by name are, (values, columns); NaN for parameters that have none."""
    middle = dict(zip(problem.names, problem.physical(np.full(problem.dimensions, 0.5))[0].tolist(), strict=True))
    places = np.array([problem.unit_point(middle | {**values})[columns] for values in known])
    given = np.array([[problem.names[i] in values for i in columns] for values in known])
    return np.where(given, places, np.nan)
