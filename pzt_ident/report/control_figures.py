"""Figures of references that a stage is to follow."""

from __future__ import annotations

from functools import partial
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from pzt_ident.report.decimation import decimate
from pzt_ident.report.figures import Plate, render
from pzt_ident.report.style import (
    DASHES,
    INK,
    PAGE,
    PALETTE,
    QUIET,
    Frame,
    heading,
    key,
    label,
    log_ticks,
    name_panel,
    panels,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

BINS = 600
ROW = 46.0  # mm, of an axis
FAINT = 1e-4  # of the largest line of a spectrum, below which nothing is shown


def tracking_plate(comparison: Any) -> Plate:
    rows = len(comparison.units)
    return Plate("tracking", None, "", lambda width: 12 + ROW * rows, partial(draw_tracking, comparison=comparison))


def tracking_files(comparison: Any) -> dict[str, bytes]:
    """tracking.svg and tracking.pdf, across a page."""
    return {f"tracking.{form}": content for form, content in render(tracking_plate(comparison), PAGE, FORMS).items()}


FORMS = ("svg", "pdf")


def draw_tracking(figure: Figure, comparison: Any) -> None:
    """A row an axis: displacement and reference, the errors, and their spectra."""
    looks = {
        name: {"color": color, "linestyle": dash, "linewidth": 0.8}
        for name, color, dash in zip(comparison.ways, PALETTE, DASHES, strict=False)
    }
    handles = [key("reference", color=INK, linewidth=1.6, alpha=0.35)]
    handles += [key(name, **look) for name, look in looks.items()]
    top = heading(figure, "A reference followed on the virtual stage", handles)
    grid = panels(figure, len(comparison.units), 3, Frame(top=top + 5))
    for row, (axis, unit) in zip(grid, comparison.units.items(), strict=True):
        _displacement(row[0], comparison, axis, unit, looks)
        _errors(row[1], comparison, axis, unit, looks)
        _spectra(row[2], comparison, axis, unit, looks)


def _displacement(axes: Axes, comparison: Any, axis: str, unit: str, looks: dict[str, Any]) -> None:
    reference = comparison.reference[axis]
    _curve(axes, comparison.t, reference, color=INK, linewidth=1.6, alpha=0.35)
    for name, way in comparison.ways.items():
        _curve(axes, comparison.t, way.displacement[axis], **looks[name])
    name_panel(axes, f"{axis}: displacement")
    label(axes.xaxis, "time", "s", comparison.t)
    label(axes.yaxis, axis, unit, reference)


def _errors(axes: Axes, comparison: Any, axis: str, unit: str, looks: dict[str, Any]) -> None:
    """Of all ways but the open loop, whose error is named."""
    first, *others = comparison.ways
    for name in others:
        _curve(axes, comparison.t, comparison.ways[name].error[axis], **looks[name])
    axes.axhline(0, color=QUIET, linewidth=0.4)
    shown = np.concatenate([comparison.ways[name].error[axis] for name in others])
    name_panel(axes, f"{axis}: error", f"without {first}")
    label(axes.xaxis, "time", "s", comparison.t)
    label(axes.yaxis, "displacement − reference", unit, shown)


def _spectra(axes: Axes, comparison: Any, axis: str, unit: str, looks: dict[str, Any]) -> None:
    frequency = comparison.frequency[1:]
    largest = max(float(way.spectrum[axis][1:].max(initial=0)) for way in comparison.ways.values()) or 1.0
    for name, way in comparison.ways.items():
        lines = way.spectrum[axis][1:]
        shown = _peaks(frequency, lines)
        axes.loglog(frequency[shown], np.maximum(lines[shown], 1e-3 * FAINT * largest), **looks[name])
    axes.set_ylim(FAINT * largest, 2 * largest)
    name_panel(axes, f"{axis}: spectrum of the error")
    log_ticks(axes.xaxis, "frequency", "Hz", (frequency[0], frequency[-1]))
    log_ticks(axes.yaxis, "root mean square", unit, (FAINT * largest, largest))


def _peaks(frequency: Any, lines: Any) -> Any:
    """Places of the highest line in each of many intervals on a logarithmic scale."""
    edges = np.unique(np.searchsorted(frequency, np.geomspace(frequency[0], frequency[-1], 240)))
    return np.unique([a + int(np.argmax(lines[a:b])) for a, b in pairwise(edges)])


def _curve(axes: Axes, time: Any, values: Any, **look: Any) -> None:
    shown = decimate(values, BINS)
    axes.plot(time[shown], values[shown], **look)


def drive_plate(drive: Any) -> Plate:
    rows = len(drive.units)
    return Plate("drive", None, "", lambda width: 12 + ROW * rows, partial(draw_drive, drive=drive))


def draw_drive(figure: Figure, drive: Any) -> None:
    """A row an axis: reference, drive and the error that the model predicts."""
    top = heading(figure, "The drive for a reference, and the error that the model predicts")
    grid = panels(figure, len(drive.units), 3, Frame(top=top + 5))
    for row, (axis, unit) in zip(grid, drive.units.items(), strict=True):
        signals = {
            "reference": (drive.reference[axis], unit, axis),
            "drive": (drive.drive[axis], drive.drive_units[axis], f"u_{axis}"),
            "predicted error": (drive.error[axis], unit, "displacement − reference"),
        }
        for axes, (name, (values, of, written)) in zip(row, signals.items(), strict=True):
            _curve(axes, drive.t, values, color=PALETTE[0])
            name_panel(axes, f"{axis}: {name}")
            label(axes.xaxis, "time", "s", drive.t)
            label(axes.yaxis, written, of, values)
