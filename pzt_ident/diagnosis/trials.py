"""Values at which an effect is scored: steps of its amplitudes from the null, at values of its shape parameters."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from numpy.typing import NDArray

from pzt_ident.diagnosis.projection import Projection, Split, rotated
from pzt_ident.search.problem import Problem

Array = NDArray[np.float64]

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

    @property
    def stepped(self) -> Array:
        """One row for each step: (amplitudes, free)."""
        rows = np.tile(self.start, (len(self.amplitudes), 1))
        rows[np.arange(len(self.amplitudes)), self.amplitudes] += self.steps
        return rows

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
        """Take up a trial and its traces, see `Projection.fit`."""
        owners = [self.axes[i] for i in trial.amplitudes]
        both = {self.axes[i] for i in trial.shapes} & set(owners)
        if len(both) < 2:
            return
        signal, traces = rotated(signal, traces)
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


def parameter_grid(problem: Problem, columns: list[int], counts: Mapping[str, int]) -> Iterator[tuple[float, ...]]:
    """Values of some parameters over their ranges, in the user's units; the same shares of the range on every axis."""
    words = [problem.model.entries[problem.free[i]].word for i in columns]
    distinct = list(dict.fromkeys(words))
    for shares in product(*(((np.arange(n) + 0.5) / n) for n in (counts.get(word, TRIALS) for word in distinct))):
        point = np.full(problem.dimensions, 0.5)
        point[columns] = [shares[distinct.index(word)] for word in words]
        yield tuple(problem.physical(point)[0][columns])
