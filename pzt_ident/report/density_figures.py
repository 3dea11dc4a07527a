"""Figure of parameters that belong to one drive value each, such as the weights of a hysteresis density."""

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
    """Parameter values over their drive values with two standard errors; grey where no record excites them."""
    drives, values = (np.array(column) for column in zip(*((e["at"][0], e["value"]) for e in entries), strict=True))
    errors = 2 * np.array([entry["standard_error"] or 0.0 for entry in entries])
    not_moved = np.array([entry["verdict"] == "not moved" for entry in entries])
    style = {"color": PALETTE[0], "linestyle": "", "marker": "o", "markersize": 3}
    keys = [key("value, two standard errors", **style)]
    keys += [patch("not excited by any record", color=SHADE)] * bool(not_moved.any())
    axes = panels(figure, 1, 1, Frame(heading(figure, name, keys) + 1))[0, 0]
    half = np.diff(drives).min() / 2 if drives.size > 1 else 1.0
    for drive in drives[not_moved]:
        axes.axvspan(drive - half, drive + half, color=SHADE, linewidth=0)
    axes.errorbar(drives[~not_moved], values[~not_moved], errors[~not_moved], elinewidth=0.6, **style)  # type: ignore[arg-type]
    axes.axhline(0, color="0.6", linewidth=0.5, zorder=0)
    axes.set_xlim(min(0.0, drives[0] - half), drives[-1] + half)
    label(axes.xaxis, "drive", entries[0]["at"][1], drives)
    label(axes.yaxis, name.rpartition(".")[2], entries[0]["unit"], values)
