"""The staircase: how the error falls with each effect that is added, down to the noise."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from pzt_ident.files import replaced, write_text
from pzt_ident.report.inline import inline
from pzt_ident.report.page import template
from pzt_ident.report.style import (
    COLUMN,
    INK,
    MARKERS,
    NOISE,
    PAGE,
    PALETTE,
    Frame,
    heading,
    key,
    panels,
    patch,
    saved,
    style,
)
from pzt_ident.report.words import step_name

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Facts = dict[str, Any]


def write_staircase(folder: Path, improvement: Facts, diagnosis: Facts) -> Path:
    """Write `report.html` and `figures/staircase-*` of an improvement into its folder; the path of the page."""
    from matplotlib.figure import Figure

    (folder / "figures").mkdir(exist_ok=True)
    drawn = b""
    with style():
        for width in (COLUMN, PAGE):
            figure = Figure(figsize=(width / 25.4, 62 / 25.4))
            draw_staircase(figure, improvement)
            for form in ("pdf", "svg"):
                drawn = saved(figure, form)
                with replaced(folder / "figures" / f"staircase-{width}.{form}") as path:
                    path.write_bytes(drawn)
    page = template("staircase.html").render(
        found=improvement, diagnosis=diagnosis, figure=inline(drawn, "staircase"), step_name=step_name
    )
    write_text(folder / "report.html", page)
    return folder / "report.html"


def draw_staircase(figure: Figure, improvement: Facts) -> None:
    """RMSE after each step on the records of both uses, and the noise floor."""
    steps, floor, unit = improvement["steps"], improvement["floor"], improvement["unit"]
    places = range(len(steps))
    handles = [patch("noise floor", **NOISE)]
    uses = [use for use in ("identify", "validate") if steps[0]["rmse"][use] is not None]
    looks = [{"color": PALETTE[i], "marker": MARKERS[i], "markersize": 3} for i in range(len(uses))]
    handles += [key(use, **look) for use, look in zip(uses, looks, strict=True)]
    top = heading(figure, f"{improvement['name']}: how the error falls", handles)
    (axes,) = panels(figure, 1, 1, Frame(top=top + 3, bottom=14)).flat
    axes.axhspan(0, floor, **NOISE)
    for use, look in zip(uses, looks, strict=True):
        values = [step["rmse"][use] for step in steps]
        axes.plot(
            places, values, drawstyle="steps-mid" if len(steps) > 1 else "default", color=look["color"], alpha=0.35
        )
        axes.plot(places, values, linestyle="", **look)
        for x, value in zip(places, values, strict=True):
            if use == uses[-1]:
                axes.annotate(f"{value:.3g}", (x, value), (3, 3), textcoords="offset points", color=INK, size=5.5)
    axes.set_xticks(list(places), [step_name(step) for step in steps], rotation=12 if len(steps) > 3 else 0)
    axes.set_xlim(-0.4, len(steps) - 0.4)
    axes.set_ylim(0, None)
    axes.set_ylabel(f"RMSE [{unit}]")
