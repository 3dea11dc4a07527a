"""Loops, rates and creep of the ferroelectric models, beside the axes and captions of the papers; the tables and the
figure of the README.

python -m experiments.smith.loops
"""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np

from experiments.tables import table
from pzt_ident.data.record import Record
from pzt_ident.engine.simulator import Simulator
from pzt_ident.model.chain import Chain
from pzt_ident.model.registry import blocks

OUT = Path(__file__).parents[2] / "results" / "reference" / "smith"
DENSITY = {"spread": 0.887, "interaction": 6120.0, "quadratic": 0.0, "poled": 1e6, "bias": 0.0}
A = {"gain": 1 / 1.09e8, "remanence": 1.09e8 * 8.79e-5, "coercive": 2400.0} | DENSITY
T = {"gain": 1 / 1.071e8, "remanence": 1.071e8 * 9.39e-5, "coercive": 3290.0, "thermal": 0.02, "dwell": 1e-3} | DENSITY
ROD = {"mass": 4.21, "damping": 1.52e5, "stiffness": 8.75e7}
WALL = {"saturation": 3.52e-2 * 0.02 * 0.49, "width": 4.6e5, "coupling": 4.5e5 * 0.49 / 4.6e5}
WALL |= {"pinning": 1.47e4, "reversible": 0.643}
PLAIN, THERMAL = {"homogenized_energy": A}, {"thermal_homogenized_energy": T}
WALLS = {"domain_wall": WALL}
MINOR = (0, 12000, 4000, 12000, 4000, 12000, 13500, -1000)
FORMS = ("open", "biased")
COLD = {word: value for word, value in T.items() if word not in ("thermal", "dwell")}
HELPED = {"homogenized_energy": COLD | {"coercive": 2930.0, "fluctuation": 52.6}, "thermal_relaxation": {}}
LINEAR = {"homogenized_energy": COLD, "creep": {"ratio": 0.0211, "tau": 3.16, "decades": 3.0}}
CREEPING = {"creep of set T": THERMAL, "of plays that heat helps": HELPED, "of linear creep": LINEAR}
HERTZ = (0.279, 1.12, 5.58, 27.9)
POINTS = 400
Values = dict[str, dict[str, float]]


def simulator(chain: Values, field: np.ndarray, dt: float = 1e-3, **settings: str) -> tuple[Simulator, np.ndarray]:
    """`settings` are those of the first block."""
    first, *others = chain
    model = Chain([blocks[first].make(**settings), *(blocks[word] for word in others)], ["x"], [0])
    theta = [[(chain[s.block.name] | {"load": 0.0, "extra_damping": 0.0})[s.word] for s in model.entries]]
    record = Record("r", "identify", dt, field[None], np.zeros((1, field.size)), drive_units=("V/m",))
    return Simulator(model, record), np.array(theta)


def response(chain: Values, field: np.ndarray, dt: float = 1e-3, **settings: str) -> np.ndarray:
    made, theta = simulator(chain, field, dt, **settings)
    return np.asarray(made.simulate(theta)[0, 0])


def path(*levels: float) -> np.ndarray:
    legs = [np.linspace(a, b, POINTS, endpoint=False) for a, b in pairwise(levels)]
    return np.append(np.concatenate(legs), levels[-1])


def settled(chain: Values, low: float, high: float, cycles: int = 2) -> tuple[np.ndarray, np.ndarray]:
    """Field and displacement of the last rise and fall between two fields."""
    field = path(0, high, *[low, high] * cycles, low)
    return field[-2 * POINTS - 1 :], response(chain, field)[-2 * POINTS - 1 :]


def width(y: np.ndarray) -> float:
    """Largest width of a loop of one rise and one fall over its span, percent."""
    return float(100 * np.max(y[POINTS:][::-1] - y[: POINTS + 1]) / np.ptp(y))


def sine(chain: Values, hertz: float) -> tuple[np.ndarray, np.ndarray]:
    """The last of four periods from 0 to 8 kV/m."""
    field = 4000 * (1 - np.cos(2 * np.pi * np.arange(4 * POINTS) / POINTS))
    return field[-POINTS:], response(chain, field, 1 / (POINTS * hertz))[-POINTS:]


def middle(y: np.ndarray) -> float:
    return float(100 * abs(y[POINTS // 4] - y[3 * POINTS // 4]) / np.ptp(y))


def crept(chain: Values, back: float, dt: float = 0.02) -> float:
    """Growth from 0.1 to 100 s after 0 -> 8 kV/m, 0.5 s and a step back by a share, percent of the first step."""
    field = np.concatenate([np.zeros(50), np.full(25, 8000.0), np.full(5010, 8000 * (1 - back))])
    y = response(chain, field, dt)
    return float(100 * (y[75 + 5000] - y[75 + 5]) / (y[55] - y[49]))


def figure() -> None:
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    fig, axes = plt.subplots(3, 2, figsize=(180 / 25.4, 200 / 25.4), layout="constrained")
    for high in (2000, 4000, 6000, 8000):
        field, y = settled(PLAIN, 0, high)
        axes[0, 0].plot(field, y * 1e6, lw=1, label=f"to {high / 1000:g} kV/m")
    axes[0, 0].legend(fontsize=7, frameon=False)
    axes[0, 0].set_title("nested loops, set A (figures 3, 9)", fontsize=9)
    for axis, chain, title in (
        (axes[0, 1], PLAIN | {"lumped": ROD}, "set A behind the lumped rod (figure 10)"),
        (axes[1, 0], THERMAL, "thermal activation, set T (figure 11)"),
    ):
        for hertz in HERTZ:
            field, y = sine(chain, hertz)
            axis.plot(field, y * 1e6, lw=1, label=f"{hertz:g} Hz")
        axis.set_title(title, fontsize=9)
        axis.legend(fontsize=7, frameon=False)
    field, y = settled(WALLS, -1000, 13500, 3)
    axes[1, 1].plot(field, y * 1e6, lw=1)
    axes[1, 1].set_title("domain walls, set DW1 (figure 4)", fontsize=9)
    field = path(*MINOR)
    for form, axis in zip(FORMS, axes[2], strict=True):
        y = response(WALLS, field, minor_loops=form)
        axis.plot(field, y * 1e6, lw=1)
        axis.plot(field[POINTS::POINTS], y[POINTS::POINTS] * 1e6, ".", ms=4)
        axis.set_title(f"domain walls, {form} minor loops (eq. 5)", fontsize=9)
    for axis in axes.flat:
        axis.set_xlabel("E (V/m)", fontsize=8)
        axis.set_ylabel("u (µm)", fontsize=8)
        axis.tick_params(labelsize=7)
        axis.grid(alpha=0.25, lw=0.5)
    OUT.mkdir(parents=True, exist_ok=True)
    for kind in ("svg", "pdf", "png"):
        fig.savefig(OUT / f"loops.{kind}", dpi=160)


def text() -> str:
    loops = [(0, 8000), (0, 4000), (2700, 5300)]
    nested = [(f"{low} to {high} V/m", f"{width(settled(PLAIN, low, high)[1]):.1f}") for low, high in loops]
    rates = []
    for hertz in HERTZ:
        behind, alone = sine(PLAIN | {"lumped": ROD}, hertz)[1], sine(THERMAL, hertz)[1]
        over = 1e6 * (behind.max() - behind[POINTS // 2])
        rates.append((f"{hertz:g}", f"{middle(behind):.1f}", f"{over:.2g}", f"{middle(alone):.1f}"))
    walls = settled(WALLS, -1000, 13500, 3)[1]
    ends = [1e6 * response(WALLS, path(*MINOR), minor_loops=form)[[POINTS, 3 * POINTS, 5 * POINTS]] for form in FORMS]
    minor = [(form, *(f"{value:.3f}" for value in each)) for form, each in zip(FORMS, ends, strict=True)]
    shares = (0, 0.02, 0.05, 0.1, 0.2, 0.4)
    back = [(f"{100 * s:g}", *(f"{crept(chain, s):+.2f}" for chain in CREEPING.values())) for s in shares]
    return "\n\n".join(
        [
            table(["nested loop, set A", "width [%]"], nested),
            table(["Hz", "set A behind the rod: width [%]", "overshoot [um]", "set T: width [%]"], rates),
            f"Domain walls, set DW1: span {1e6 * np.ptp(walls):.2f} um, width {width(walls):.1f} %.",
            table(["minor loops of DW1 from 12 to 4 kV/m", "first at 12 kV/m [um]", "second", "third"], minor),
            "Creep from 0.1 to 100 s, percent of the first step:",
            table(["step back [%]", *CREEPING], back),
        ]
    )


if __name__ == "__main__":
    figure()
    found = text()
    (OUT / "tables.md").write_text(found + "\n", encoding="utf-8")
    print(found)
