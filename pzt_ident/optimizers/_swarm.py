"""The iteration of a particle swarm, with the operators of pyswarms."""

from __future__ import annotations

from logging import Logger
from types import ModuleType

import numpy as np

from pzt_ident.libraries import modules
from pzt_ident.model.optimizer import Search
from pzt_ident.optimizers._foreign import numpy_seeded

PARTS = ("generators", "handlers", "operators", "topology.star")


class Reporter:
    """In the place of pyswarms' own, which configures logging and writes report.log."""

    def __init__(self, logger: Logger) -> None:
        self.logger = logger

    def log(self, *message: object, **options: object) -> None:
        pass


SILENT = ModuleType("pyswarms.utils.reporter")
vars(SILENT).update(Reporter=Reporter)


def fly(
    particles: int, dimensions: int, rng: np.random.Generator, options: dict[str, float], vmax: float = np.inf
) -> Search:
    """v <- w v + c1 r1 (p - x) + c2 r2 (g - x), |v| <= vmax; x <- x + v.

    Particles are reflected at the bounds; their velocity is then the actual move.
    """
    make, handlers, operators, star = modules(*(f"pyswarms.backend.{name}" for name in PARTS), beside=SILENT)
    walls, speed = handlers.BoundaryHandler("reflective"), handlers.VelocityHandler("unmodified")
    topology = star.Star()
    cube, clamp = (np.zeros(dimensions), np.ones(dimensions)), (-vmax, vmax)
    launch = min(vmax, 0.5)
    with numpy_seeded(rng):
        swarm = make.create_swarm(particles, dimensions, options=options, bounds=cube, clamp=(-launch, launch))
    swarm.pbest_cost = np.full(particles, np.inf)
    swarm.best_pos = swarm.position[0]
    while True:
        swarm.current_cost = yield swarm.position.copy()
        swarm.pbest_pos, swarm.pbest_cost = operators.compute_pbest(swarm)
        swarm.best_pos, swarm.best_cost = topology.compute_gbest(swarm)
        with numpy_seeded(rng):
            swarm.velocity = topology.compute_velocity(swarm, clamp, speed, cube)
        start = swarm.position
        swarm.position = topology.compute_position(swarm, cube, walls)
        swarm.velocity = swarm.position - start
