"""Print and draw Case IV: python -m experiments.case_4"""

from __future__ import annotations

from collections.abc import Sequence

import matplotlib
import numpy as np

from experiments.case_4.tracking import AMPLITUDE, DELAYS, DT, Followed, coarse, expected, followed, sine
from experiments.simulate import keep
from experiments.tables import table

matplotlib.use("Agg")
import matplotlib.pyplot as plt

PAPER = 0.2  # um
SHOWN = slice(0, 600)
HEADER = ["communication delay [ms]", "error [um]", "RMSE [um]", "rate x (delay + half a sample) [um]"]


def text(residual: np.ndarray, runs: Sequence[Followed]) -> str:
    rate = 1e6 * np.abs(np.diff(residual)).max() / DT
    rows = [
        [
            f"{1e3 * DT * run.delay:g}",
            f"{1e6 * run.error.min():+.2f} to {1e6 * run.error.max():+.2f}",
            f"{1e6 * np.sqrt(np.mean(run.error**2)):.3f}",
            f"{1e6 * expected(residual, run.delay):.2f}",
        ]
        for run in runs
    ]
    said = (
        f"The coarse stage leaves {1e6 * residual.min():+.2f} to {1e6 * residual.max():+.2f} um of the "
        f"{1e3 * AMPLITUDE:g} mm (paper: -2 to +4 um), which change by {rate:.0f} um/s at most."
    )
    return f"{said}\n\n{table(HEADER, rows)}"


def figure(target: np.ndarray, residual: np.ndarray, runs: Sequence[Followed]) -> plt.Figure:
    fig, axes = plt.subplots(3, 1, figsize=(180 / 25.4, 165 / 25.4), layout="constrained")
    time = DT * np.arange(target.size)
    axes[0].plot(time[SHOWN], 1e6 * target[SHOWN], color="0.5", lw=1.6, label="reference, a sine of 1 mm")
    axes[0].plot(time[SHOWN], 1e6 * (target - residual)[SHOWN], color="#0072B2", lw=0.9, label="coarse stage")
    axes[0].plot(time[SHOWN], 1e6 * residual[SHOWN], color="#D55E00", lw=0.9, label="residual, told to the fine stage")
    axes[0].set_ylabel("displacement (µm)", fontsize=8)
    axes[0].set_title("The coarse stage steps, its residual is the reference of the fine stage", fontsize=9)
    axes[1].axhspan(-PAPER, PAPER, color="#56B4E9", alpha=0.25, lw=0, label="band of the paper")
    for run, colour in zip((runs[0], runs[1], runs[3]), ("#009E73", "#D55E00", "#CC79A7"), strict=True):
        error = 1e6 * run.error[SHOWN]
        axes[1].plot(time[SHOWN], error, color=colour, lw=0.9, label=f"told {1e3 * DT * run.delay:g} ms late")
    axes[1].set_ylim(-0.6, 1.1)
    axes[1].set_ylabel("error of both (µm)", fontsize=8)
    axes[1].set_title("What is left", fontsize=9)
    for axis in axes[:2]:
        axis.set_xlabel("time (s)", fontsize=8)
    delays = np.array([run.delay for run in runs])
    axes[2].axhline(PAPER, color="#56B4E9", lw=2, label="paper")
    line = np.linspace(0, delays[-1], 50)
    rate = [1e6 * expected(residual, each) for each in line]
    axes[2].plot(1e3 * DT * line, rate, "k--", lw=0.9, label="fastest rate × (delay + half a sample)")
    axes[2].plot(1e3 * DT * delays, [1e6 * np.abs(run.error).max() for run in runs], "o", color="#D55E00", label="here")
    axes[2].set_xlabel("communication delay (ms)", fontsize=8)
    axes[2].set_ylabel("largest error (µm)", fontsize=8)
    axes[2].set_title("The error is the delay times the speed of the residual", fontsize=9)
    for axis in axes:
        axis.tick_params(labelsize=7)
        axis.grid(alpha=0.25, lw=0.5)
        axis.legend(fontsize=7, frameon=False, ncols=2)
    fig.suptitle("Fine stage behind a coarse one: how late it is told decides what is left", fontsize=10)
    return fig


if __name__ == "__main__":
    wanted = sine(1.0)
    left = wanted - coarse(wanted)
    found = [followed(left, delay) for delay in DELAYS]
    keep("case_4", "tracking", figure(wanted, left, found), text(left, found))
