"""The iteration of a particle swarm, with the operators of pyswarms."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from pzt_ident.libraries import modules
from pzt_ident.model.optimizer import Search
from pzt_ident.optimizers._foreign import numpy_seeded

PARTS = ("generators", "handlers", "operators", "topology.star")


@contextmanager
def without_logging() -> Iterator[None]:
    """Keep pyswarms from configuring logging and writing report.log when it is imported or a handler is created."""
    configured = os.environ.get("LOG_CFG")
    os.environ["LOG_CFG"] = str(Path(__file__).with_name("_pyswarms_logging.yaml"))
    try:
        yield
    finally:
        if configured is None:
            del os.environ["LOG_CFG"]
        else:
            os.environ["LOG_CFG"] = configured


def fly(
    particles: int, dimensions: int, rng: np.random.Generator, options: dict[str, float], vmax: float = np.inf
) -> Search:
    """v <- w v + c1 r1 (p - x) + c2 r2 (g - x), |v| <= vmax; x <- x + v.

    Particles are reflected at the bounds; their velocity is then the actual move.
    """
    with without_logging():
        make, handlers, operators, star = modules(*(f"pyswarms.backend.{name}" for name in PARTS))
        topology, walls, speed = (
            star.Star(),
            handlers.BoundaryHandler("reflective"),
            handlers.VelocityHandler("unmodified"),
        )
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
