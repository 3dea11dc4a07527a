"""Draw how the error falls as heat is added, on what was left out: python -m experiments.pnzt.stairs FOLDER"""

import json
import sys
from pathlib import Path
from typing import Any

import h5netcdf
import matplotlib

from experiments.pnzt.figure import OUT
from experiments.pnzt.table import UNITS
from pzt_ident.run.events import step_name

matplotlib.use("Agg")
import matplotlib.pyplot as plt

COLOURS = ("#56B4E9", "#D55E00")
MODELS = {"signals_as_given.nc": "as given", "signals.nc": "last stair"}
LEFT_OUT = "1400 V 0.01 Hz"


def stairs(axis: Any, folder: Path) -> None:
    steps = json.loads((folder / "improvement.json").read_text(encoding="utf-8"))["steps"]
    for use, colour in (("identify", "0.5"), ("validate", "#D55E00")):
        values = [step["rmse"][use] for step in steps]
        axis.plot(range(len(steps)), values, "o-", drawstyle="steps-mid", ms=3, lw=1, color=colour, label=use)
    axis.set_xticks(range(len(steps)), [step_name(step) for step in steps], rotation=20, ha="right")
    axis.set_ylim(0, None)
    axis.set_ylabel("RMSE of P and D, weighed (1)", fontsize=8)
    axis.legend(fontsize=7, frameon=False)


def loops(axes: Any, folder: Path) -> None:
    """Both responses of the rate that was left out, with the first and the last model."""
    for (name, said), colour in zip(MODELS.items(), COLOURS, strict=True):
        with h5netcdf.File(folder / name) as file:
            group = file[LEFT_OUT]
            for axis, word in zip(axes, UNITS, strict=True):
                drive, measured, model = (group[f"{key}_{word}"][:] for key in ("drive", "response", "model"))
                if colour == COLOURS[0]:
                    axis.plot(drive, measured, color="0.3", lw=1.6, label="measured")
                axis.plot(drive, model, color=colour, lw=1, label=said)
    for axis, label in zip(axes, ("P (µC/cm²)", "D (nm)"), strict=True):
        axis.set_title(f"{LEFT_OUT}, left out", fontsize=8)
        axis.set_ylabel(label, fontsize=8)
        axis.set_xlabel("V+ (V)", fontsize=8)


def main(folder: Path) -> None:
    fig, axes = plt.subplots(1, 3, figsize=(180 / 25.4, 72 / 25.4), layout="constrained")
    stairs(axes[0], folder / "missing")
    loops(axes[1:], folder / "missing")
    for axis in axes:
        axis.tick_params(labelsize=6)
        axis.grid(alpha=0.25, lw=0.5)
    axes[1].legend(fontsize=6, frameon=False)
    for kind in ("svg", "pdf", "png"):
        fig.savefig(OUT / f"stairs.{kind}", dpi=160)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
