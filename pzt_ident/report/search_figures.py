"""Figures of the search: how every optimizer came down, and where its estimates lie."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from pzt_ident.data.notation import bounds, unit
from pzt_ident.data.over_axes import together
from pzt_ident.data.signals import Array
from pzt_ident.report.residual_figures import colour_bar
from pzt_ident.report.style import (
    COLUMN,
    DASHES,
    INK,
    MARKERS,
    PALETTE,
    SHADE,
    Frame,
    heading,
    key,
    log_ticks,
    name_panel,
    panels,
    width_of,
)
from pzt_ident.run.results import Results

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

_COSTS = (("evaluations", "evaluations of the model", ""), ("seconds", "wall time", "s"))
_BEST = {"color": INK, "linewidth": 0.7, "linestyle": (0, (1, 1.5))}
_NOISE = {"color": "#009e73", "linewidth": 0.9, "linestyle": (0, (6, 2))}


def optimizers(results: Results) -> list[str]:
    """In the order of the league, which is also the order of the colours."""
    return [row["optimizer"] for row in results.result["league"]]


def convergence_height(width: float) -> float:
    return 124 if width == COLUMN else 76


def draw_convergence(figure: Figure, results: Results) -> None:
    """Best RMSE so far of each optimizer, median and quartiles over its repeats, against evaluations and seconds."""
    looks = {name: _look(place) for place, name in enumerate(optimizers(results))}
    levels = _levels(results)
    keys = [key(name, **look) for name, look in looks.items()] + [key(name, **look) for name, _, look in levels]
    top = heading(figure, "Convergence: median and quartiles of the repeats", keys)
    shape = (2, 1) if width_of(figure) == COLUMN else (1, 2)
    for place, (axes, cost) in enumerate(zip(panels(figure, *shape, Frame(top + 4)).ravel(), _COSTS, strict=True)):
        for name, look in looks.items():
            spent, low, middle, high = descent(results.history[results.history["optimizer"] == name], cost[0])
            axes.fill_between(spent, low, high, color=look["color"], alpha=0.15, linewidth=0, step="post")
            axes.plot(spent, middle, drawstyle="steps-post", **look)
        for _, level, look in levels:
            axes.axhline(level, **look)
        axes.set_xscale("log")
        axes.set_yscale("log")
        log_ticks(axes.xaxis, cost[1], cost[2], axes.get_xlim())
        log_ticks(axes.yaxis, f"best RMSE so far{together(results.units)}", results.unit, axes.get_ylim())
        name_panel(axes, f"against {cost[1]}", place=place)


def descent(history: pd.DataFrame, cost: str, points: int = 60) -> tuple[Array, Array, Array, Array]:
    """Cost, and lower quartile, median and upper quartile of the best RMSE over the repeats at it; a repeat that has
    stopped keeps its last. Costs before the first generation of the slowest repeat are left out."""
    repeats = [own.sort_values(cost) for _, own in history.groupby("repeat")]
    if not repeats:
        return np.empty(0), np.empty(0), np.empty(0), np.empty(0)
    grid = np.unique(history[cost].to_numpy(float))
    grid = grid[grid >= max(own[cost].iloc[0] for own in repeats)]
    if grid.size > points:
        grid = grid[np.unique(np.geomspace(1, grid.size, points).astype(int) - 1)]
    reached = np.array([own["best"].to_numpy(float)[own[cost].searchsorted(grid, "right") - 1] for own in repeats])
    reached[~np.isfinite(reached)] = np.nan
    seen = ~np.isnan(reached).all(axis=0)
    reached = reached[:, seen]
    lower, median, upper = np.nanquantile(reached, (0.25, 0.5, 0.75), axis=0)
    return grid[seen], lower, median, upper


def free_parameters(results: Results) -> list[str]:
    """Those that are searched for or stand alone."""
    return [name for name, entry in results.best["parameters"].items() if not entry.get("at")]


def estimates_height(width: float, parameters: int) -> float:
    return 24 + 5.0 * parameters


def draw_estimates(figure: Figure, results: Results) -> None:
    """Where in its bounds every run put each free parameter, the best run ringed: a scatter over the whole box is
    a parameter that the data do not determine."""
    names = free_parameters(results)
    looks = {name: _dot(place) for place, name in enumerate(optimizers(results))}
    keys = [key(name, linestyle="", **look) for name, look in looks.items()]
    ring = {"marker": "o", "markersize": 5.5, "markerfacecolor": "none", "markeredgecolor": INK, "markeredgewidth": 0.7}
    top = heading(figure, "Estimates of all runs within their bounds", [*keys, key("best run", linestyle="", **ring)])
    best = [results.best["parameters"][name] for name in names]
    room = 3 + max(len(_bounds(entry)) for entry in best)  # mm, one a letter
    frame = Frame(top + 1, left=_names_width(max(map(len, names))), right=room)
    axes = panels(figure, 1, 1, frame)[0, 0]
    for place, (optimizer, look) in enumerate(looks.items()):
        own = [run["parameters"] for run in results.result["runs"] if run["optimizer"] == optimizer]
        shift = 0.36 * (place / max(len(looks) - 1, 1) - 0.5)
        xs = [within(parameters[name]) for name in names for parameters in own]
        axes.plot(xs, np.repeat(np.arange(len(names)) + shift, len(own)), linestyle="", clip_on=False, **look)
    axes.plot([within(entry) for entry in best], range(len(names)), linestyle="", clip_on=False, **ring)
    for row, entry in enumerate(best):
        axes.axhline(row, color=SHADE, linewidth=0.5, zorder=0)
        axes.annotate(_bounds(entry), (1.02, row), (6, 0), textcoords="offset points", va="center", size=5.5)
    axes.set_ylim(len(names) - 0.4, -0.6)
    axes.set_yticks(range(len(names)), names)
    axes.set_xlim(-0.02, 1.02)
    axes.set_xticks([0, 0.5, 1], ["lower", "middle", "upper"])
    axes.set_xlabel("place within the bounds")


def within(entry: Mapping[str, Any]) -> float:
    """Place of a value between its bounds, 0 to 1; of the logarithms where the bounds span two decades or more."""
    value, lower, upper = entry["value"], entry["lower"], entry["upper"]
    if spans_decades(entry):
        value, lower, upper = math.log(max(value, lower)), math.log(lower), math.log(upper)
    return (value - lower) / (upper - lower)


def spans_decades(entry: Mapping[str, Any]) -> bool:
    return entry["lower"] > 0 and entry["upper"] >= 100 * entry["lower"]


def correlation_height(width: float, longest: int, parameters: int) -> float:
    return 10 + _names_width(longest) + _map_width(width, longest, parameters)


def draw_correlation(figure: Figure, results: Results) -> None:
    """Correlations of the best run's estimates; grey where the data do not determine them."""
    names, matrix = correlation(results)
    width, longest = width_of(figure), max(map(len, names))
    top, left = heading(figure, "Correlation of the estimates, best run"), _names_width(longest)
    across = _map_width(width, longest, len(names))
    axes = panels(figure, 1, 1, Frame(top + 1, left=left, right=width - left - across, bottom=left))[0, 0]
    image = axes.imshow(matrix, cmap="RdBu_r", vmin=-1, vmax=1, aspect="auto", interpolation="none")
    axes.set_facecolor(SHADE)
    axes.set_xticks(range(len(names)), names, rotation=90)
    axes.set_yticks(range(len(names)), names)
    axes.tick_params(length=0)
    axes.spines[:].set_visible(False)
    for (row, column), value in np.ndenumerate(matrix):
        if across > 6 * len(names) and np.isfinite(value):
            shade = "white" if abs(value) > 0.65 else INK
            axes.text(
                column,
                row,
                f"{round(value, 2) + 0.0:.2f}".replace("-", "−"),
                ha="center",
                va="center",
                color=shade,
                size=5.5,
            )
    frame = Frame(top + 1, right=width - left - across, bottom=left)
    colour_bar(figure, image, frame).set_label_text("correlation")


def _names_width(longest: int) -> float:
    return 4 + 1.22 * longest


def _map_width(width: float, longest: int, parameters: int) -> float:
    return min(width - _names_width(longest) - 17, 11.0 * parameters, 100.0)


def correlation(results: Results) -> tuple[list[str], Array]:
    """Names and matrix, NaN where there is no correlation."""
    found = results.best.get("correlation") or {"names": [], "matrix": []}
    return found["names"], np.array(found["matrix"], dtype=float).reshape((len(found["names"]),) * 2)


def _look(place: int) -> dict[str, Any]:
    return {"color": PALETTE[place % len(PALETTE)], "linestyle": DASHES[place % len(DASHES)], "linewidth": 1.0}


def _dot(place: int) -> dict[str, Any]:
    colour, marker = PALETTE[place % len(PALETTE)], MARKERS[place % len(MARKERS)]
    return {"color": colour, "marker": marker, "markersize": 3.2, "markeredgewidth": 0, "alpha": 0.8}


def _levels(results: Results) -> list[tuple[str, float, dict[str, Any]]]:
    """Horizontal lines: the best result of all runs, after its polish, and the noise floor; a zero has no place on a
    logarithmic axis."""
    best, floor = results.best["rmse"]["identify"], results.floor or 0.0
    return [("best, polished", best, _BEST)] * (best > 0) + [("noise floor", floor, _NOISE)] * (floor > 0)


def _bounds(entry: Mapping[str, Any]) -> str:
    text = f"{bounds(entry['lower'], entry['upper'])} {unit(entry['unit'])}".strip()
    return text + " (log)" * spans_decades(entry)
