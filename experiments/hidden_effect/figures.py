"""The confusion matrix, and the staircase of one case of each kind."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes

from experiments.hidden_effect.hidden import CATALOGUE, OUTSIDE
from experiments.hidden_effect.score import NOTHING, Score, confusion

FORMATS = ("svg", "png")


def draw(scores: Sequence[Score], out: Path) -> None:
    _confusion(confusion(scores), out / "confusion")
    firsts = list({one.kind: one for one in reversed(scores)}.values())[::-1]
    _staircases(firsts, out / "staircases")


def _save(figure: plt.Figure, path: Path) -> None:
    for suffix in FORMATS:
        figure.savefig(path.with_suffix(f".{suffix}"), dpi=130, metadata={"Date": None} if suffix == "svg" else None)
    plt.close(figure)


def _confusion(counts: Counter[tuple[str, str]], path: Path) -> None:
    hidden = [word for word in (*CATALOGUE, NOTHING, *OUTSIDE) if any(pair[0] == word for pair in counts)]
    found = [*CATALOGUE, *sorted({pair[1] for pair in counts} - {*CATALOGUE, NOTHING}), NOTHING]
    table = np.array([[counts[row, column] for column in found] for row in hidden], float).reshape(len(hidden), -1)
    shares = table / np.maximum(table.sum(1, keepdims=True), 1)
    figure, axes = plt.subplots(figsize=(9, 2.5 + 0.24 * len(hidden)), layout="constrained")
    axes.imshow(shares, cmap="Blues", vmin=0, vmax=1, aspect="auto")
    axes.set_xticks(range(len(found)), found, rotation=90)
    axes.set_yticks(range(len(hidden)), hidden)
    axes.set(xlabel="found", ylabel="hidden")
    for (row, column), count in np.ndenumerate(table):
        if count:
            colour = "white" if shares[row, column] > 0.5 else "black"
            axes.text(column, row, f"{count:.0f}", ha="center", va="center", color=colour, fontsize=8)
    _save(figure, path)


def _staircases(scores: Sequence[Score], path: Path) -> None:
    columns = min(len(scores), 3) or 1
    rows = -(-len(scores) // columns) or 1
    figure, grid = plt.subplots(rows, columns, figsize=(4.2 * columns, 3.4 * rows), layout="constrained", squeeze=False)
    for axes, one in zip(grid.flat, scores, strict=False):
        _staircase(axes, one)
    for axes in grid.flat[len(scores) :]:
        axes.set_axis_off()
    _save(figure, path)


def _staircase(axes: Axes, one: Score) -> None:
    places = np.arange(len(one.steps))
    for use, style in (("identify", "-o"), ("validate", "--s")):
        axes.plot(places, [step[use] for step in one.steps], style, markersize=4, label=use)
    axes.axhline(1, color="0.5", linewidth=1)
    axes.text(0, 1.02, "noise floor", color="0.4", fontsize=8, transform=axes.get_yaxis_transform())
    axes.set_yscale("log")
    axes.set_ylim(0.8, 1.3 * max(max(step["identify"], step["validate"]) for step in one.steps))
    for which in (axes.yaxis.set_major_formatter, axes.yaxis.set_minor_formatter):
        which(lambda value, place: f"{value:g}" if f"{value:e}"[0] in "125" else "")
    axes.set_xticks(places, [_label(step) for step in one.steps], rotation=25, ha="right", fontsize=8)
    axes.set_ylabel("RMSE [noise floors]")
    axes.set_title(f"{one.kind.replace('_', ' ')}: {', '.join(one.hidden) or 'nothing hidden'}", fontsize=9)
    axes.legend(fontsize=8)


def _label(step: dict[str, object]) -> str:
    words = [f"{sign} {step[key]}" for sign, key in (("+", "added"), ("−", "removed")) if step.get(key)]
    return ", ".join(words) or "as given"
