"""Figures of the misfit: its shares by bin, a map over two quantities, and the worst segments."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from pzt_ident.data.notation import percent, unit
from pzt_ident.data.signals import Array, Trace
from pzt_ident.report.decimation import decimate, decimate_curve
from pzt_ident.report.residual_figures import colour_bar
from pzt_ident.report.room import fit
from pzt_ident.report.sentences import USE_NAMES
from pzt_ident.report.style import (
    COLUMN,
    INK,
    PALETTE,
    QUIET,
    SHADE,
    Frame,
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
_DOMINANT, _OTHER = PALETTE[1], "#f0bf99"


def views_with_samples(misfit: Facts) -> list[Facts]:
    """The views with samples in more than one bin, without their empty bins."""
    views = [
        view | {"bins": [item | {"place": i} for i, item in enumerate(view["bins"]) if item["samples"] > 0]}
        for view in misfit["views"]
    ]
    return [view for view in views if len(view["bins"]) > 1]


def stacks(misfit: Facts, width: float) -> list[list[Facts]]:
    """The views in one column, or in two of similar height."""
    views = views_with_samples(misfit)
    ends = np.cumsum([len(view["bins"]) + 1.6 for view in views])
    left = len(views) if width == COLUMN else int(np.abs(ends - ends[-1] / 2).argmin()) + 1
    return [stack for stack in (views[:left], views[left:]) if stack]


def shares_height(width: float, misfit: Facts) -> float:
    return 24 + 3.1 * max(_rows(stack) for stack in stacks(misfit, width))


def _rows(stack: list[Facts]) -> float:
    return sum(len(view["bins"]) + 1.6 for view in stack)


def draw_shares(figure: Figure, misfit: Facts) -> None:
    """For every bin of every view, the share of the misfit as a bar and the share of the samples as a tick."""
    keys = [
        patch("misfit", color=_OTHER),
        patch("misfit, dominant", color=_DOMINANT),
        key("samples", color=INK, marker="|", linestyle="none", markersize=5),
    ]
    top = heading(figure, f"Shares of the misfit, axis {misfit['axis']}", keys)
    columns = stacks(misfit, width_of(figure))
    rows = max(map(_rows, columns))
    frame = Frame(top + 1, left=_LABELS, across=_LABELS + 2)
    for axes, stack in zip(panels(figure, 1, len(columns), frame)[0], columns, strict=True):
        _draw_stack(axes, stack)
        axes.set(xlim=(0, 100), ylim=(rows, 0))
        axes.set_xlabel("share [%]")
        axes.tick_params(axis="y", length=0)
        axes.spines["left"].set_visible(False)
        axes.grid(axis="x", color=SHADE, linewidth=0.4)
        axes.set_axisbelow(True)


def _draw_stack(axes: Axes, views: list[Facts]) -> None:
    ticks, labels, row = [], [], 0.0
    for view in views:
        axes.text(-0.02, row + 0.9, view["name"], weight="bold", ha="right", transform=axes.get_yaxis_transform())
        row += 1.6
        dominant_bins = view["dominant"]
        for item in view["bins"]:
            dominant = dominant_bins and dominant_bins["first"] <= item["place"] <= dominant_bins["last"]
            axes.barh(row, 100 * item["share"], 0.72, color=_DOMINANT if dominant else _OTHER)
            axes.plot(2 * [100 * item["samples"]], [row - 0.42, row + 0.42], color=INK, linewidth=0.8)
            ticks.append(row)
            labels.append(fit(_printed(item["label"], view["unit"]), _LABELS - 2, 6))
            row += 1
    axes.set_yticks(ticks, labels)


def _printed(text: str, raw_unit: str) -> str:
    """The label of a bin with its minus signs and unit as printed."""
    return (
        re.sub(r"-(?=\d)", "−", text.removesuffix(raw_unit)) + unit(raw_unit)
        if raw_unit and text.endswith(raw_unit)
        else text
    )


def map_height(width: float, misfit: Facts) -> float:
    _, rows, columns = _cells(misfit["map"])
    return 8 + _bottom_margin(columns, width) + (4.2 if width == COLUMN else 6.0) * len(rows)


def _cells(crossed: Facts) -> tuple[Array, dict[int, str], dict[int, str]]:
    """RMSE by cell (rows, columns), and the labels of the rows and columns with samples by their index."""
    rmse = np.array(crossed["rmse"], dtype=float)
    rows, columns = (np.flatnonzero(np.isfinite(rmse).any(axis=axis)).tolist() for axis in (1, 0))
    labels = ({k: crossed["row_labels"][k] for k in rows}, {k: crossed["column_labels"][k] for k in columns})
    return rmse[np.ix_(rows, columns)], *labels


def _bottom_margin(columns: dict[int, str], width: float) -> float:
    """Height of the column labels, mm: 10, more where they do not fit side by side and are turned upright."""
    longest = 1.05 * min(max(map(len, columns.values())), 20)
    return 10.0 if longest < (width - _LABELS - 17) / len(columns) else 7 + max(longest, 4)


def draw_misfit_map(figure: Figure, misfit: Facts) -> None:
    """RMSE over two quantities as colour, the share of the squared misfit in % as numbers."""
    crossed = misfit["map"]
    rmse, rows, columns = _cells(crossed)
    share = np.array(crossed["share"])[np.ix_(list(rows), list(columns))]
    title = f"Misfit by {crossed['rows']} and {crossed['columns']}, axis {misfit['axis']}"
    bottom = _bottom_margin(columns, width_of(figure))
    frame = Frame(heading(figure, title) + 1, left=_LABELS, right=17, bottom=bottom)
    axes = panels(figure, 1, 1, frame)[0, 0]
    axes.set_facecolor(SHADE)
    image = axes.imshow(rmse, vmin=0, cmap="YlOrBr", aspect="auto", interpolation="none")
    for (i, j), value in np.ndenumerate(share):
        if value >= 0.005:
            dark = rmse[i, j] > 0.6 * np.nanmax(rmse)
            colour = "white" if dark else INK
            axes.text(j, i, f"{100 * value:.0f}", ha="center", va="center", size=5.5, color=colour, in_layout=False)
    units = {view["name"]: view["unit"] for view in misfit["views"]}
    for axis, name, labels in ((axes.yaxis, "rows", rows), (axes.xaxis, "columns", columns)):
        view_unit = units[crossed[name]]
        axis.set_ticks(range(len(labels)), [fit(_printed(text, view_unit), 22, 6) for text in labels.values()])
    axes.tick_params(axis="x", rotation=90 if bottom > 10 else 0)
    axes.tick_params(length=0)
    axes.set_xlabel(crossed["columns"])
    label(colour_bar(figure, image, frame), "RMSE", misfit["unit"], (float(np.nanmax(rmse)),))


def traces_of_worst(misfit: Facts, traces: Sequence[Trace]) -> list[Trace]:
    """Traces of the up to three records that contain the worst segments, worst first."""
    names = dict.fromkeys(segment["record"] for segment in misfit["worst"])
    return [trace for name in list(names)[:3] for trace in traces if trace.record == name]


def worst_height(width: float, records: int) -> float:
    return 14 + (96 if width == COLUMN else 50) * records


def draw_worst(figure: Figure, misfit: Facts, traces: Sequence[Trace], bins: int = 300) -> None:
    """Residual over time and measured loop of each record with a worst segment; the segments are coloured."""
    segments = [segment for segment in misfit["worst"] if segment["record"] in {trace.record for trace in traces}]
    ranked = list(zip(PALETTE, segments, strict=False))
    keys = [key(f"{percent(segment['share'])} of the misfit", color=colour, linewidth=2) for colour, segment in ranked]
    top = heading(figure, f"Worst segments, axis {misfit['axis']}", keys)
    shape = (2 * len(traces), 1) if width_of(figure) == COLUMN else (len(traces), 2)
    grid = panels(figure, *shape, Frame(top + 4)).reshape(len(traces), 2)
    for (left, right), trace in zip(grid, traces, strict=True):
        marked = [(colour, segment) for colour, segment in ranked if segment["record"] == trace.record]
        _draw_residual(left, trace, marked, bins)
        _draw_loop(right, trace, marked, 2 * bins)


def _draw_residual(axes: Axes, trace: Trace, marked: list[tuple[str, Facts]], bins: int) -> None:
    name_panel(axes, trace.record, USE_NAMES[trace.use])
    for colour, segment in marked:
        axes.axvspan(segment["start"], segment["end"], color=colour, alpha=0.35, linewidth=0)
    scored = np.flatnonzero(trace.scored)
    shown = scored[decimate(trace.residual[scored], bins)]
    axes.plot(trace.time[shown], trace.residual[shown], color=INK, linewidth=0.4)
    axes.set_xlabel("time [s]")
    label(axes.yaxis, "residual", trace.unit, axes.get_ylim())


def _draw_loop(axes: Axes, trace: Trace, marked: list[tuple[str, Facts]], points: int) -> None:
    scored = np.flatnonzero(trace.scored)
    shown = scored[decimate_curve(trace.drive[scored], trace.response[scored], points)]
    axes.plot(trace.drive[shown], trace.response[shown], color=QUIET, linewidth=0.4)
    for colour, segment in reversed(marked):
        inside = np.flatnonzero((trace.time >= segment["start"]) & (trace.time <= segment["end"]))
        shown = inside[decimate_curve(trace.drive[inside], trace.response[inside], points)]
        axes.plot(trace.drive[shown], trace.response[shown], color=colour, linewidth=1.6)
    label(axes.xaxis, "drive", trace.drive_unit, trace.drive)
    label(axes.yaxis, "response", trace.unit, trace.response)
