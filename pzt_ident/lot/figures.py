"""The figures of a lot: how its quantities spread, and what they depend on."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from pzt_ident.data.notation import listed, number
from pzt_ident.data.notation import quantity as in_words
from pzt_ident.lot.outcome import Lot
from pzt_ident.lot.statistics import Quantity, Trend, groups, numeric
from pzt_ident.report.figures import Plate
from pzt_ident.report.style import MODEL, QUIET, SHADE, Frame, label, log_ticks, name_panel, panels, width_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

FRAME = Frame(top=4, left=12, bottom=8, down=13)
ROW = 34.0  # mm
USUAL, FAR_OFF = "#5b86a8", str(MODEL["color"])
MOST = 12  # panels of what depends on what
SEEN = 3.0  # times as far as chance takes one of the devices: what is farther is drawn at the rim
NAMED = 6  # devices that a bar names


def plates(lot: Lot) -> Iterator[Plate]:
    """The figures of the report, each with the section that it is in."""
    shown = [quantity for quantity in lot.quantities if quantity.usable.sum() > 1]
    if shown:
        yield Plate(
            "spreads",
            "spreads",
            "Number of devices by the value of each quantity that their data determine. Shaded: as far as chance takes "
            "one of so many devices. Marked below: devices out of line; an arrow at a rim stands for those beyond it.",
            partial(_height, count=len(shown)),
            partial(_draw_spreads, lot=lot, shown=shown),
            bars(lot, shown),
        )
    pairs = [*_trend_panels(lot), *_group_panels(lot)][:MOST]
    if pairs:
        yield Plate(
            "columns",
            "columns",
            "What depends on a column of the table, strongly or weakly, where chance gives any such trend or "
            "difference in one lot of twenty: the lines are medians of slopes (Theil-Sen), the strokes medians of "
            "groups. Devices out of line are marked, by an arrow at a rim where they are beyond it.",
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


def _window(lot: Lot, quantity: Quantity) -> tuple[float, float]:
    """What is shown of a quantity: a device far off, such as one with a wrong unit, does not hide the others."""
    values, half = quantity.values[quantity.usable], SEEN * lot.reach(quantity) * quantity.spread
    low, high = float(np.min(values)), float(np.max(values))
    if _is_wide(quantity) or not half > 0:
        return low, high
    return max(low, quantity.median - half), min(high, quantity.median + half)


def bars(lot: Lot, shown: Sequence[Quantity]) -> dict[str, dict[str, str]]:
    """What a page makes of each panel and of each of its bars: buttons that tell their devices, and between which
    values these lie."""
    parts = {}
    names = np.array([row["device"] for row in lot.done])
    for place, quantity in enumerate(shown):
        parts[f"panel-{place}"] = {"role": "group", "aria-label": f"Devices by {quantity.name}"}
        edges, values = _edges(lot, quantity), quantity.values[quantity.usable]
        ends = np.concatenate([[values.min()], edges[1:-1], [values.max()]])  # the outer bars have what is beyond, too
        inside = np.clip(np.searchsorted(edges, values, "right") - 1, 0, edges.size - 2)
        for bar in np.unique(inside).tolist():
            low, high, devices = ends[bar], ends[bar + 1], names[quantity.usable][inside == bar].tolist()
            last = bar == edges.size - 2
            parts[f"bar-{place}-{bar}"] = {
                "role": "button",
                "tabindex": "-1",
                "aria-label": f"{quantity.name} {number(low)} to {in_words(high, quantity.unit)}: {_some(devices)}",
                "data-quantity": quantity.name,
                "data-count": str(len(devices)),
                "data-low": repr(float(low)),
                "data-below": repr(float(np.nextafter(high, np.inf) if last else high)),
            }
    return parts


def _some(devices: Sequence[str]) -> str:
    more = [f"{len(devices) - NAMED} more"] * (len(devices) > NAMED)
    return listed([*devices[:NAMED], *more])


def _is_wide(quantity: Quantity) -> bool:
    """Whether a quantity is drawn on a logarithmic axis."""
    values = quantity.values[quantity.usable]
    return quantity.one_sided and bool(values.min() > 0 and values.max() > 5 * quantity.median)


def _edges(lot: Lot, quantity: Quantity) -> np.ndarray:
    """Of the bars of a quantity."""
    values = np.clip(quantity.values[quantity.usable], *_window(lot, quantity))
    count = min(40, max(8, round(2 * math.sqrt(values.size))))
    if _is_wide(quantity):
        return np.geomspace(values.min(), values.max(), count)
    return np.histogram_bin_edges(values, count)


def _ticks(values: np.ndarray) -> int:
    """How many ticks an axis below these values has room for: the closer the values, the longer their labels."""
    size, span = np.max(np.abs(values)), np.ptp(values)
    digits = math.log10(size / span) if span > 0 else 0.0
    room = 5 if digits < 1 else 3 if digits < 4 else 1
    return max(room - (1e4 <= size < 1e5), 1)


def _draw_spreads(figure: Figure, lot: Lot, shown: Sequence[Quantity]) -> None:
    parts = bars(lot, shown)
    for place, (axes, quantity) in enumerate(zip(_grid(figure, len(shown)), shown, strict=True)):
        (low, high), far = _window(lot, quantity), _far(lot, quantity)[quantity.usable]
        middle, half = quantity.median, lot.reach(quantity) * quantity.spread
        given, edges = quantity.values[quantity.usable], _edges(lot, quantity)
        values, beyond = np.clip(given, low, high), (given < low) | (given > high)
        below = max(middle - half, low) if quantity.one_sided else middle - half
        axes.set_gid(f"panel-{place}")
        axes.axvspan(max(below, edges[0]), min(middle + half, edges[-1]), color=SHADE, lw=0)
        axes.axvline(middle, color=QUIET, linewidth=0.6)
        axes.hist([values[far], values[~far]], bins=edges.tolist(), color=[FAR_OFF, USUAL], stacked=True)
        for mark, marked in (("^", far & ~beyond), ("<", given < low), (">", given > high)):
            axes.plot(values[marked], np.zeros(marked.sum()), mark, color=FAR_OFF, markersize=3, clip_on=False)
        for bar, (left, right) in enumerate(pairwise(edges)):
            if (name := f"bar-{place}-{bar}") in parts:
                axes.axvspan(left, right, facecolor="none", edgecolor="none", zorder=5).set_gid(name)
        axes.set_ylabel("devices")
        axes.locator_params(axis="x", nbins=_ticks(values))
        axes.locator_params(axis="y", nbins=5, integer=True)
        if _is_wide(quantity):
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
        label(axes.yaxis, "", quantity.unit, np.clip(quantity.values[quantity.usable], *_window(lot, quantity)))
        axes.set_xlabel(column)
        axes.locator_params(axis="y", nbins=5)
        name_panel(axes, name)


def _draw_devices(axes: Axes, x: np.ndarray, lot: Lot, quantity: Quantity, known: np.ndarray) -> None:
    """A point for each device, and an arrow at a rim for each beyond it."""
    (low, high), far, values = _window(lot, quantity), _far(lot, quantity), quantity.values
    axes.plot(x[known & ~far], np.clip(values, low, high)[known & ~far], ".", color=USUAL, markersize=2.5)
    inside = (values >= low) & (values <= high)
    for mark, marked in (("^", far & (values > high)), ("v", far & (values < low)), ("D", far & inside)):
        size = 2 if mark == "D" else 3
        axes.plot(x[known & marked], np.clip(values, low, high)[known & marked], mark, color=FAR_OFF, markersize=size)


def _draw_trend(axes: Axes, lot: Lot, quantity: Quantity, trend: Trend) -> None:
    x = numeric(lot.columns)[trend.column]
    known = quantity.usable & np.isfinite(x)
    _draw_devices(axes, x, lot, quantity, known)
    ends = np.array([x[known].min(), x[known].max()])
    axes.plot(ends, trend.at(ends), color=QUIET, linewidth=0.8)
    axes.margins(x=0.05)
    axes.locator_params(axis="x", nbins=_ticks(x[known]))


def _draw_groups(axes: Axes, lot: Lot, quantity: Quantity, members: Mapping[str, Any]) -> None:
    shift = np.random.default_rng(0).uniform(-0.2, 0.2, quantity.values.size)
    for place, inside in enumerate(members.values()):
        known = quantity.usable & inside
        _draw_devices(axes, place + shift, lot, quantity, known)
        axes.plot(
            [place - 0.3, place + 0.3],
            [np.median(quantity.values[known])] * 2 if known.any() else [np.nan] * 2,
            color=QUIET,
            linewidth=0.8,
        )
    axes.set_xticks(range(len(members)), list(members))
    axes.set_xlim(-0.6, len(members) - 0.4)
