"""A fit as figures of matplotlib, as the report draws them."""

from __future__ import annotations

from functools import partial
from io import BytesIO
from typing import TYPE_CHECKING, Any

from pzt_ident.api.fitted import Fitted
from pzt_ident.data.signals import Trace
from pzt_ident.data.units import factor
from pzt_ident.errors import InputError, nearest
from pzt_ident.report import signal_figures, staircase_figures
from pzt_ident.report.figures import Plate, drawn
from pzt_ident.report.style import style

if TYPE_CHECKING:
    from matplotlib.figure import Figure

BINS = 600
DPI = 120


def shown(plate: Plate, width: float) -> Figure:
    """A plate `width` mm wide, on a figure that a notebook shows."""
    from matplotlib.figure import Figure

    if isinstance(width, bool) or not isinstance(width, int | float) or not 20 <= width <= 2000:
        raise InputError(f"{width!r} is no width", where="plot", remedy="give mm from 20 to 2000, such as 88 or 180")

    class Shown(Figure):
        def _repr_png_(self) -> bytes:
            content = BytesIO()
            with style():
                self.savefig(content, format="png", dpi=DPI)
            return content.getvalue()

    return drawn(plate, width, Shown)


def traces_of(fit: Fitted) -> list[Trace]:
    """Every measured axis of every record beside the model, in the user's units."""
    return [
        Trace(
            record.name,
            record.use,
            record.axes[axis],
            record.time,
            record.drive[axis] / factor(record.drive_units[axis]),
            record.response[axis] / factor(unit),
            (record.response[axis] + residual) / factor(unit),
            residual / factor(unit),
            record.drive_units[axis],
            unit,
            record.settle * record.dt,
        )
        for record, errors in fit.statement.problem.errors(fit.point)
        for axis, unit, residual in zip(record.measured, record.units.values(), errors, strict=True)
    ]


def time_figure(fit: Fitted, record: str | None, axis: str | None, width: float) -> Figure:
    """Raises InputError for a record or axis that the fit has not."""
    traces = traces_of(fit)
    chosen = _named(traces, record or traces[0].record, axis or traces[0].axis)[0]
    noise = fit.noise_floor.get(chosen.axis)
    draw = partial(signal_figures.draw_time, trace=chosen, noise=noise, bins=BINS)
    return shown(Plate("time", None, "", signal_figures.time_height, draw), width)


def loop_figure(fit: Fitted, axis: str | None, width: float) -> Figure:
    """Raises InputError for an axis that the fit has not."""
    traces = traces_of(fit)
    chosen = _named(traces, None, axis or traces[0].axis)
    height = partial(signal_figures.records_height, records=len(chosen))
    return shown(
        Plate("loops", None, "", height, partial(signal_figures.draw_loops, traces=chosen, points=3 * BINS)), width
    )


def staircase_figure(improvement: dict[str, Any], width: float) -> Figure:
    draw = partial(staircase_figures.draw, improvement=improvement)
    return shown(Plate("staircase", None, "", staircase_figures.height, draw), width)


def _named(traces: list[Trace], record: str | None, axis: str) -> list[Trace]:
    for kind, name, known in (
        ("record", record, [trace.record for trace in traces]),
        ("axis", axis, [trace.axis for trace in traces]),
    ):
        if name is not None and name not in known:
            raise InputError(f"there is no {kind} {name!r}", where="plot", remedy=nearest(str(name), set(known)))
    return [trace for trace in traces if record in (None, trace.record) and trace.axis == axis]
