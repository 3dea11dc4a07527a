"""Error of one stage of each effect over time, in the three ways, and of all stages."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np

from experiments.missing_effect.tracking import WAYS

matplotlib.use("Agg")
import matplotlib.pyplot as plt

LOOKS = {"line": "#8a8a8a", "as_given": "#d55e00", "improved": "#0072b2"}


def draw(rows: Sequence[Mapping[str, Any]], folder: Path, path: Path) -> None:
    effects = list(dict.fromkeys(row["effect"] for row in rows))
    plt.rcParams["svg.fonttype"], plt.rcParams["svg.hashsalt"] = "none", "pzt-ident"
    fig, axes = plt.subplots(
        2, len(effects), figsize=(180 / 25.4, 105 / 25.4), sharey="row", layout="constrained", squeeze=False
    )
    for column, effect in zip(axes.T, effects, strict=True):
        chosen = [row for row in rows if row["effect"] == effect]
        over_time(column[0], folder / f"{effect}-{chosen[0]['seed']}" / "errors.csv")
        column[0].set_title(effect.replace("_", " "), fontsize=8)
        of_all(column[1], chosen)
    axes[0, 0].set_ylabel("|displacement − reference| (nm)", fontsize=7)
    axes[1, 0].set_ylabel("RMSE (nm)", fontsize=7)
    handles = [plt.Line2D([], [], color=LOOKS[way], label=name) for way, name in WAYS.items()]
    handles.append(plt.Line2D([], [], color="k", ls=":", label="noise of the sensor"))
    fig.legend(handles=handles, loc="outside lower center", ncols=4, fontsize=7, frameon=False)
    fig.suptitle("A stage with one hidden effect follows a reference by three inverses", fontsize=9)
    fig.savefig(path, metadata={"Date": None})
    fig.savefig(path.with_suffix(".png"), dpi=140)


def over_time(axes: Any, path: Path) -> None:
    time, _, *errors = np.loadtxt(path, delimiter=",", skiprows=1).T
    for way, error in zip(WAYS, errors, strict=True):
        axes.semilogy(time, 1e3 * np.maximum(np.abs(error), 1e-6), color=LOOKS[way], lw=0.5)
    axes.set_ylim(0.01, 5e3)
    axes.set_xlabel("time (s)", fontsize=7)
    axes.tick_params(labelsize=6)


def of_all(axes: Any, rows: Sequence[Mapping[str, Any]]) -> None:
    for row in rows:
        axes.semilogy(range(len(WAYS)), [1e3 * row[way]["rmse"] for way in WAYS], color="#bbbbbb", lw=0.6, zorder=1)
    for place, way in enumerate(WAYS):
        axes.semilogy([place] * len(rows), [1e3 * row[way]["rmse"] for row in rows], "o", ms=3, color=LOOKS[way])
    axes.axhline(1e3 * float(np.median([row["noise"] for row in rows])), color="k", ls=":", lw=0.8)
    axes.set_xticks(range(len(WAYS)), ["line", "plain", "improved"], fontsize=6)
    axes.tick_params(axis="y", labelsize=6)
