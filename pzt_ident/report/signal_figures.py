"""Figures of the signals: model and measurement over time and as loops."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from pzt_ident.data.signals import Array, Trace
from pzt_ident.report.decimation import decimate, decimate_curve
from pzt_ident.report.sentences import USE_NAMES
from pzt_ident.report.style import (
    COLUMN,
    INK,
    MEASURED,
    MODEL,
    NOISE,
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

_CURVES = (("measured", MEASURED), ("model", MODEL))


def time_height(width: float) -> float:
    return 70 if width == COLUMN else 78


def draw_time(figure: Figure, trace: Trace, noise: float | None, bins: int) -> None:
    """Measured and modelled response over time, the residual below; samples that are not scored are shaded."""
    keys = [key(name, **style) for name, style in _CURVES]
    keys += [patch("± noise floor (RMS)", **NOISE)] * bool(noise) + [patch("not scored", color=SHADE)] * (
        trace.settle > 0
    )
    top = heading(figure, f"Model and measurement, axis {trace.axis}", keys)
    upper, lower = panels(figure, 2, 1, Frame(top + 4, down=3.5), sharex=True, height_ratios=(1.8, 1))[:, 0]
    name_panel(upper, trace.record, USE_NAMES[trace.use])
    for axes, values, style in (
        (upper, trace.response, MEASURED),
        (upper, trace.model, MODEL),
        (lower, trace.residual, {"color": INK, "linewidth": 0.4}),
    ):
        shown = decimate(values, bins)
        axes.plot(trace.time[shown], values[shown], **style)
        if trace.settle > 0 and style is not MODEL:
            axes.axvspan(trace.time[0], trace.time[0] + trace.settle, color=SHADE, linewidth=0)
    lower.axhspan(-(noise or 0), noise or 0, linewidth=0, **NOISE)
    for edge in (-noise, noise) if noise else ():
        lower.axhline(edge, color=NOISE["color"], linewidth=0.6, zorder=3)
    lower.set_ylim(*_limits(trace, noise or 0.0))
    lower.set_xlim(trace.time[0], trace.time[-1])
    label(upper.yaxis, "response", trace.unit, trace.response)
    label(lower.yaxis, "residual", trace.unit, lower.get_ylim())
    lower.set_xlabel("time [s]")


def draw_loops(figure: Figure, traces: Sequence[Trace], points: int) -> None:
    """Response against drive, one panel per record."""
    title = f"Response against drive, axis {traces[0].axis}"
    top = heading(figure, title, [key(name, **style) for name, style in _CURVES])
    for axes, trace in zip(record_panels(figure, traces, Frame(top + 4)), traces, strict=True):
        shown = decimate_curve(trace.drive, trace.response, points)
        for values, style in ((trace.response, MEASURED), (trace.model, MODEL)):
            axes.plot(trace.drive[shown], values[shown], **style | {"linewidth": 0.65 * style["linewidth"]})
        label(axes.yaxis, "response", trace.unit, trace.response)


def record_panels(figure: Figure, traces: Sequence[Trace], frame: Frame) -> list[Axes]:
    """One titled panel per record with the drive on its x axis."""
    grid = panels(figure, *_shape(width_of(figure), len(traces)), frame).ravel()
    for place, (axes, trace) in enumerate(zip(grid, traces, strict=False)):
        name_panel(axes, trace.record, USE_NAMES[trace.use], place if len(traces) > 1 else None)
        label(axes.xaxis, "drive", trace.drive_unit, trace.drive)
    for unused in grid[len(traces) :]:
        unused.set_axis_off()
    return list(grid[: len(traces)])


def records_height(width: float, records: int) -> float:
    """Height in mm of a figure with one panel per record."""
    rows, columns = _shape(width, records)
    return 24 + rows * 0.72 * min(70.0, width / columns - 13) + 14 * (rows - 1)


def _shape(width: float, records: int) -> tuple[int, int]:
    columns = 2 if records == 4 else min(records, 3) if width > COLUMN else 1 if records < 4 else 2
    return -(-records // columns), columns


def _limits(trace: Trace, noise: float) -> tuple[float, float]:
    """Limits of the y axis, set by the scored residual and the noise floor; samples not scored may lie outside."""
    scored = trace.residual[trace.scored]
    ends: Array = np.append(scored[np.isfinite(scored)], [-1.2 * noise, 1.2 * noise])
    margin = 0.06 * float(np.ptp(ends)) or 1.0
    return float(ends.min()) - margin, float(ends.max()) + margin
