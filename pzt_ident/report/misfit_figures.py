"""Figures of the misfit: its shares, two views of it crossed, and its worst stretches."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from pzt_ident.data.notation import percent, unit
from pzt_ident.data.signals import Array, Trace
from pzt_ident.report.residual_figures import colour_bar
from pzt_ident.report.style import (
    COLUMN,
    INK,
    PALETTE,
    QUIET,
    SHADE,
    Frame,
    along,
    decimate,
    fit,
    heading,
    key,
    label,
    name_panel,
    panels,
    patch,
    width_of,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Facts = dict[str, Any]

_LABELS = 26.0
_STRONG, _WEAK = PALETTE[1], "#f0bf99"


def telling(misfit: Facts) -> list[Facts]:
    """The views with more than one bin in use, with those bins only."""
    used = [
        view | {"bins": [part | {"place": i} for i, part in enumerate(view["bins"]) if part["samples"] > 0]}
        for view in misfit["views"]
    ]
    return [view for view in used if len(view["bins"]) > 1]


def stacks(misfit: Facts, width: float) -> list[list[Facts]]:
    """The views in one column, or in two of about the same height."""
    views = telling(misfit)
    ends = np.cumsum([len(view["bins"]) + 1.6 for view in views])
    left = len(views) if width == COLUMN else int(np.abs(ends - ends[-1] / 2).argmin()) + 1
    return [part for part in (views[:left], views[left:]) if part]


def shares_height(width: float, misfit: Facts) -> float:
    return 24 + 3.1 * max(_rows(stack) for stack in stacks(misfit, width))


def _rows(stack: list[Facts]) -> float:
    return sum(len(view["bins"]) + 1.6 for view in stack)


def draw_shares(figure: Figure, misfit: Facts) -> None:
    """Share of the misfit of every bin of every view as a bar, its share of the samples as a tick."""
    keys = [
        patch("misfit", color=_WEAK),
        patch("misfit, dominant", color=_STRONG),
        key("samples", color=INK, marker="|", linestyle="none", markersize=5),
    ]
    top = heading(figure, f"Where the misfit is, axis {misfit['axis']}", keys)
    parts = stacks(misfit, width_of(figure))
    rows = max(map(_rows, parts))
    frame = Frame(top + 1, left=_LABELS, across=_LABELS + 2)
    for axes, stack in zip(panels(figure, 1, len(parts), frame)[0], parts, strict=True):
        _stack(axes, stack)
        axes.set(xlim=(0, 100), ylim=(rows, 0))
        axes.set_xlabel("share [%]")
        axes.tick_params(axis="y", length=0)
        axes.spines["left"].set_visible(False)
        axes.grid(axis="x", color=SHADE, linewidth=0.4)
        axes.set_axisbelow(True)


def _stack(axes: Axes, views: list[Facts]) -> None:
    ticks, labels, row = [], [], 0.0
    for view in views:
        axes.text(
            -0.02, row + 0.9, f"by {view['name']}", weight="bold", ha="right", transform=axes.get_yaxis_transform()
        )
        row += 1.6
        chosen = view["dominant"]
        for part in view["bins"]:
            strong = chosen and chosen["first"] <= part["place"] <= chosen["last"]
            axes.barh(row, 100 * part["share"], 0.72, color=_STRONG if strong else _WEAK)
            axes.plot(2 * [100 * part["samples"]], [row - 0.42, row + 0.42], color=INK, linewidth=0.8)
            ticks.append(row)
            labels.append(fit(_printed(part["label"], view["unit"]), _LABELS - 2, 6))
            row += 1
    axes.set_yticks(ticks, labels)


def _printed(text: str, of: str) -> str:
    """The label of a bin, its numbers and unit as they are printed."""
    return re.sub(r"-(?=\d)", "−", text.removesuffix(of)) + unit(of) if of and text.endswith(of) else text


def map_height(width: float, misfit: Facts) -> float:
    _, rows, columns = _cells(misfit["map"])
    return 8 + _foot(columns, width) + (4.2 if width == COLUMN else 6.0) * len(rows)


def _cells(crossed: Facts) -> tuple[Array, dict[int, str], dict[int, str]]:
    """RMSE of the cells, and numbers and labels of the rows and columns in use."""
    rmse = np.array(crossed["rmse"], dtype=float)
    rows, columns = (np.flatnonzero(np.isfinite(rmse).any(axis=way)).tolist() for way in (1, 0))
    labels = ({k: crossed["row_labels"][k] for k in rows}, {k: crossed["column_labels"][k] for k in columns})
    return rmse[np.ix_(rows, columns)], *labels


def _foot(columns: dict[int, str], width: float) -> float:
    """What the labels of the columns take, mm: 10 or, where they do not fit side by side and stand upright, more."""
    longest = 1.05 * min(max(map(len, columns.values())), 20)
    return 10.0 if longest < (width - _LABELS - 17) / len(columns) else 7 + max(longest, 4)


def draw_misfit_map(figure: Figure, misfit: Facts) -> None:
    """RMSE where two views cross, as a colour, with the share of the misfit in it, %, as a number."""
    crossed = misfit["map"]
    rmse, rows, columns = _cells(crossed)
    share = np.array(crossed["share"])[np.ix_(list(rows), list(columns))]
    title = f"Misfit by {crossed['rows']} and {crossed['columns']}, axis {misfit['axis']}"
    foot = _foot(columns, width_of(figure))
    frame = Frame(heading(figure, title) + 1, left=_LABELS, right=17, bottom=foot)
    axes = panels(figure, 1, 1, frame)[0, 0]
    axes.set_facecolor(SHADE)
    image = axes.imshow(rmse, vmin=0, cmap="YlOrBr", aspect="auto", interpolation="none")
    for (i, j), part in np.ndenumerate(share):
        if part >= 0.005:
            dark = rmse[i, j] > 0.6 * np.nanmax(rmse)
            axes.text(j, i, f"{100 * part:.0f}", ha="center", va="center", size=5.5, color="white" if dark else INK)
    units = {view["name"]: view["unit"] for view in misfit["views"]}
    for axis, name, chosen in ((axes.yaxis, "rows", rows), (axes.xaxis, "columns", columns)):
        of = units[crossed[name]]
        axis.set_ticks(range(len(chosen)), [fit(_printed(word, of), 22, 6) for word in chosen.values()])
    axes.tick_params(axis="x", rotation=90 if foot > 10 else 0)
    axes.tick_params(length=0)
    axes.set_xlabel(crossed["columns"])
    label(colour_bar(figure, image, frame), "RMSE", misfit["unit"], (float(np.nanmax(rmse)),))


def failing(misfit: Facts, traces: Sequence[Trace]) -> list[Trace]:
    """The records that have a worst stretch, the worst first, three at most."""
    names = dict.fromkeys(one["record"] for one in misfit["worst"])
    return [trace for name in list(names)[:3] for trace in traces if trace.record == name]


def worst_height(width: float, records: int) -> float:
    return 14 + (96 if width == COLUMN else 50) * records


def draw_worst(figure: Figure, misfit: Facts, traces: Sequence[Trace], bins: int = 300) -> None:
    """The residual in time and the measured loop of each record that has a worst stretch, those coloured."""
    drawn = [one for one in misfit["worst"] if one["record"] in {trace.record for trace in traces}]
    ranked = list(zip(PALETTE, drawn, strict=False))
    keys = [key(f"{percent(one['share'])} of the misfit", color=colour, linewidth=2) for colour, one in ranked]
    top = heading(figure, f"Worst stretches, axis {misfit['axis']}", keys)
    shape = (2 * len(traces), 1) if width_of(figure) == COLUMN else (len(traces), 2)
    grid = panels(figure, *shape, Frame(top + 4)).reshape(len(traces), 2)
    for (left, right), trace in zip(grid, traces, strict=True):
        marked = [(colour, one) for colour, one in ranked if one["record"] == trace.record]
        _in_time(left, trace, marked, bins)
        _on_loop(right, trace, marked, 2 * bins)


def _in_time(axes: Axes, trace: Trace, marked: list[tuple[str, Facts]], bins: int) -> None:
    name_panel(axes, trace.record, trace.use)
    for colour, one in marked:
        axes.axvspan(one["start"], one["end"], color=colour, alpha=0.35, linewidth=0)
    scored = np.flatnonzero(trace.scored)
    shown = scored[decimate(trace.residual[scored], bins)]
    axes.plot(trace.time[shown], trace.residual[shown], color=INK, linewidth=0.4)
    axes.set_xlabel("time [s]")
    label(axes.yaxis, "residual", trace.unit, axes.get_ylim())


def _on_loop(axes: Axes, trace: Trace, marked: list[tuple[str, Facts]], points: int) -> None:
    scored = np.flatnonzero(trace.scored)
    shown = scored[along(trace.drive[scored], trace.response[scored], points)]
    axes.plot(trace.drive[shown], trace.response[shown], color=QUIET, linewidth=0.4)
    for colour, one in reversed(marked):
        inside = np.flatnonzero((trace.time >= one["start"]) & (trace.time <= one["end"]))
        shown = inside[along(trace.drive[inside], trace.response[inside], points)]
        axes.plot(trace.drive[shown], trace.response[shown], color=colour, linewidth=1.6)
    label(axes.xaxis, "drive", trace.drive_unit, trace.drive)
    label(axes.yaxis, "response", trace.unit, trace.response)
