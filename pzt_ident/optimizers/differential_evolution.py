"""Differential evolution that adapts itself."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pzt_ident.registry import optimizers
from pzt_ident.search import Array, Generational, Search, setting


@optimizers.register
@dataclass(frozen=True)
class DifferentialEvolution(Generational):
    """L-SHADE: v = x + F (p - x) + F (r1 - r2), p one of the best, r2 also from the archive; binomial crossover.

    F and the crossover rate are drawn about values that made losses fall before; the population shrinks linearly to
    `smallest` over the budget.
    """

    source = "Tanabe & Fukunaga (2014), Proc. IEEE CEC, 1658"

    population: int = setting(70, "1", (4, 100_000), "Candidates in the first generation.")
    generations: int = setting(250, "1", (1, 10_000_000), "The budget is this many times the first population.")
    smallest: int = setting(4, "1", (4, 100_000), "Candidates in the last generation.")
    elite: float = setting(0.11, "1", (0, 1), "Share of the population that is one of the best.")
    memory: int = setting(6, "1", (1, 1000), "Length of the memory of what worked.")

    def search(self, dimensions: int, rng: np.random.Generator) -> Search:
        points = rng.random((self.population, dimensions))
        losses = (yield points.copy()).copy()
        archive = np.empty((0, dimensions))
        scale, rate = np.full(self.memory, 0.5), np.full(self.memory, 0.5)
        spent, slot = self.population, 0
        while True:
            count = len(points)
            chosen = rng.integers(self.memory, size=count)
            f = cauchy(scale[chosen], rng)
            cr = np.clip(rng.normal(rate[chosen], 0.1), 0, 1)
            trials = self.trials(points, losses, archive, f, cr, rng)
            found = yield trials
            trials, spent = trials[: len(found)], spent + len(found)
            better = np.flatnonzero(found < losses[: len(found)])
            if better.size:
                gain = np.minimum(losses[better] - found[better], 1e300)
                share = gain / gain.sum() if gain.sum() > 0 else np.full(better.size, 1 / better.size)
                scale[slot] = (share * f[better] ** 2).sum() / (share * f[better]).sum()
                rate[slot] = (share * cr[better]).sum()
                slot = (slot + 1) % self.memory
                archive = np.vstack([archive, points[better]])
                points[better], losses[better] = trials[better], found[better]
            keep = max(
                self.smallest, round(self.population - (self.population - self.smallest) * spent / self.evaluations)
            )
            order = np.argsort(losses, kind="stable")[: min(keep, count)]
            points, losses = points[order], losses[order]
            archive = archive[rng.permutation(len(archive))[: int(2.6 * len(points))]]

    def trials(
        self, points: Array, losses: Array, archive: Array, f: Array, cr: Array, rng: np.random.Generator
    ) -> Array:
        """current-to-pbest/1/bin with archive; a coordinate out of the cube goes half the way to the bound."""
        count, dimensions = points.shape
        best = np.argsort(losses, kind="stable")[: max(2, round(self.elite * count))]
        others = np.vstack([points, archive])
        one = (np.arange(count) + rng.integers(1, count, size=count)) % count
        two = rng.integers(len(others), size=count)
        pull = points[rng.choice(best, size=count)] - points
        mutants = points + f[:, None] * (pull + points[one] - others[two])
        mutants = np.where(mutants < 0, points / 2, np.where(mutants > 1, (points + 1) / 2, mutants))
        crossed = rng.random((count, dimensions)) < cr[:, None]
        crossed[np.arange(count), rng.integers(dimensions, size=count)] = True
        return np.where(crossed, mutants, points)


def cauchy(centre: Array, rng: np.random.Generator) -> Array:
    """Cauchy about the centre, drawn again where not positive, at most 1."""
    drawn = centre + 0.1 * rng.standard_cauchy(centre.size)
    while (wrong := drawn <= 0).any():
        drawn[wrong] = centre[wrong] + 0.1 * rng.standard_cauchy(int(wrong.sum()))
    return np.minimum(drawn, 1.0)
