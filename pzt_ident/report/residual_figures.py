"""Figures of the residual: by branch, along the loop, and its distribution."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.signals import Array, Trace
from pzt_ident.report.sentences import USE_NAMES
from pzt_ident.report.signal_figures import record_panels
from pzt_ident.report.style import (
    COLUMN,
    NOISE,
    PALETTE,
    QUIET,
    Frame,
    heading,
    height_of,
    key,
    label,
    name_panel,
    panels,
    patch,
    width_of,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure

_BRANCHES = (("rising drive", 1, PALETTE[0]), ("falling drive", -1, PALETTE[1]))
AT_ONCE = 65536
"""Samples that are numbers of Python's at a time."""
_USE_COLOURS = (("identify", PALETTE[0]), ("validate", PALETTE[1]))


def draw_branches(figure: Figure, traces: Sequence[Trace], noise: float | None) -> None:
    """Residual against rising and falling drive: the median, and the band that contains 90 % of the samples."""
    keys = [key(name, color=colour) for name, _, colour in _BRANCHES]
    keys += [patch("± noise floor (RMS)", **NOISE)] * bool(noise)
    top = heading(figure, f"Residual against drive, axis {traces[0].axis}: median and 90 % band", keys)
    for axes, trace in zip(record_panels(figure, traces, Frame(top + 4)), traces, strict=True):
        signs = branches(trace.drive)
        for _, sign, colour in _BRANCHES:
            on_branch = trace.scored & (signs == sign)
            drive, low, median, high = quantile_band(trace.drive[on_branch], trace.residual[on_branch])
            axes.fill_between(drive, low, high, color=colour, alpha=0.2, linewidth=0)
            axes.plot(drive, median, color=colour)
        axes.axhspan(-(noise or 0), noise or 0, linewidth=0, **NOISE)
        axes.axhline(0, color=QUIET, linewidth=0.4, zorder=0)
        label(axes.yaxis, "residual", trace.unit, axes.get_ylim())


def draw_map(figure: Figure, traces: Sequence[Trace]) -> None:
    """The measured loop coloured by the mean residual."""
    frame = Frame(heading(figure, f"Residual along the loop, axis {traces[0].axis}") + 4, right=17)
    scored = np.abs(np.concatenate([trace.residual[trace.scored] for trace in traces]))
    largest = float(np.nanquantile(scored, 0.98))
    for axes, trace in zip(record_panels(figure, traces, frame), traces, strict=True):
        cells, extent = cell_means(trace)
        image = axes.imshow(
            cells,
            extent=extent,
            vmin=-largest,
            vmax=largest,
            origin="lower",
            aspect="auto",
            interpolation="none",
            cmap="PuOr_r",
        )
        label(axes.yaxis, "response", trace.unit, extent[2:])
    label(colour_bar(figure, image, frame), "mean residual", traces[0].unit, (largest,))


def colour_bar(figure: Figure, image: Any, frame: Frame) -> Axis:
    """A colour bar in the right margin of the frame (at least 17 mm); returns the bar's axis."""
    width, height = width_of(figure), height_of(figure)
    place = (1 - (frame.right - 3) / width, frame.bottom / height, 2.5 / width, 1 - (frame.top + frame.bottom) / height)
    bar = figure.colorbar(image, cax=figure.add_axes(place))
    bar.outline.set_linewidth(0.4)  # type: ignore[operator]
    return bar.ax.yaxis


def histogram_height(width: float, axes: int) -> float:
    return 20 + 44 * axes if width == COLUMN else 62


def draw_histogram(figure: Figure, traces: Sequence[Trace], noise: Mapping[str, float | None]) -> None:
    """Histograms of the scored residuals, one panel per axis, identification and validation records separately."""
    names = list(dict.fromkeys(trace.axis for trace in traces))
    uses = [(use, colour) for use, colour in _USE_COLOURS if any(trace.use == use for trace in traces)]
    keys = [key(USE_NAMES[use], color=colour) for use, colour in uses]
    top = heading(
        figure, "Distribution of the residual", keys + [patch("± noise floor (RMS)", **NOISE)] * any(noise.values())
    )
    shape = (len(names), 1) if width_of(figure) == COLUMN else (1, len(names))
    for place, (axes, name) in enumerate(zip(panels(figure, *shape, Frame(top + 4)).ravel(), names, strict=True)):
        axis_traces = [trace for trace in traces if trace.axis == name]
        for use, colour in uses:
            _draw_density(axes, [trace.residual[trace.scored] for trace in axis_traces if trace.use == use], colour)
        axes.axvspan(-(noise.get(name) or 0), noise.get(name) or 0, linewidth=0, **NOISE)
        label(axes.xaxis, "residual", axis_traces[0].unit, axes.get_xlim())
        axes.set_ylabel("share of samples [%]")
        name_panel(axes, f"axis {name}", place=place if len(names) > 1 else None)


def branches(drive: Array) -> NDArray[np.int8]:
    """+1 where the drive rises, -1 where it falls; reversals below 0.5 % of its span are ignored (play operator)."""
    width, play, sign = 0.005 * float(np.ptp(drive)), float(drive[0]), 1
    signs = np.empty(drive.size, dtype=np.int8)
    for first in range(0, drive.size, AT_ONCE):
        for place, value in enumerate(drive[first : first + AT_ONCE].tolist(), first):
            output = min(max(play, value - width), value + width)
            sign = sign if output == play else 1 if output > play else -1
            play, signs[place] = output, sign
    return signs


def quantile_band(drive: Array, residual: Array, bins: int = 40) -> tuple[Array, Array, Array, Array]:
    """Centre of each drive bin with at least five samples, and the 5 %, 50 % and 95 % quantiles of its residual."""
    if drive.size == 0:
        return np.empty(0), np.empty(0), np.empty(0), np.empty(0)
    edges = np.linspace(drive.min(), drive.max(), bins + 1)
    indices = np.clip(np.digitize(drive, edges) - 1, 0, bins - 1)
    full = np.flatnonzero(np.bincount(indices, minlength=bins) > 4)
    low, median, high = (
        np.array([np.quantile(residual[indices == k], (0.05, 0.5, 0.95)) for k in full]).reshape(-1, 3).T
    )
    return 0.5 * (edges[full] + edges[full + 1]), low, median, high


def cell_means(trace: Trace, across: int = 96, up: int = 64) -> tuple[Array, tuple[float, float, float, float]]:
    """Mean residual of the scored samples in each cell (up, across) of the drive-response plane, and the extent."""
    drive, response, residual = (values[trace.scored] for values in (trace.drive, trace.response, trace.residual))
    counts, xs, ys = np.histogram2d(drive, response, bins=(across, up))
    sums, _, _ = np.histogram2d(drive, response, bins=(xs, ys), weights=residual)
    with np.errstate(invalid="ignore"):
        return (sums / counts).T, (float(xs[0]), float(xs[-1]), float(ys[0]), float(ys[-1]))


def _draw_density(axes: Axes, residuals: list[Array], colour: str) -> None:
    values = np.concatenate([*residuals, np.empty(0)])
    if finite := np.isfinite(values).sum():
        counts, edges = np.histogram(values[np.isfinite(values)], bins=60)
        axes.stairs(100 * counts / finite, edges, color=colour, linewidth=0.9)
