"""Time the ferroelectric models, a search over their densities, and a reduced rod; print and write the table of the
README.

python -m experiments.performance.ferroelectric
"""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from statistics import NormalDist
from types import SimpleNamespace

import numpy as np

from experiments.reduced_rod.reduced import least, measured
from experiments.smith.loops import HELPED, PLAIN, THERMAL, A, path, response, simulator
from experiments.tables import number, table
from pzt_ident.data.record import Record
from pzt_ident.model.chain import Chain
from pzt_ident.model.registry import blocks, optimizers
from pzt_ident.search.descent import polish
from pzt_ident.search.loop import Outcome, Stop, optimize
from pzt_ident.search.problem import Problem

OUT = Path(__file__).parents[2] / "results" / "reference" / "performance"
FIELD = 4000 * (1 - np.cos(2 * np.pi * np.arange(5000) / 1000))
LANES = 24
NOISE = 1e-8
TIPS = {"full": (8000, 0, 8000), "nested": (8000, 1000, 6000, 2000), "low": (3000, 0, 5000), "late": (7000, 4000, 8000)}
SEARCHED = {"coercive": (500, 8000), "spread": (0.3, 1.5)}


def relays(coercive: np.ndarray, interaction: np.ndarray) -> Callable[[], np.ndarray]:
    """The paper's grid over FIELD, one relay after the other, compiled; from the poled state."""
    from numba import njit

    @njit(fastmath={"contract"})
    def run(field: np.ndarray, coercive: np.ndarray, interaction: np.ndarray) -> np.ndarray:
        up = np.ones((coercive.size, interaction.size))
        found = np.empty(field.size)
        for k in range(field.size):
            total = 0.0
            for i in range(coercive.size):
                for j in range(interaction.size):
                    e = field[k] + interaction[j]
                    up[i, j] = 1.0 if e >= coercive[i] else -1.0 if e <= -coercive[i] else up[i, j]
                    total += up[i, j]
            found[k] = total / up.size
        return found

    return lambda: run(FIELD, coercive, interaction)


def candidates(chain: dict[str, dict[str, float]], count: int = LANES) -> float:
    """CPU seconds a candidate, of so many at once."""
    made, theta = simulator(chain, FIELD)
    many = theta * np.exp(np.random.default_rng(0).normal(0, 0.05, (count, theta.shape[1])))
    return least(lambda: made.squares(many)) / count


def solved() -> float:
    """CPU seconds of a width of the interaction field, with gain and weights of a free density solved for."""
    y = response(PLAIN, FIELD) + np.random.default_rng(0).normal(0, NOISE, FIELD.size)
    record = Record("r", "identify", 1e-3, FIELD[None], y[None], drive_units=("V/m",))
    fixed = {"homogenized_energy.poled": SimpleNamespace(bounds=None, value=1e6)}
    problem = Problem(Chain([blocks["homogenized_energy"].make(density="free")], ["x"], [0]), [record], fixed)
    widths = iter(np.linspace(0.6, 0.8, 100))  # each solved once
    return least(lambda: problem.loss(np.array([next(widths)])))


def grids() -> tuple[float, float]:
    """CPU seconds of the grid of 24 x 80 relays, and its largest difference from the plays over P_R."""
    quantiles = lambda n: np.array([NormalDist().inv_cdf((i + 0.5) / n) for i in range(n)])  # noqa: E731
    grid = relays(2400 * np.exp(0.887 * quantiles(24)), 6120 * quantiles(80))
    exact = response(PLAIN, FIELD) / (A["gain"] * A["remanence"])
    return least(grid), float(np.abs(grid() + FIELD / A["remanence"] - 1 - exact).max())


def search() -> tuple[float, Outcome, Problem]:
    """CPU seconds of a swarm and its polish over four records of 5,000 samples, two parameters free; what it found."""
    records = []
    for seed, (name, tips) in enumerate(TIPS.items()):
        field = np.interp(np.linspace(0, 1, 5000), np.linspace(0, 1, path(0, *tips).size), path(0, *tips))
        x = response(PLAIN, field) + np.random.default_rng(seed).normal(0, NOISE, 5000)
        records.append(Record(name, "identify", 1e-3, field[None], x[None], drive_units=("V/m",)))
    model = simulator(PLAIN, FIELD)[0].model
    specs = {f"homogenized_energy.{word}": SimpleNamespace(bounds=None, value=value) for word, value in A.items()}
    specs |= {f"homogenized_energy.{word}": SimpleNamespace(bounds=b, value=None) for word, b in SEARCHED.items()}
    problem = Problem(model, records, specs)
    problem.loss(np.full((1, 2), 0.5))
    begun = time.process_time()
    found = optimize(optimizers["pso"].make(population=40, generations=40), 2, problem.loss, 1, Stop(1600))
    point, more = polish(problem, found.point)
    found = found._replace(point=point, evaluations=found.evaluations + more)
    return time.process_time() - begun, found, problem


def text() -> str:
    grid, off = grids()
    cpu, best, problem = search()
    whole, reduced = measured("", "rod", elements=40), measured("", "rod_reduced", elements=40, order=3)
    rows = [
        ("plays, 64 nodes", 1e3 * candidates(PLAIN), "0.5"),
        *((f"the same, {count} candidates at once", 1e3 * candidates(PLAIN, count), "–") for count in (16, 8)),
        ("relays, 24 x 80", 1e3 * grid, "–"),
        ("plays that heat helps, 64 nodes", 1e3 * candidates(HELPED), "–"),
        ("thermal, 64 x 64 nodes", 1e3 * candidates(THERMAL), "40"),
        ("free density, 22 weights and gain solved for", 1e3 * solved(), "–"),
        ("Bouc-Wen and a rod of 40 elements, 4,000 samples", 1e-3 * whole.step, "–"),
        ("the rod reduced to 3 sections", 1e-3 * reduced.step, "–"),
    ]
    values = " and ".join(map(number, problem.physical(best.point)[0]))
    return "\n\n".join(
        [
            table(["5,000 samples, one candidate", "CPU ms", "to reach"], [(a, number(b, 3), c) for a, b, c in rows]),
            f"Largest difference of the relays from the plays: {100 * off:.2g} % of P_R.",
            f"Coercive field and spread from four records: {best.evaluations} evaluations, {cpu:.1f} s CPU (to reach: "
            f"10), found {values} of 2400 and 0.887.",
        ]
    )


if __name__ == "__main__":
    OUT.mkdir(parents=True, exist_ok=True)
    said = text()
    (OUT / "ferroelectric.md").write_text(said + "\n", encoding="utf-8")
    print(said)
