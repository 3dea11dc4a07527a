"""The staircase: the RMSE after each effect that is added, beside the noise floor."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from pzt_ident.data.over_axes import together
from pzt_ident.report.sentences import USE_NAMES
from pzt_ident.report.style import INK, MARKERS, NOISE, PALETTE, Frame, heading, key, label, panels, patch
from pzt_ident.run.events import step_name

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def height(width: float) -> float:
    return 62


def draw(figure: Figure, improvement: dict[str, Any]) -> None:
    """RMSE on the identification and validation records after each step, and the noise floor."""
    steps, floor = improvement["steps"], improvement["floor"]
    places = range(len(steps))
    handles = [patch("noise floor", **NOISE)]
    uses = [use for use in ("identify", "validate") if steps[0]["rmse"][use] is not None]
    styles = [{"color": PALETTE[i], "marker": MARKERS[i], "markersize": 3} for i in range(len(uses))]
    handles += [key(USE_NAMES[use], **style) for use, style in zip(uses, styles, strict=True)]
    top = heading(figure, f"{improvement['name']}: RMSE after each step", handles)
    (axes,) = panels(figure, 1, 1, Frame(top=top + 3, bottom=14)).flat
    axes.axhspan(0, floor, **NOISE)
    for use, style in zip(uses, styles, strict=True):
        values = [step["rmse"][use] for step in steps]
        axes.plot(
            places, values, drawstyle="steps-mid" if len(steps) > 1 else "default", color=style["color"], alpha=0.35
        )
        axes.plot(places, values, linestyle="", **style)
        for x, value in zip(places, values, strict=True):
            if use == uses[-1]:
                axes.annotate(f"{value:.3g}", (x, value), (3, 3), textcoords="offset points", color=INK, size=5.5)
    axes.set_xticks(list(places), [step_name(step) for step in steps], rotation=12 if len(steps) > 3 else 0)
    axes.set_xlim(-0.4, len(steps) - 0.4)
    axes.set_ylim(0, None)
    label(axes.yaxis, f"RMSE{together(improvement.get('units', {}))}", improvement["unit"], axes.get_ylim())
