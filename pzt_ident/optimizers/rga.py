"""Real-coded genetic algorithm."""

from __future__ import annotations

import random
from dataclasses import dataclass
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pzt_ident.libraries import modules
from pzt_ident.model.optimizer import Array, Generational, Search, choice, setting
from pzt_ident.model.registry import optimizers


class Fitness(NamedTuple):
    """The fitness that DEAP's operators read; larger is better."""

    values: tuple[float]


class Individual(NamedTuple):
    row: int
    fitness: Fitness


@optimizers.register
@dataclass(frozen=True)
class RGA(Generational):
    """Real-coded genetic algorithm: universal sampling, elites, arithmetic crossover, shrinking mutation, migration.

    Each subpopulation keeps its elites and replaces the others by children: the share `crossover` of them by
    v = eta v1 + (1 - eta) v2, the remaining ones by v = v1 + N(0, sigma_i^2),
    sigma_i = mutation (1 - shrink i / G), G the generations in the budget.
    """

    source = "Baker (1987), Proc. ICGA, 14; Lin & Lin (2012), Eq. 10-13"

    elites: int = setting(2, "1", (0, 1000), "Best individuals of each subpopulation that are kept unchanged.")
    crossover: float = setting(0.8, "1", (0, 1), "Share of the children from crossover.")
    mutation: float = setting(0.2, "range", (0, 10), "Standard deviation of the first mutation.")
    shrink: float = setting(1.0, "1", (0, 1), "Relative decrease of the mutation at the end of the budget.")
    shrink_form: str = choice("linear", ("linear", "recursion"), "Linear, or the product that Eq. 12 prints.")
    subpopulations: int = setting(2, "1", (1, 1000), "Subpopulations on a ring.")
    interval: int = setting(20, "1", (1, 1_000_000), "Generations between migrations.")
    fraction: float = setting(0.2, "1", (0, 1), "Share of a subpopulation that migrates.")

    def search(self, dimensions: int, rng: np.random.Generator) -> Search:
        points = rng.random((self.population, dimensions))
        losses = yield points.copy()
        demes = np.array_split(np.arange(self.population), self.subpopulations)
        sigma, generation = self.mutation, 0
        while True:
            generation += 1
            sigma = self.next_sigma(sigma, generation)
            if generation % self.interval == 0:
                order = migrate(losses, demes, self.fraction)
                points, losses = points[order], losses[order]
            children = []
            for deme in demes:
                deme[:] = deme[np.argsort(losses[deme], kind="stable")]
                children.append(self.breed(points[deme], losses[deme], sigma, rng))
            replaced = np.concatenate([deme[self.elites :] for deme in demes])
            points[replaced] = np.concatenate(children)
            losses[replaced] = yield points[replaced]

    def next_sigma(self, sigma: float, generation: int) -> float:
        """Eq. 12: sigma_i = sigma_(i-1) (1 - shrink i / G) as printed, or the linear fall that its text describes."""
        factor = max(0.0, 1 - self.shrink * generation / self.generations)
        return sigma * factor if self.shrink_form == "recursion" else self.mutation * factor

    def breed(self, points: Array, losses: Array, sigma: float, rng: np.random.Generator) -> Array:
        """The children of one subpopulation, sorted best first: (n, P) -> (n - elites, P)."""
        count = len(points) - self.elites
        crossed = round(self.crossover * count)
        parents = points[select(losses, crossed + count, rng)]
        eta = rng.random((crossed, 1))
        crossover = eta * parents[:crossed] + (1 - eta) * parents[crossed : 2 * crossed]
        mutants = parents[2 * crossed :] + sigma * rng.standard_normal((count - crossed, points.shape[1]))
        return np.clip(np.concatenate([crossover, mutants]), 0, 1)


def select(losses: Array, count: int, rng: np.random.Generator) -> NDArray[np.int64]:
    """Rows by stochastic universal sampling with fitness 1 / sqrt(rank), shuffled: DEAP's, with its draw, which takes
    ten times as long."""
    ends = _ends(len(losses))
    distance = ends[-1] / count
    start = random.Random(int(rng.integers(2**63))).uniform(0, distance)
    places = np.minimum(ends.searchsorted(start + distance * np.arange(count)), len(losses) - 1)
    return rng.permutation(losses.argsort(kind="stable")[places])


@cache
def _ends(count: int) -> Array:
    return np.cumsum(1 / np.sqrt(np.arange(1, count + 1)))


def migrate(losses: Array, demes: list[NDArray[np.int64]], fraction: float) -> NDArray[np.int64]:
    """Rows after migration: the best of each subpopulation replace the worst of the next one on the ring."""
    migration, selection = modules("deap.tools.migration", "deap.tools.selection")
    islands = [[Individual(int(row), Fitness((-losses[row],))) for row in deme] for deme in demes]
    moved = round(fraction * min(map(len, demes)))
    migration.migRing(islands, moved, selection.selBest, selection.selWorst)
    order = np.arange(len(losses))
    for deme, island in zip(demes, islands, strict=True):
        order[deme] = [individual.row for individual in island]
    return order
