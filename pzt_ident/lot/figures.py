"""The figures of a lot: how its quantities spread, and what they depend on."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from pzt_ident.lot.outcome import Lot
from pzt_ident.lot.statistics import FAR, Quantity, Trend, groups, numeric
from pzt_ident.report.figures import Plate
from pzt_ident.report.style import MODEL, QUIET, SHADE, Frame, label, log_ticks, name_panel, panels, width_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

FRAME = Frame(top=4, left=12, bottom=8, down=13)
ROW = 34.0  # mm
USUAL, FAR_OFF = "#5b86a8", str(MODEL["color"])
MOST = 12  # panels of what depends on what


def plates(lot: Lot) -> Iterator[Plate]:
    """The figures of the report, each with the section that it is in."""
    shown = [item for item in lot.quantities if item.usable.sum() > 1]
    if shown:
        yield Plate(
            "spreads",
            "spreads",
            f"Number of devices by the value of each quantity that their data determine. Shaded: {FAR:g} spreads to "
            "either side of the median. Marked below: devices out of line.",
            partial(_height, count=len(shown)),
            partial(_draw_spreads, lot=lot, shown=shown),
        )
    pairs = [*_trend_panels(lot), *_group_panels(lot)][:MOST]
    if pairs:
        yield Plate(
            "columns",
            "columns",
            "What clearly depends on a column of the table: the lines are medians of slopes (Theil-Sen), the strokes "
            "medians of groups. Devices out of line are marked.",
            partial(_height, count=len(pairs)),
            partial(_draw_columns, lot=lot, pairs=pairs),
        )


def _across(width: float) -> int:
    return 3 if width > 100 else 2


def _height(width: float, count: int) -> float:
    rows = math.ceil(count / _across(width))
    return FRAME.top + FRAME.bottom + rows * ROW - FRAME.down + 13


def _grid(figure: Figure, count: int) -> list[Axes]:
    across = _across(width_of(figure))
    axes = panels(figure, math.ceil(count / across), across, FRAME).ravel().tolist()
    for empty in axes[count:]:
        empty.set_axis_off()
    return axes[:count]


def _far(lot: Lot, item: Quantity) -> np.ndarray:
    names = {finding.device for finding in lot.findings if finding.quantity == item.name}
    return np.array([row["device"] in names for row in lot.done])


def _draw_spreads(figure: Figure, lot: Lot, shown: Sequence[Quantity]) -> None:
    for axes, item in zip(_grid(figure, len(shown)), shown, strict=True):
        values, far = item.values[item.usable], _far(lot, item)[item.usable]
        middle, half = item.median, FAR * item.spread
        low, high = np.min(values), np.max(values)
        count = min(40, max(8, round(2 * math.sqrt(values.size))))
        wide = item.one_sided and low > 0 and high > 5 * middle
        edges = np.geomspace(low, high, count) if wide else np.histogram_bin_edges(values, count)
        below = max(middle - half, low) if item.one_sided else middle - half
        axes.axvspan(max(below, edges[0]), min(middle + half, edges[-1]), color=SHADE, lw=0)
        axes.axvline(middle, color=QUIET, linewidth=0.6)
        axes.hist(values[~far], bins=edges.tolist(), color=USUAL)
        if far.any():
            axes.hist(values[far], bins=edges.tolist(), color=FAR_OFF)
            axes.plot(values[far], np.zeros(far.sum()), "^", color=FAR_OFF, markersize=3, clip_on=False)
        axes.set_ylabel("devices")
        axes.locator_params(axis="both", nbins=5)
        if wide:
            axes.set_xscale("log")
            log_ticks(axes.xaxis, "", item.unit, (low, high))
        else:
            label(axes.xaxis, "", item.unit, values)
        name_panel(axes, item.name)


def _trend_panels(lot: Lot) -> list[tuple[str, str, Trend | None]]:
    return [(trend.quantity, trend.column, trend) for trend in lot.trends if trend.clear]


def _group_panels(lot: Lot) -> list[tuple[str, str, Trend | None]]:
    return [(item.quantity, item.column, None) for item in lot.group_differences if item.clear]


def _draw_columns(figure: Figure, lot: Lot, pairs: Sequence[tuple[str, str, Trend | None]]) -> None:
    by_name = {item.name: item for item in lot.quantities}
    for axes, (name, column, trend) in zip(_grid(figure, len(pairs)), pairs, strict=True):
        item = by_name[name]
        if trend:
            _draw_trend(axes, lot, item, trend)
        else:
            _draw_groups(axes, lot, item, groups(lot.columns, len(lot.done))[column])
        label(axes.yaxis, "", item.unit, item.values[item.usable])
        axes.set_xlabel(column)
        axes.locator_params(axis="y", nbins=5)
        name_panel(axes, name)


def _draw_trend(axes: Axes, lot: Lot, item: Quantity, trend: Trend) -> None:
    x, far = numeric(lot.columns)[trend.column], _far(lot, item)
    both = item.usable & np.isfinite(x)
    axes.plot(x[both & ~far], item.values[both & ~far], ".", color=USUAL, markersize=2.5)
    axes.plot(x[both & far], item.values[both & far], "^", color=FAR_OFF, markersize=3)
    ends = np.array([x[both].min(), x[both].max()])
    axes.plot(ends, trend.at(ends), color=QUIET, linewidth=0.8)
    axes.margins(x=0.05)
    axes.locator_params(axis="x", nbins=5)


def _draw_groups(axes: Axes, lot: Lot, item: Quantity, members: Mapping[str, Any]) -> None:
    far, shift = _far(lot, item), np.random.default_rng(0).uniform(-0.2, 0.2, item.values.size)
    for place, inside in enumerate(members.values()):
        both = item.usable & inside
        axes.plot(place + shift[both & ~far], item.values[both & ~far], ".", color=USUAL, markersize=2.5)
        axes.plot(place + shift[both & far], item.values[both & far], "^", color=FAR_OFF, markersize=3)
        axes.plot(
            [place - 0.3, place + 0.3],
            [np.median(item.values[both])] * 2 if both.any() else [np.nan] * 2,
            color=QUIET,
            linewidth=0.8,
        )
    axes.set_xticks(range(len(members)), list(members))
    axes.set_xlim(-0.6, len(members) - 0.4)
