"""Figures of the search: convergence of each optimizer, its estimates, and their correlation."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from pzt_ident.data.notation import bounds, unit
from pzt_ident.data.over_axes import together
from pzt_ident.data.signals import Array
from pzt_ident.report.residual_figures import colour_bar
from pzt_ident.report.room import fit
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
from pzt_ident.run.results import History, Results

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_COSTS = (("evaluations", "evaluations of the model", ""), ("seconds", "wall time", "s"))
_BEST = {"color": INK, "linewidth": 0.7, "linestyle": (0, (1, 1.5))}
_NOISE = {"color": "#009e73", "linewidth": 0.9, "linestyle": (0, (6, 2))}


def optimizers(results: Results) -> list[str]:
    """Names in the order of the league, which is also the order of the colours."""
    return [row["optimizer"] for row in results.result["league"]]


def convergence_height(width: float) -> float:
    return 124 if width == COLUMN else 76


def draw_convergence(figure: Figure, results: Results) -> None:
    """Best RMSE so far of each optimizer against evaluations and wall time: median and quartiles over its repeats."""
    styles = {name: _line_style(place) for place, name in enumerate(optimizers(results))}
    levels = _levels(results)
    keys = [key(name, **style) for name, style in styles.items()]
    keys += [key(name, **style) for name, _, style in levels]
    top = heading(figure, "Convergence: median and quartiles of the repeats", keys)
    shape = (2, 1) if width_of(figure) == COLUMN else (1, 2)
    for place, (axes, cost) in enumerate(zip(panels(figure, *shape, Frame(top + 4)).ravel(), _COSTS, strict=True)):
        for name, style in styles.items():
            own = results.history["optimizer"] == name
            history = {column: values[own] for column, values in results.history.items()}
            spent, low, median, high = convergence(history, cost[0])
            axes.fill_between(spent, low, high, color=style["color"], alpha=0.15, linewidth=0, step="post")
            axes.plot(spent, median, drawstyle="steps-post", **style)
        for _, level, style in levels:
            axes.axhline(level, **style)
        axes.set_xscale("log")
        axes.set_yscale("log")
        log_ticks(axes.xaxis, cost[1], cost[2], axes.get_xlim())
        log_ticks(axes.yaxis, f"best RMSE so far{together(results.units)}", results.unit, axes.get_ylim())
        name_panel(axes, f"against {cost[1]}", place=place)


def convergence(history: History, cost: str, points: int = 60) -> tuple[Array, Array, Array, Array]:
    """Cost, and the lower quartile, median and upper quartile over the repeats of the best RMSE at that cost.

    A repeat that has stopped keeps its last value. Costs before the first generation of the slowest repeat are left
    out."""
    spent, best = history[cost], history["best"]
    order = np.argsort(spent, kind="stable")
    repeats = [order[history["repeat"][order] == repeat] for repeat in np.unique(history["repeat"])]
    if not repeats:
        return np.empty(0), np.empty(0), np.empty(0), np.empty(0)
    grid = np.unique(spent)
    grid = grid[grid >= max(spent[repeat[0]] for repeat in repeats)]
    if grid.size > points:
        grid = grid[np.unique(np.geomspace(1, grid.size, points).astype(int) - 1)]
    best = np.array([best[repeat][np.searchsorted(spent[repeat], grid, "right") - 1] for repeat in repeats])
    best[~np.isfinite(best)] = np.nan
    known = ~np.isnan(best).all(axis=0)
    best = best[:, known]
    lower, median, upper = np.nanquantile(best, (0.25, 0.5, 0.75), axis=0)
    return grid[known], lower, median, upper


def free_parameters(results: Results) -> list[str]:
    """Parameters of the best run except those that belong to one drive value each."""
    return [name for name, entry in results.best["parameters"].items() if not entry.get("at")]


def estimates_height(width: float, parameters: int) -> float:
    return 24 + 5.0 * parameters


def draw_estimates(figure: Figure, results: Results) -> None:
    """Estimates of each free parameter from all runs relative to its bounds, the best run ringed."""
    names = free_parameters(results)
    found_by = dict.fromkeys([*optimizers(results), *(run["optimizer"] for run in results.result["runs"])])
    styles = {name: _marker_style(place) for place, name in enumerate(found_by)}
    keys = [key(name, linestyle="", **style) for name, style in styles.items()]
    ring = {"marker": "o", "markersize": 5.5, "markerfacecolor": "none", "markeredgecolor": INK, "markeredgewidth": 0.7}
    top = heading(figure, "Estimates of all runs within their bounds", [*keys, key("best run", linestyle="", **ring)])
    best = [results.best["parameters"][name] for name in names]
    most = width_of(figure) / 3  # of the names, and of the bounds
    axes = panels(figure, 1, 1, Frame(top + 1))[0, 0]
    for place, (optimizer, style) in enumerate(styles.items()):
        estimates = [run["parameters"] for run in results.result["runs"] if run["optimizer"] == optimizer]
        shift = 0.36 * (place / max(len(styles) - 1, 1) - 0.5)
        xs = [within(parameters[name]) for name in names for parameters in estimates]
        axes.plot(xs, np.repeat(np.arange(len(names)) + shift, len(estimates)), linestyle="", clip_on=False, **style)
    axes.plot([within(entry) for entry in best], range(len(names)), linestyle="", clip_on=False, **ring)
    for row, entry in enumerate(best):
        axes.axhline(row, color=SHADE, linewidth=0.5, zorder=0)
        text = fit(_bounds(entry), most, 5.5)
        axes.annotate(text, (1.02, row), (6, 0), textcoords="offset points", va="center", size=5.5)
    axes.set_ylim(len(names) - 0.4, -0.6)
    axes.set_yticks(range(len(names)), [fit(name, most, 6) for name in names])
    axes.set_xlim(-0.02, 1.02)
    axes.set_xticks([0, 0.5, 1], ["lower", "middle", "upper"])
    axes.set_xlabel("position within the bounds")


def within(entry: Mapping[str, Any]) -> float:
    """Position of a value between its bounds, 0 to 1; logarithmic where the bounds span two decades or more."""
    value, lower, upper = entry["value"], entry["lower"], entry["upper"]
    if spans_decades(entry):
        value, lower, upper = math.log(max(value, lower)), math.log(lower), math.log(upper)
    return (value - lower) / (upper - lower)


def spans_decades(entry: Mapping[str, Any]) -> bool:
    return entry["lower"] > 0 and entry["upper"] >= 100 * entry["lower"]


def correlation_height(width: float, longest: int, parameters: int) -> float:
    return 10 + _names_width(longest) + _map_width(width, longest, parameters)


def draw_correlation(figure: Figure, results: Results) -> None:
    """Correlation matrix of the best run's estimates; grey where it is not defined."""
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
                in_layout=False,
            )
    frame = Frame(top + 1, right=width - left - across, bottom=left)
    colour_bar(figure, image, frame).set_label_text("correlation")


def _names_width(longest: int) -> float:
    return 4 + 1.22 * longest


def _map_width(width: float, longest: int, parameters: int) -> float:
    return min(width - _names_width(longest) - 17, 11.0 * parameters, 100.0)


def correlation(results: Results) -> tuple[list[str], Array]:
    """Names (n) and correlation matrix (n, n), NaN where a correlation is not defined."""
    stored = results.best.get("correlation") or {"names": [], "matrix": []}
    names = stored["names"]
    return names, np.array(stored["matrix"], dtype=float).reshape(len(names), len(names))


def _line_style(place: int) -> dict[str, Any]:
    return {"color": PALETTE[place % len(PALETTE)], "linestyle": DASHES[place % len(DASHES)], "linewidth": 1.0}


def _marker_style(place: int) -> dict[str, Any]:
    colour, marker = PALETTE[place % len(PALETTE)], MARKERS[place % len(MARKERS)]
    return {"color": colour, "marker": marker, "markersize": 3.2, "markeredgewidth": 0, "alpha": 0.8}


def _levels(results: Results) -> list[tuple[str, float, dict[str, Any]]]:
    """Horizontal lines (name, RMSE, style): the best polished result and the noise floor; zero is left out, since
    the axis is logarithmic."""
    best, floor = results.best["rmse"]["identify"], results.floor or 0.0
    return [("best, polished", best, _BEST)] * (best > 0) + [("noise floor", floor, _NOISE)] * (floor > 0)


def _bounds(entry: Mapping[str, Any]) -> str:
    text = f"{bounds(entry['lower'], entry['upper'])} {unit(entry['unit'])}".strip()
    return text + " (log)" * spans_decades(entry)
