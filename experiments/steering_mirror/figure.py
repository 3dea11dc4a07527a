"""Frequency responses of the mirror, measured and by the identified modes: python -m experiments.steering_mirror.figure
RUN, the folder in which `modes/result.json` stands. The table of scores is printed.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from numpy.typing import NDArray

from experiments.simulate import keep
from experiments.steering_mirror.start import RATE, delayed, modes, responses
from experiments.tables import number, table

AXES = "xyz"
PUBLISHED = 0.114  # um, linear of order 28 by Floren et al., mean over the test set


def identified(hertz: NDArray[np.float64], values: dict[str, float]) -> NDArray[np.complex128]:
    """(lines, outputs, inputs) in um/V as the package steps it."""
    count = sum(name.startswith("modal.frequency") for name in values)
    own = [np.array([values[f"modal.{word}_{i + 1}"] for i in range(count)]) for word in ("frequency", "damping")]
    shape, push = (
        np.array([[values.get(f"{axis}.modal.{word}_{i + 1}", 1.0) for i in range(count)] for axis in AXES])
        for word in ("shape", "push")
    )
    late = np.array([delayed(hertz, values[f"{axis}.delay.time"] * RATE) for axis in AXES])
    return np.einsum("lm,am,bm,bl->lab", modes(hertz, *own), shape, push, late)


def draw(values: dict[str, float]) -> plt.Figure:
    hertz, measured = (each[::4] for each in responses())
    model, measured = identified(hertz, values), measured.reshape(-1, 3, 3)
    figure, grid = plt.subplots(3, 3, figsize=(10, 7), layout="constrained", sharex=True, sharey=True)
    for (a, b), axes in np.ndenumerate(grid):
        axes.semilogy(hertz, np.abs(measured[:, a, b]), color="#7aa6c8", linewidth=1.4, label="measured")
        axes.semilogy(hertz, np.abs(model[:, a, b]), color="#b3400f", linewidth=0.7, label="13 modes")
        axes.set_title(f"{AXES[b]} to {AXES[a]}", fontsize=9)
        axes.set_ylim(0.05, 200)
    for axes in grid[-1]:
        axes.set_xlabel("frequency [Hz]")
    for axes in grid[:, 0]:
        axes.set_ylabel("um/V")
    grid[0, 0].legend(frameon=False, fontsize=8)
    return figure


def text(result: Any) -> str:
    rows = [
        [f"{record['name']} ({record['use']})", *(number(1e6 * rmse) for rmse in record["rmse"].values())]
        for record in result["records"]
    ]
    whole = [["all axes, validate", number(1e6 * result["best"]["rmse"]["validate"]), "", ""]]
    published = [["linear of order 28 (Floren et al.), mean over the test set", number(PUBLISHED), "", ""]]
    return table(["record", "x [um]", "y [um]", "z [um]"], [*rows, *whole, *published])


if __name__ == "__main__":
    result = json.loads((Path(sys.argv[1]) / "modes" / "result.json").read_text(encoding="utf-8"))
    values = {name: entry["value"] for name, entry in result["best"]["parameters"].items()}
    keep("steering_mirror", "responses", draw(values), text(result))
