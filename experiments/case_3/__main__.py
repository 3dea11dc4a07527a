"""Print and draw Case III: python -m experiments.case_3"""

from __future__ import annotations

from collections.abc import Mapping

import matplotlib
import numpy as np

from experiments.case_3.loop import best, facts, gains
from experiments.case_3.tracking import DT, PAPER, PUBLISHED, band, feedforward, runs, tracked, uncompensated
from experiments.simulate import keep
from experiments.tables import table
from pzt_ident.control.loop import PI, Tracking

matplotlib.use("Agg")
import matplotlib.pyplot as plt

HEADER = ["x - x_d [um]", "X paper", "X here", "Y paper", "Y here", "RMSE X", "RMSE Y"]
LOOP = ["axis", "b > by Routh [N s/m]", "time constant [ms]", "b > at 1 kHz, no delay", "largest pole, b = 0, delay 1"]
LOOP += ["mu of Lyapunov [1/s]", "its bound [m]"]
GAINS = ["gains", "axis", "Kp [V/um]", "Ki [V/(um s)]", "gain margin", "phase margin [deg]", "sensitivity"]
GAINS += ["largest pole", "bandwidth [Hz]"]


def text(found: Mapping[str, Tracking]) -> str:
    rows = [
        [name, *cells(name, band(run.error)), *(f"{1e6 * rmse:.3f}" for rmse in run.rmse)]
        for name, run in found.items()
    ]
    rows.append(["coupling alone", *cells("", band(uncompensated())), "", ""])
    readings = {name: band(run.reading - run.reference) for name, run in found.items() if "PI" in name}
    read = "; ".join(f"{name}: X {span(x)}, Y {span(y)}" for name, (x, y) in readings.items())
    tuned = [best(axis, 1) for axis in "xy"]
    both = PI(np.array([loop.kp for loop in tuned]), np.array([loop.ki for loop in tuned]))
    faster = tracked(feedforward(False), both)
    worth = [["published", axis.upper(), *gains(axis, 1)] for axis in "xy"]
    worth += [["tuned", axis.upper(), *gains(axis, 1, loop)] for axis, loop in zip("xy", tuned, strict=True)]
    return "\n\n".join(
        [
            "**Error bands, damping ratio 0.02, encoder 0.1 um, one sample of computing delay**",
            table(HEADER, rows),
            f"As the encoder reads it [um]: {read}.",
            f"Kp = {1e-6 * PUBLISHED.kp[0]:g} V/um, Ki = {1e-6 * PUBLISHED.ki[0]:g} V/(um s):",
            table(LOOP, [[axis.upper(), *facts(axis)] for axis in "xy"]),
            "**Margins with one sample of delay; tuned: for a gain margin of 2 and a phase margin of 60 degrees**",
            table(GAINS, worth),
            f"Eq. 23 and PI with the tuned gains: RMSE X {1e6 * faster.rmse[0]:.4f}, Y {1e6 * faster.rmse[1]:.4f} um; "
            f"with the published ones {1e6 * found['feedforward and PI'].rmse[0]:.4f} and "
            f"{1e6 * found['feedforward and PI'].rmse[1]:.4f} um.",
        ]
    )


def cells(name: str, here: np.ndarray) -> list[str]:
    paper = PAPER.get(name, (None, None))
    return [cell for said, found in zip(paper, here, strict=True) for cell in (span(said), span(found))]


def span(ends: object) -> str:
    return "–" if ends is None else "{:+.2f} to {:+.2f}".format(*ends)  # type: ignore[misc]


def figure(found: Mapping[str, Tracking]) -> plt.Figure:
    rows = ("open loop", "feedforward, eq. 23", "feedforward with decoupling", "feedforward and PI")
    fig, axes = plt.subplots(4, 2, figsize=(180 / 25.4, 190 / 25.4), sharex=True, sharey="row", layout="constrained")
    time = np.arange(found["open loop"].error.shape[1]) * DT
    for line, name in zip(axes, rows, strict=True):
        for place, axis in enumerate(line):
            if name in PAPER:
                axis.axhspan(*PAPER[name][place], color="#56B4E9", alpha=0.25, lw=0, label="band of the paper")
            axis.plot(time, 1e6 * found[name].error[place], color="#D55E00", lw=0.9, label="error here")
            if name == "feedforward, eq. 23":
                axis.plot(time, 1e6 * uncompensated()[place], "k--", lw=0.9, label="coupling alone")
            axis.set_title(f"{'XY'[place]}, {name}", fontsize=9)
            axis.tick_params(labelsize=7)
            axis.grid(alpha=0.25, lw=0.5)
        line[0].set_ylabel("x − x_d (µm)", fontsize=8)
    axes[2, 0].set_ylim(-0.15, 0.15)
    axes[3, 0].set_ylim(-0.15, 0.15)
    axes[1, 1].legend(fontsize=7, frameon=False, loc="lower right")
    for axis in axes[-1]:
        axis.set_xlabel("time (s)", fontsize=8)
    fig.suptitle(
        "Triangle of 10 µm on both axes: what is left of the error is the coupling, until it is inverted", fontsize=10
    )
    return fig


if __name__ == "__main__":
    results = runs()
    keep("case_3", "tracking", figure(results), text(results))
