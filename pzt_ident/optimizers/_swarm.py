"""The flight of a particle swarm on pyswarms' operators."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from pzt_ident.model.optimizer import Search
from pzt_ident.optimizers._foreign import numpy_seeded


@contextmanager
def quiet() -> Iterator[None]:
    """pyswarms configures logging, and writes report.log, whenever it is imported or a handler is made."""
    kept = os.environ.get("LOG_CFG")
    os.environ["LOG_CFG"] = str(Path(__file__).with_name("_pyswarms_logging.yaml"))
    try:
        yield
    finally:
        if kept is None:
            del os.environ["LOG_CFG"]
        else:
            os.environ["LOG_CFG"] = kept


def fly(
    particles: int, dimensions: int, rng: np.random.Generator, options: dict[str, float], vmax: float = np.inf
) -> Search:
    """v <- w v + c1 r1 (p - x) + c2 r2 (g - x), |v| <= vmax; x <- x + v.

    A particle is reflected at the bounds and its velocity is then the move it really made.
    """
    with quiet():
        from pyswarms import backend
        from pyswarms.backend.topology import Star

        topology, walls, speed = Star(), backend.BoundaryHandler("reflective"), backend.VelocityHandler("unmodified")
    cube, clamp = (np.zeros(dimensions), np.ones(dimensions)), (-vmax, vmax)
    launch = min(vmax, 0.5)
    with numpy_seeded(rng):
        swarm = backend.create_swarm(particles, dimensions, options=options, bounds=cube, clamp=(-launch, launch))
    swarm.pbest_cost = np.full(particles, np.inf)
    swarm.best_pos = swarm.position[0]
    while True:
        swarm.current_cost = yield swarm.position.copy()
        swarm.pbest_pos, swarm.pbest_cost = backend.compute_pbest(swarm)
        swarm.best_pos, swarm.best_cost = topology.compute_gbest(swarm)
        with numpy_seeded(rng):
            swarm.velocity = topology.compute_velocity(swarm, clamp, speed, cube)
        start = swarm.position
        swarm.position = topology.compute_position(swarm, cube, walls)
        swarm.velocity = swarm.position - start
