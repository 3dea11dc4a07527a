"""Covariance matrix adaptation."""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass

import numpy as np

from pzt_ident.model.optimizer import Array, Budgeted, Search, setting
from pzt_ident.model.registry import optimizers


@optimizers.register
@dataclass(frozen=True)
class CMAES(Budgeted):
    """CMA-ES of pycma, restarted when it has converged: x ~ m + sigma N(0, C), C learned from the better half.

    Restarts alternate between doubled populations and small ones with a smaller sigma, with about the same number of
    evaluations for both kinds (BIPOP).
    """

    source = "Hansen & Ostermeier (2001), Evol. Comput. 9, 159; Hansen (2009), BBOB workshop, BIPOP"

    population: int = setting(0, "1", (0, 100_000), "Candidates in a generation of the first start; 0: 4 + 3 ln P.")
    sigma: float = setting(0.3, "range", (1e-6, 1), "Standard deviation of the first generation.")

    def search(self, dimensions: int, rng: np.random.Generator) -> Search:
        first = self.population or 4 + int(3 * np.log(dimensions))
        spent = {"large": 0, "small": 0}
        large = first
        spent["large"] += yield from self.start(np.full(dimensions, 0.5), self.sigma, first, rng)
        while True:
            if spent["large"] <= spent["small"]:
                large *= 2
                spent["large"] += yield from self.start(rng.random(dimensions), self.sigma, large, rng)
            else:
                small = int(first * (0.5 * large / first) ** (rng.random() ** 2))
                sigma = self.sigma * 10 ** (-2 * rng.random())
                spent["small"] += yield from self.start(rng.random(dimensions), sigma, max(small, first), rng)

    def start(
        self, mean: Array, sigma: float, population: int, rng: np.random.Generator
    ) -> Generator[Array, Array, int]:
        """One run of pycma until it has converged; returns the evaluations it took."""
        import cma

        settings = {"bounds": [0, 1], "popsize": population, "randn": lambda *size: rng.standard_normal(size)}
        quiet = {"seed": np.nan, "verbose": -9, "verb_log": 0, "verb_disp": 0, "tolflatfitness": 5}
        # pycma needs at least two coordinates: a single one is searched with a dummy.
        dummies = 2 - min(mean.size, 2)
        strategy = cma.CMAEvolutionStrategy(np.append(mean, [0.5] * dummies), sigma, settings | quiet)
        spent = 0
        while not strategy.stop():
            candidates = strategy.ask()
            points = np.clip([candidate[: mean.size] for candidate in candidates], 0, 1)
            losses = yield points
            spent += len(points)
            strategy.tell(candidates, list(finite_losses(losses)))
        return spent


def finite_losses(losses: Array) -> Array:
    """The losses with failures just above the worst success, since pycma averages losses."""
    finite = losses[np.isfinite(losses)]
    worst = finite.max() if finite.size else 0.0
    return np.where(np.isfinite(losses), losses, worst + abs(worst) + 1.0)
