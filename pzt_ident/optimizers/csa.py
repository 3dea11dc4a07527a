"""Clonal selection algorithm (CLONALG) on a binary Gray code, in which neighbouring values differ by one bit."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pzt_ident.model.optimizer import Array, Generational, Search, setting
from pzt_ident.model.registry import optimizers

Bits = NDArray[np.bool_]


@optimizers.register
@dataclass(frozen=True)
class CSA(Generational):
    """Clonal selection: the fittest antibodies have most clones and least mutation; the worst are replaced.

    The antibody of rank r has round(clones N / r) clones, each bit of which flips with probability
    mutation exp(-decay affinity), the affinity falling from 1 (best) to 0 (worst of the selected). Every clone
    counts as an evaluation, so that a generation takes more of them than the population.
    """

    source = "de Castro & Von Zuben (2002), IEEE Trans. Evol. Comput. 6, 239; Lin & Lin (2012), section III-C"
    convergent = False

    bits: int = setting(16, "bit", (2, 52), "Code length of a coordinate.")
    selected: float = setting(0.3, "1", (0, 1), "Share of the population that is cloned.")
    clones: float = setting(0.5, "1", (0, 100), "Clones of the best antibody over the population.")
    mutation: float = setting(0.05, "1/bit", (0, 1), "Probability that a bit of the worst selected antibody flips.")
    decay: float = setting(
        2.0, "1", (0, 100), "Mutation of the best antibody relative to the worst selected: exp(-decay)."
    )
    renewed: float = setting(0.1, "1", (0, 1), "Share of the population that receptor editing replaces.")

    def search(self, dimensions: int, rng: np.random.Generator) -> Search:
        shape = (dimensions, self.bits)
        antibodies = rng.random((self.population, *shape)) < 0.5
        losses = yield self.decode(antibodies)
        counts, rates, fresh = self.clones_of(), self.rates(), round(self.renewed * self.population)
        parents = np.repeat(np.arange(len(counts)), counts)
        while True:
            order = np.argsort(losses, kind="stable")
            antibodies, losses = antibodies[order], losses[order]
            clones = antibodies[parents] ^ hypermutation(rates[parents], shape, rng)
            newcomers = rng.random((fresh, *shape)) < 0.5
            clone_losses = yield self.decode(np.concatenate([clones, newcomers]))
            mature(antibodies, losses, clones, clone_losses[: len(clones)], parents)
            if fresh:
                worst = np.argsort(losses, kind="stable")[-fresh:]
                antibodies[worst], losses[worst] = newcomers, clone_losses[len(clones) :]

    def clones_of(self) -> NDArray[np.int64]:
        """Number of clones of each selected antibody by rank, at least one."""
        rank = np.arange(1, max(1, round(self.selected * self.population)) + 1)
        return np.maximum(1, np.rint(self.clones * self.population / rank)).astype(np.int64)

    def rates(self) -> Array:
        """Flip probability of a bit by rank, smallest for the best."""
        affinity = np.linspace(1, 0, len(self.clones_of()))
        return self.mutation * np.exp(-self.decay * affinity)

    def decode(self, antibodies: Bits) -> Array:
        """Antibodies (M, P, bits) in Gray code, most significant bit first, to the unit cube (M, P)."""
        weights = 2.0 ** np.arange(self.bits - 1, -1, -1)
        return np.logical_xor.accumulate(antibodies, axis=-1) @ weights / weights.sum()


def hypermutation(rates: Array, shape: tuple[int, int], rng: np.random.Generator) -> Bits:
    """Bits to flip (M, P, bits), at least one, since a clone equal to its parent gives no information."""
    draws = rng.random((len(rates), *shape)) / rates[:, None, None]
    return (draws < 1) | (draws == draws.min(axis=(1, 2), keepdims=True))


def mature(antibodies: Bits, losses: Array, clones: Bits, clone_losses: Array, parents: NDArray[np.int64]) -> None:
    """Replace each antibody by its best clone if that is better, in place."""
    order = np.lexsort((clone_losses, parents))
    _, first = np.unique(parents[order], return_index=True)
    best = order[first]
    better = best[clone_losses[best] < losses[parents[best]]]
    antibodies[parents[better]], losses[parents[better]] = clones[better], clone_losses[better]
