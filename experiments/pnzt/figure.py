"""Draw polarization and displacement at the three rates beside both models: python -m experiments.pnzt.figure FOLDER"""

import sys
from pathlib import Path

import h5netcdf
import matplotlib

from experiments.pnzt.table import JOBS, UNITS

matplotlib.use("Agg")
import matplotlib.pyplot as plt

OUT = Path(__file__).parents[2] / "results" / "reference" / "pnzt"
RATES = ("1 Hz", "0.1 Hz", "0.01 Hz")


def main(folder: Path) -> None:
    fig, axes = plt.subplots(2, 3, figsize=(180 / 25.4, 110 / 25.4), sharex=True, sharey="row", layout="constrained")
    for (job, said), colour in zip(JOBS.items(), ("#56B4E9", "#D55E00"), strict=True):
        with h5netcdf.File(folder / job / "signals.nc") as file:
            for column, rate in enumerate(RATES):
                group = file[rate]
                for row, axis in enumerate(UNITS):
                    drive, response, model = (group[f"{word}_{axis}"][:] for word in ("drive", "response", "model"))
                    if job == "homogenized_energy":
                        axes[row, column].plot(drive, response, color="0.3", lw=1.6, label="measured")
                    axes[row, column].plot(drive, model, color=colour, lw=1, label=said)
                    use = group.attrs["use"]
                    axes[0, column].set_title(f"{rate} ({use})", fontsize=9)
    for axis, label in zip(axes[:, 0], ("P (µC/cm²)", "D (nm)"), strict=True):
        axis.set_ylabel(label, fontsize=8)
    for axis in axes.flat:
        axis.tick_params(labelsize=7)
        axis.grid(alpha=0.25, lw=0.5)
    for axis in axes[1]:
        axis.set_xlabel("V+ (V)", fontsize=8)
    axes[0, 0].legend(fontsize=7, frameon=False)
    OUT.mkdir(parents=True, exist_ok=True)
    for kind in ("svg", "pdf", "png"):
        fig.savefig(OUT / f"loops.{kind}", dpi=160)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
