"""Differential evolution that adapts its own settings (L-SHADE)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pzt_ident.model.optimizer import Array, Generational, Search, setting
from pzt_ident.model.registry import optimizers


@optimizers.register
@dataclass(frozen=True)
class DifferentialEvolution(Generational):
    """Differential evolution, current-to-pbest/1/bin: v = x + F (p - x) + F (r1 - r2), F and CR learned (L-SHADE).

    p is one of the best `greed` share, r2 may come from the archive of replaced parents, and the population falls
    linearly to 4 over the budget.
    """

    source = "Tanabe & Fukunaga (2014), Proc. IEEE CEC, 1658"

    population: int = setting(35, "1", (4, 100_000), "Candidates in the first generation.")
    generations: int = setting(500, "1", (1, 10_000_000), "The budget is this many times the population.")
    memory: int = setting(6, "1", (1, 1000), "Number of remembered pairs of successful F and CR.")
    archive: float = setting(2.6, "1", (0, 10), "Size of the archive over the population.")
    greed: float = setting(0.11, "1", (0, 1), "Share of the population that counts as best.")

    def search(self, dimensions: int, rng: np.random.Generator) -> Search:
        points = rng.random((self.population, dimensions))
        losses = yield points.copy()
        archive = points[:0]
        scale, cross, entry, used = np.full(self.memory, 0.5), np.full(self.memory, 0.5), 0, len(points)
        while True:
            order = np.argsort(losses, kind="stable")[: self.survivors(used)]
            points, losses = points[order], losses[order]
            archive = rng.permutation(archive)[: round(self.archive * len(points))]
            remembered = rng.integers(self.memory, size=len(points))
            f, cr = draw_scale(scale[remembered], rng), draw_cross(cross[remembered], rng)
            trial = np.where(crossed(cr, dimensions, rng), self.mutant(points, archive, f, rng), points)
            trial_losses = yield trial.copy()
            used += len(trial)
            better = trial_losses < losses
            if better.any():
                weight = gains(losses[better], trial_losses[better])
                scale[entry], cross[entry] = lehmer(f[better], weight), lehmer(cr[better], weight)
                entry = (entry + 1) % self.memory
                archive = np.concatenate([archive, points[better]])
            accepted = trial_losses <= losses
            points[accepted], losses[accepted] = trial[accepted], trial_losses[accepted]

    def survivors(self, used: int) -> int:
        """Size of the population after so many evaluations."""
        return max(4, round(self.population + (4 - self.population) * used / self.evaluations))

    def mutant(self, points: Array, archive: Array, f: Array, rng: np.random.Generator) -> Array:
        """x + F (p - x) + F (r1 - r2) of points sorted best first, halfway to a bound where it would cross it."""
        count, rows = len(points), np.arange(len(points))
        best = points[rng.integers(max(2, round(self.greed * count)), size=count)]
        first = (rows + rng.integers(1, count, size=count)) % count
        pool = np.concatenate([points, archive])
        second = rng.integers(len(pool) - 2, size=count)
        for taken in np.sort([rows, first], axis=0):
            second += second >= taken
        raw = points + f[:, None] * (best - points + points[first] - pool[second])
        return np.where(raw < 0, points / 2, np.where(raw > 1, (1 + points) / 2, raw))


def draw_scale(mean: Array, rng: np.random.Generator) -> Array:
    """F from Cauchy(mean, 0.1), drawn again until positive, at most 1."""
    f = np.zeros_like(mean)
    while (low := f <= 0).any():
        f[low] = mean[low] + 0.1 * rng.standard_cauchy(int(low.sum()))
    return np.minimum(f, 1)


def draw_cross(mean: Array, rng: np.random.Generator) -> Array:
    """CR from N(mean, 0.1) in [0, 1]."""
    return np.clip(rng.normal(mean, 0.1), 0, 1)


def crossed(cr: Array, dimensions: int, rng: np.random.Generator) -> np.ndarray:
    """Coordinates to take from the mutant, at least one: (M,) -> (M, P)."""
    always = rng.integers(dimensions, size=len(cr))
    return (rng.random((len(cr), dimensions)) < cr[:, None]) | (np.arange(dimensions) == always[:, None])


def gains(before: Array, after: Array) -> Array:
    """Weights of the successful F and CR by their improvement; where the parent failed, the largest improvement."""
    gain = before - after
    return np.where(np.isfinite(gain), gain, np.max(gain, where=np.isfinite(gain), initial=1e-300))


def lehmer(values: Array, weight: Array) -> float:
    """Weighted Lehmer mean."""
    return float(weight @ values**2) / max(float(weight @ values), 1e-300)
