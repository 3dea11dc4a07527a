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
    shown = [quantity for quantity in lot.quantities if quantity.usable.sum() > 1]
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


def _far(lot: Lot, quantity: Quantity) -> np.ndarray:
    names = {finding.device for finding in lot.findings if finding.quantity == quantity.name}
    return np.array([row["device"] in names for row in lot.done])


def _draw_spreads(figure: Figure, lot: Lot, shown: Sequence[Quantity]) -> None:
    for axes, quantity in zip(_grid(figure, len(shown)), shown, strict=True):
        values, far = quantity.values[quantity.usable], _far(lot, quantity)[quantity.usable]
        middle, half = quantity.median, FAR * quantity.spread
        low, high = np.min(values), np.max(values)
        count = min(40, max(8, round(2 * math.sqrt(values.size))))
        wide = quantity.one_sided and low > 0 and high > 5 * middle
        edges = np.geomspace(low, high, count) if wide else np.histogram_bin_edges(values, count)
        below = max(middle - half, low) if quantity.one_sided else middle - half
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
            log_ticks(axes.xaxis, "", quantity.unit, (low, high))
        else:
            label(axes.xaxis, "", quantity.unit, values)
        name_panel(axes, quantity.name)


def _trend_panels(lot: Lot) -> list[tuple[str, str, Trend | None]]:
    return [(trend.quantity, trend.column, trend) for trend in lot.trends if trend.clear]


def _group_panels(lot: Lot) -> list[tuple[str, str, Trend | None]]:
    return [(difference.quantity, difference.column, None) for difference in lot.group_differences if difference.clear]


def _draw_columns(figure: Figure, lot: Lot, pairs: Sequence[tuple[str, str, Trend | None]]) -> None:
    by_name = {quantity.name: quantity for quantity in lot.quantities}
    for axes, (name, column, trend) in zip(_grid(figure, len(pairs)), pairs, strict=True):
        quantity = by_name[name]
        if trend:
            _draw_trend(axes, lot, quantity, trend)
        else:
            _draw_groups(axes, lot, quantity, groups(lot.columns, len(lot.done))[column])
        label(axes.yaxis, "", quantity.unit, quantity.values[quantity.usable])
        axes.set_xlabel(column)
        axes.locator_params(axis="y", nbins=5)
        name_panel(axes, name)


def _draw_trend(axes: Axes, lot: Lot, quantity: Quantity, trend: Trend) -> None:
    x, far = numeric(lot.columns)[trend.column], _far(lot, quantity)
    known = quantity.usable & np.isfinite(x)
    axes.plot(x[known & ~far], quantity.values[known & ~far], ".", color=USUAL, markersize=2.5)
    axes.plot(x[known & far], quantity.values[known & far], "^", color=FAR_OFF, markersize=3)
    ends = np.array([x[known].min(), x[known].max()])
    axes.plot(ends, trend.at(ends), color=QUIET, linewidth=0.8)
    axes.margins(x=0.05)
    axes.locator_params(axis="x", nbins=5)


def _draw_groups(axes: Axes, lot: Lot, quantity: Quantity, members: Mapping[str, Any]) -> None:
    far, shift = _far(lot, quantity), np.random.default_rng(0).uniform(-0.2, 0.2, quantity.values.size)
    for place, inside in enumerate(members.values()):
        known = quantity.usable & inside
        axes.plot(place + shift[known & ~far], quantity.values[known & ~far], ".", color=USUAL, markersize=2.5)
        axes.plot(place + shift[known & far], quantity.values[known & far], "^", color=FAR_OFF, markersize=3)
        axes.plot(
            [place - 0.3, place + 0.3],
            [np.median(quantity.values[known])] * 2 if known.any() else [np.nan] * 2,
            color=QUIET,
            linewidth=0.8,
        )
    axes.set_xticks(range(len(members)), list(members))
    axes.set_xlim(-0.6, len(members) - 0.4)
