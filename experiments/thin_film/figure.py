"""Draw the curves that were left out beside the models: python -m experiments.thin_film.figure FOLDER"""

import sys
from pathlib import Path

import h5netcdf
import matplotlib

from experiments.thin_film.drift import OUT
from experiments.thin_film.table import JOBS

matplotlib.use("Agg")
import matplotlib.pyplot as plt


def main(folder: Path) -> None:
    fig, axes = plt.subplots(2, 3, figsize=(180 / 25.4, 120 / 25.4), sharex=True, sharey=True, layout="constrained")
    for (job, said), axis in zip(JOBS.items(), axes.flat, strict=False):
        with h5netcdf.File(folder / job / "signals.nc") as file:
            left_out = [group for group in file.groups.values() if group.attrs["use"] == "validate"]
            for group in left_out:
                drive, measured, model = (group[word][:] for word in ("drive_p", "response_p", "model_p"))
                axis.plot(drive, measured - measured[0], color="0.6", lw=1.6, label="measured")
                axis.plot(drive, model - measured[0], color="#D55E00", lw=0.8, label="model")
        axis.set_title(said, fontsize=9)
        axis.tick_params(labelsize=7)
        axis.grid(alpha=0.25, lw=0.5)
    axes[1, 2].legend(*(part[:2] for part in axes[0, 0].get_legend_handles_labels()), fontsize=8, loc="center")
    axes[1, 2].set_axis_off()
    axes[0, 2].tick_params(labelbottom=True)
    for axis in (*axes[1, :2], axes[0, 2]):
        axis.set_xlabel("V (V)", fontsize=8)
    for axis in axes[:, 0]:
        axis.set_ylabel("P from saturation (µC/cm²)", fontsize=8)
    OUT.mkdir(parents=True, exist_ok=True)
    for kind in ("svg", "pdf", "png"):
        fig.savefig(OUT / f"curves.{kind}", dpi=160)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
