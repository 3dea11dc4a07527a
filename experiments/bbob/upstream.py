"""The libraries behind our optimizers as their own users call them: each minimizes `function` over [-5, 5]^5.

A run ends by the exception that `function` raises when its budget is spent or its target hit.
"""

from __future__ import annotations

import os
import random
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

LOW, HIGH, DIMENSIONS = -5.0, 5.0, 5
Function = Callable[[np.ndarray], float]


@contextmanager
def without_logging() -> Iterator[None]:
    """Keep pyswarms from configuring logging and writing report.log when it is imported or a handler is created."""
    configured = os.environ.get("LOG_CFG")
    os.environ["LOG_CFG"] = str(Path(__file__).with_name("pyswarms_logging.yml"))
    try:
        yield
    finally:
        if configured is None:
            del os.environ["LOG_CFG"]
        else:
            os.environ["LOG_CFG"] = configured


def pyswarms(function: Function, seed: int, bounds_by: str = "periodic") -> None:
    """GlobalBestPSO with the inertia and pulls of its constriction equivalent, 20 particles, default bound handling."""
    np.random.seed(seed)  # noqa: NPY002
    with without_logging():
        from pyswarms.single import GlobalBestPSO

        bounds = np.full(DIMENSIONS, LOW), np.full(DIMENSIONS, HIGH)
        options = {"w": 0.729, "c1": 1.49445, "c2": 1.49445}
        swarm = GlobalBestPSO(20, DIMENSIONS, options, bounds, bh_strategy=bounds_by)
        swarm.optimize(lambda points: np.array([function(x) for x in points]), iters=10_000, verbose=False)


def pyswarms_reflective(function: Function, seed: int) -> None:
    """The same with the best of its ways to handle bounds."""
    pyswarms(function, seed, "reflective")


def deap(function: Function, seed: int) -> None:
    """eaSimple with tournament selection, blend crossover and Gaussian mutation, as in DEAP's documentation."""
    from deap import algorithms, base, creator, tools

    random.seed(seed)
    if not hasattr(creator, "Candidate"):
        creator.create("Smallest", base.Fitness, weights=(-1.0,))
        creator.create("Candidate", list, fitness=creator.Smallest)
    box = base.Toolbox()
    box.register("coordinate", random.uniform, LOW, HIGH)
    box.register("individual", tools.initRepeat, creator.Candidate, box.coordinate, DIMENSIONS)
    box.register("population", tools.initRepeat, list, box.individual)
    box.register("evaluate", lambda one: (function(np.clip(one, LOW, HIGH)),))
    box.register("mate", tools.cxBlend, alpha=0.5)
    box.register("mutate", tools.mutGaussian, mu=0, sigma=1, indpb=0.2)
    box.register("select", tools.selTournament, tournsize=3)
    algorithms.eaSimple(box.population(n=50), box, cxpb=0.5, mutpb=0.2, ngen=10_000, verbose=False)


def scipy_differential_evolution(function: Function, seed: int) -> None:
    """SciPy's defaults without its polish, restarted when it says that it has converged."""
    from scipy.optimize import differential_evolution

    rng = np.random.default_rng(seed)
    while True:
        differential_evolution(function, [(LOW, HIGH)] * DIMENSIONS, polish=False, maxiter=10_000, rng=rng)


def scipy_differential_evolution_to_the_end(function: Function, seed: int) -> None:
    """SciPy's defaults without its polish, its own convergence test turned off."""
    from scipy.optimize import differential_evolution

    box = [(LOW, HIGH)] * DIMENSIONS
    differential_evolution(function, box, polish=False, maxiter=10_000, tol=0, rng=np.random.default_rng(seed))


def pycma(function: Function, seed: int) -> None:
    """fmin2 with bounds and BIPOP restarts from random places, sigma a fifth of the range."""
    import cma

    np.random.seed(seed)  # noqa: NPY002
    options = {"bounds": [LOW, HIGH], "maxfevals": 5000, "verbose": -9, "verb_log": 0, "verb_disp": 0}
    place = lambda: np.random.uniform(LOW, HIGH, DIMENSIONS)  # noqa: E731, NPY002
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        cma.fmin2(function, place, 2.0, options, restarts=9, bipop=True)


def scipy_lbfgsb(function: Function, seed: int) -> None:
    """SciPy's bounded quasi-Newton method with its own differences, from random starts."""
    from scipy.optimize import minimize

    rng = np.random.default_rng(seed)
    while True:
        start = rng.uniform(LOW, HIGH, DIMENSIONS)
        minimize(function, start, method="L-BFGS-B", bounds=[(LOW, HIGH)] * DIMENSIONS)


PAIRS: dict[str, tuple[Callable[[Function, int], None], ...]] = {
    "pso": (pyswarms, pyswarms_reflective),
    "rga": (deap,),
    "differential_evolution": (scipy_differential_evolution, scipy_differential_evolution_to_the_end),
    "cma_es": (pycma,),
    "least_squares": (scipy_lbfgsb,),
    "csa": (),
    "pso_vmax": (),
}
