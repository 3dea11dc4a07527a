"""Draw how the error falls as heat is added, on what was left out: python -m experiments.pnzt.stairs FOLDER"""

import json
import sys
from pathlib import Path
from typing import Any

import h5netcdf
import matplotlib

from experiments.pnzt.figure import OUT
from experiments.pnzt.table import STAIRS
from pzt_ident.report.words import step_name

matplotlib.use("Agg")
import matplotlib.pyplot as plt

LEFT_OUT = {"missing": "1400 V 0.01 Hz", "holds": "holds of 10 s"}
MODELS = {"signals_as_given.nc": ("as given", "#56B4E9"), "signals.nc": ("last stair", "#D55E00")}


def stairs(axis: Any, folder: Path) -> None:
    steps = json.loads((folder / "improvement.json").read_text(encoding="utf-8"))["steps"]
    for use, colour in (("identify", "0.5"), ("validate", "#D55E00")):
        values = [step["rmse"][use] for step in steps]
        axis.plot(range(len(steps)), values, "o-", drawstyle="steps-mid", ms=3, lw=1, color=colour, label=use)
    axis.set_xticks(range(len(steps)), [step_name(step) for step in steps], rotation=20, ha="right")
    axis.set_ylim(0, None)
    axis.set_ylabel("RMSE, weighed (1)", fontsize=8)
    axis.legend(fontsize=7, frameon=False)


def signals(axes: Any, folder: Path, record: str, across: str) -> None:
    """Both responses of a record with the first and the last model."""
    for name, (said, colour) in MODELS.items():
        with h5netcdf.File(folder / name) as file:
            group = file[record]
            since = int((group["time"][:] < group.attrs["settle"]).sum())
            for axis, word in zip(axes, ("p", "d"), strict=True):
                x, measured, model = (group[key][since:] for key in (across, f"response_{word}", f"model_{word}"))
                if name == "signals_as_given.nc":
                    axis.plot(x, measured, color="0.3", lw=1.6, label="measured")
                axis.plot(x, model, color=colour, lw=1, label=said)


def main(folder: Path) -> None:
    fig, axes = plt.subplots(2, 3, figsize=(180 / 25.4, 120 / 25.4), layout="constrained")
    for row, (job, across) in enumerate(zip(STAIRS, ("drive_p", "time"), strict=True)):
        stairs(axes[row, 0], folder / job)
        signals(axes[row, 1:], folder / job, LEFT_OUT[job], across)
        for axis, label in zip(axes[row, 1:], ("P (µC/cm²)", "D (nm)"), strict=True):
            axis.set_title(f"{LEFT_OUT[job]}, left out", fontsize=8)
            axis.set_ylabel(label, fontsize=8)
            axis.set_xlabel("V+ (V)" if across == "drive_p" else "time (s)", fontsize=8)
    for axis in axes.flat:
        axis.tick_params(labelsize=6)
        axis.grid(alpha=0.25, lw=0.5)
    axes[0, 1].legend(fontsize=6, frameon=False)
    for kind in ("svg", "pdf", "png"):
        fig.savefig(OUT / f"stairs.{kind}", dpi=160)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
