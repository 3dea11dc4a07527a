"""Particle swarm optimization with constriction."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pzt_ident.errors import InputError
from pzt_ident.model.optimizer import Generational, Search, setting
from pzt_ident.model.registry import optimizers
from pzt_ident.optimizers._swarm import fly


@optimizers.register
@dataclass(frozen=True)
class PSO(Generational):
    """Particle swarm with constriction: v <- chi [v + c1 r1 (p - x) + c2 r2 (g - x)], x <- x + v.

    chi = 2 / |2 - phi - sqrt(phi^2 - 4 phi)|, phi = c1 + c2 > 4.
    """

    source = "Clerc & Kennedy (2002), IEEE Trans. Evol. Comput. 6, 58; Lin & Lin (2012), Eq. 16-18"

    population: int = setting(25, "1", (4, 100_000), "Particles in the swarm.")
    generations: int = setting(700, "1", (1, 10_000_000), "The budget is this many times the population.")
    c1: float = setting(2.8, "1", (0, 10), "Pull towards a particle's own best.")
    c2: float = setting(1.3, "1", (0, 10), "Pull towards the swarm's best.")

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.c1 + self.c2 <= 4:
            raise InputError(
                f"c1 + c2 = {self.c1 + self.c2:g}", where=self.name, remedy="constriction needs c1 + c2 above 4"
            )

    @property
    def constriction(self) -> float:
        phi = self.c1 + self.c2
        return 2 / abs(2 - phi - (phi**2 - 4 * phi) ** 0.5)

    def search(self, dimensions: int, rng: np.random.Generator) -> Search:
        chi = self.constriction
        return fly(self.population, dimensions, rng, {"w": chi, "c1": chi * self.c1, "c2": chi * self.c2})
