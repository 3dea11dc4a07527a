"""What a balanced reduction of a rod costs and saves: error, its bound, and CPU time.

python -m experiments.reduced_rod.reduced
"""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any, NamedTuple

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

from experiments.simulate import Array, keep, named, simulator
from experiments.tables import number, table
from pzt_ident.mechanics._balanced import balanced
from pzt_ident.mechanics._rod import matrices
from pzt_ident.model.registry import blocks

ROD = {"density": 7600.0, "area": 1e-4, "length": 0.06, "modulus": 7e10, "viscosity": 1e5}
ROD |= {"end_mass": 0.05, "end_damping": 0.0, "end_stiffness": 0.0}
LOOP = {"bouc_wen.gain": 6e-7, "bouc_wen.alpha": 0.5, "bouc_wen.beta": 0.02, "bouc_wen.gamma": 0.01}
RECORD = Path(__file__).parents[1] / "rod" / "data" / "rod.csv"
FULL = 40
CANDIDATES = 96


class Row(NamedTuple):
    """A rod: largest difference from the full one in m, the bound of its transfer function, us a candidate, ms once."""

    name: str
    response: Array
    bound: float | None
    step: float
    once: float


def system(elements: int) -> tuple[Array, ...]:
    own = SimpleNamespace(**ROD, load=0.0, extra_damping=0.0, elements=elements)
    end = np.eye(elements)[-1]
    return *matrices(own), end, end


def least(run: Callable[[], Any], rounds: int = 40) -> float:
    """CPU seconds of the fastest of some runs: neighbours on the machine only ever add."""
    times = []
    for _ in range(rounds):
        begun = time.process_time()
        run()
        times.append(time.process_time() - begun)
    return min(times)


def measured(name: str, word: str, bound: float | None = None, **settings: int) -> Row:
    """The rod behind Bouc-Wen on the record of the virtual rod, its own data fixed, CANDIDATES at once."""
    drive = np.loadtxt(RECORD, delimiter=",", skiprows=1)[:, 1]
    block = blocks[word].make(**settings)
    made, theta = simulator(["bouc_wen", block], LOOP | named(word, ROD), drive, 2.5e-6)
    many = np.repeat(theta, CANDIDATES, axis=0)
    many[:, 0] *= np.linspace(0.9, 1.1, CANDIDATES)
    own = SimpleNamespace(**ROD, load=0.0, extra_damping=0.0, **{key: block.setting(key) for key in block.settings()})
    once = least(lambda: block.solve(own))
    step = (least(lambda: made.squares(many)) - once) / CANDIDATES
    return Row(name, made.simulate(theta)[0, 0], bound, 1e6 * step, 1e3 * once)


def rows() -> list[Row]:
    found = [measured(f"{FULL} elements", "rod", elements=FULL)]
    found += [measured(f"{n} elements", "rod", elements=n) for n in (20, 8, 4)]
    found += [measured(f"{FULL} elements, modes stepped: {m}", "rod", elements=FULL, modes=m) for m in (4, 3, 2, 1)]
    for order in (6, 4, 3, 2, 1):
        bound = 2 * balanced(order, *system(FULL))[1][2 * order :].sum()
        found.append(measured(f"reduced to {order}", "rod_reduced", bound, elements=FULL, order=order))
    return found


def off(row: Row, full: Row) -> float:
    return float(np.abs(row.response - full.response).max())


def text(found: list[Row]) -> str:
    header = ["rod", "largest difference [nm]", "bound of the transfer function"]
    header += ["us CPU a candidate", "less Bouc-Wen", "ms once"]
    drive = np.loadtxt(RECORD, delimiter=",", skiprows=1)[:, 1]
    made, theta = simulator(["bouc_wen"], LOOP, drive, 2.5e-6)
    alone = 1e6 * least(lambda: made.squares(np.repeat(theta, CANDIDATES, axis=0))) / CANDIDATES
    lines = []
    for row in found:
        difference = number(1e9 * off(row, found[0]), 3) if row is not found[0] else "–"
        times = [number(row.step, 3), number(row.step - alone, 3), number(row.once, 2)]
        lines.append([row.name, difference, "–" if row.bound is None else f"{row.bound:.1e}", *times])
    return table(header, lines)


def transfer(found: tuple[Array, ...], omega: Array) -> Array:
    w, zeta, share, speed = (each[:, None] for each in found)
    s = 1j * omega / w
    return 1 - share.sum() + ((share + speed * s) / (1 + 2 * zeta * s + s**2)).sum(axis=0)


def draw() -> plt.Figure:
    hertz = np.logspace(2, 6, 1500)
    figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.5), layout="constrained")
    full = transfer(balanced(20, *system(FULL))[0], 2 * np.pi * hertz)
    left.loglog(hertz, np.abs(full), color="0.7", linewidth=3, label=f"{FULL} elements")
    for order, colour in ((1, "C0"), (2, "C1"), (3, "C2"), (4, "C3")):
        sections, values = balanced(order, *system(FULL))
        found = transfer(sections, 2 * np.pi * hertz)
        if order < 4:
            left.loglog(hertz, np.abs(found), color=colour, linewidth=0.9, label=f"reduced to {order}")
        right.loglog(hertz, np.abs(found - full), color=colour, linewidth=0.9, label=f"order {order}")
        right.axhline(2 * values[2 * order :].sum(), color=colour, linewidth=0.8, linestyle=":")
    left.set(xlabel="frequency [Hz]", ylabel="|end / end at rest|", ylim=(1e-5, 30))
    right.set(xlabel="frequency [Hz]", ylabel="|reduced less full|, bound dotted", ylim=(1e-9, 1))
    for axes in (left, right):
        axes.legend(frameon=False, loc="lower left" if axes is left else "lower right", fontsize=8)
    return figure


if __name__ == "__main__":
    keep("reduced_rod", "reduced", draw(), text(rows()))
