"""The figure of parameters that stand for a drive each, such as the weights of a density."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from pzt_ident.report.style import PALETTE, SHADE, Frame, heading, key, label, panels, patch

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def height(width: float) -> float:
    return 62.0


def draw(figure: Figure, name: str, entries: Sequence[dict[str, Any]]) -> None:
    """Each value over the drive that it stands for, with two standard errors; grey where no record moves it."""
    at, values = (np.array(column) for column in zip(*((e["at"][0], e["value"]) for e in entries), strict=True))
    errors = 2 * np.array([entry["standard_error"] or 0.0 for entry in entries])
    still = np.array([entry["verdict"] == "not moved" for entry in entries])
    look = {"color": PALETTE[0], "linestyle": "", "marker": "o", "markersize": 3}
    keys = [key("value, two standard errors", **look)]
    keys += [patch("no record moves these", color=SHADE)] * bool(still.any())
    axes = panels(figure, 1, 1, Frame(heading(figure, name, keys) + 1))[0, 0]
    half = np.diff(at).min() / 2 if at.size > 1 else 1.0
    for place in at[still]:
        axes.axvspan(place - half, place + half, color=SHADE, linewidth=0)
    axes.errorbar(at[~still], values[~still], errors[~still], elinewidth=0.6, **look)  # type: ignore[arg-type]
    axes.axhline(0, color="0.6", linewidth=0.5, zorder=0)
    axes.set_xlim(min(0.0, at[0] - half), at[-1] + half)
    label(axes.xaxis, "drive that each stands for", entries[0]["at"][1], at)
    label(axes.yaxis, name.rpartition(".")[2], entries[0]["unit"], values)
