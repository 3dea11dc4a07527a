"""Particle swarm optimization, plain, with a limit on the velocity."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pzt_ident.model.optimizer import Generational, Search, setting
from pzt_ident.model.registry import optimizers
from pzt_ident.optimizers._swarm import fly


@optimizers.register
@dataclass(frozen=True)
class VmaxPSO(Generational):
    """Particle swarm without inertia weight: v <- v + c1 r1 (p - x) + c2 r2 (g - x), |v| <= vmax, x <- x + v."""

    source = "Kennedy & Eberhart (1995), Proc. ICNN, 1942; Lin & Lin (2012), Eq. 14-15"
    convergent = False

    c1: float = setting(2.8, "1", (0, 10), "Pull towards a particle's own best.")
    c2: float = setting(1.3, "1", (0, 10), "Pull towards the swarm's best.")
    vmax: float = setting(0.2, "range", (1e-6, 1), "Largest move of a coordinate in a generation.")

    def search(self, dimensions: int, rng: np.random.Generator) -> Search:
        return fly(self.population, dimensions, rng, {"w": 1.0, "c1": self.c1, "c2": self.c2}, self.vmax)
