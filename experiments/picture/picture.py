"""Draw a measured loop beside a straight line and beside the identified model: picture.py RUN_FOLDER."""

import json
import sys
from pathlib import Path

import h5netcdf
import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt

OUT = Path(__file__).parents[2] / "results" / "reference" / "picture"


def record(folder: Path) -> tuple[np.ndarray, ...]:
    """Drive, response and model of the record to validate, without the stretch that is not scored."""
    with h5netcdf.File(folder / "signals.nc") as file:
        group = next(g for g in file.groups.values() if g.attrs["use"] == "validate")
        scored = group["time"][:] - group["time"][0] >= group.attrs["settle"]
        return tuple(group[name][:][scored] for name in ("drive_x", "response_x", "model_x"))


def main(folder: Path) -> None:
    drive, response, model = record(folder)
    line = np.polynomial.Polynomial.fit(drive, response, 1)(drive)
    floor = json.loads((folder / "result.json").read_text())["noise_floor"]["x"]
    origin = response.min()
    plt.rcParams.update({"font.size": 8, "axes.spines.top": False, "axes.spines.right": False})
    figure, axes = plt.subplots(1, 2, figsize=(180 / 25.4, 75 / 25.4), sharey=True, layout="constrained")
    for axis, shown, title in (
        (axes[0], line, "before: straight line"),
        (axes[1], model, "after: identified Bouc-Wen"),
    ):
        error = np.sqrt(np.mean((shown - response) ** 2))
        axis.plot(drive, response - origin, color="#56B4E9", lw=2.2, label="measured")
        axis.plot(drive, shown - origin, color="#D55E00", lw=0.8, label="model")
        axis.set_title(f"{title}, {error:.2f} µm RMS", fontsize=9)
        axis.set_xlabel("drive [V]")
    axes[0].set_ylabel("displacement [µm]")
    axes[0].legend(frameon=False, loc="upper left")
    axes[1].text(0.97, 0.05, f"noise floor {floor:.3f} µm", ha="right", transform=axes[1].transAxes, color="0.35")
    figure.suptitle("Piezo stack, minor loops that the fit never saw", fontsize=10, weight="bold")
    OUT.mkdir(parents=True, exist_ok=True)
    figure.savefig(OUT / "loop.png", dpi=160)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
