"""The style of all figures: paper sizes, fonts, colours, legends and axis labels."""

from __future__ import annotations

import io
import math
import re
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.notation import power_of_ten, short, unit
from pzt_ident.report.room import fit, text_width

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure

COLUMN, PAGE = 88, 180
"""Widths of a figure in one column and across the page, mm."""

INK, QUIET, SHADE = "#1a1a1a", "#8a8a8a", "#e4e4e4"
MEASURED: dict[str, Any] = {"color": "#7aa6c8", "linewidth": 1.8, "solid_capstyle": "butt"}
MODEL: dict[str, Any] = {"color": "#b3400f", "linewidth": 0.7}
NOISE: dict[str, Any] = {"color": "#009e73", "alpha": 0.25}
PALETTE = ("#0072b2", "#d55e00", "#009e73", "#aa4499", "#ddaa33", "#56b4e9", "#222222")
"""Okabe and Ito's colours with the yellow darkened: distinguishable with colour blindness and, with DASHES, in grey."""
DASHES = ("-", (0, (5, 1.5)), (0, (1.5, 1)), (0, (6, 1.2, 1.2, 1.2)), (0, (3, 1)), (0, (8, 2)), "-")
MARKERS = ("o", "s", "^", "D", "v", "P", "X")

_STYLE: Any = {
    "font.family": ["sans-serif", "DejaVu Sans"],
    "font.sans-serif": ["Arial", "Helvetica", "Liberation Sans", "DejaVu Sans"],
    "font.size": 6.5,
    "text.parse_math": False,
    "text.hinting": "none",  # widths as in the SVG
    "axes.titlesize": 6.5,
    "axes.titlelocation": "left",
    "axes.titley": 1.0,  # no ticks are above a panel: nothing is measured to find its place
    "axes.titlepad": 3,
    "axes.labelsize": 6.5,
    "axes.labelpad": 2,
    "axes.linewidth": 0.5,
    "axes.edgecolor": INK,
    "axes.labelcolor": INK,
    "axes.titlecolor": INK,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.formatter.useoffset": False,
    "axes.formatter.limits": (-4, 5),
    "axes.xmargin": 0.01,
    "text.color": INK,
    "xtick.color": INK,
    "ytick.color": INK,
    "xtick.labelsize": 6,
    "ytick.labelsize": 6,
    "xtick.major.width": 0.5,
    "ytick.major.width": 0.5,
    "xtick.major.size": 2.5,
    "ytick.major.size": 2.5,
    "xtick.minor.size": 1.5,
    "ytick.minor.size": 1.5,
    "xtick.minor.width": 0.4,
    "ytick.minor.width": 0.4,
    "legend.frameon": False,
    "legend.fontsize": 6.5,
    "legend.handlelength": 1.8,
    "legend.borderpad": 0,
    "legend.borderaxespad": 0,
    "legend.columnspacing": 1.4,
    "lines.linewidth": 0.8,
    "path.simplify_threshold": 0.2,
    "pdf.fonttype": 42,
    "svg.fonttype": "none",
    "svg.hashsalt": "pzt-ident",
}

_HELP = "_update_set_signature_and_docstring"


@contextmanager
def style() -> Iterator[None]:
    """Matplotlib's settings for what is drawn and saved inside."""
    import warnings

    matplotlib = without_help()
    with matplotlib.rc_context(_STYLE), warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Glyph .* missing from")
        yield


def without_help() -> Any:
    """matplotlib, whose classes write their help and list their properties while they are imported, nearly half of the
    time: not where no prompt is that could ask for it."""
    import matplotlib
    from matplotlib import artist

    if "matplotlib.figure" not in sys.modules and not hasattr(sys, "ps1") and "IPython" not in sys.modules:
        nothing = classmethod(lambda cls: None)
        with _instead(artist, "kwdoc", lambda artist: ""), _instead(artist.Artist, _HELP, nothing):
            import matplotlib.figure
    return matplotlib


@contextmanager
def _instead(owner: Any, name: str, other: Any) -> Iterator[None]:
    """The attribute of a module or class is another one inside."""
    usual = vars(owner).get(name, other)
    setattr(owner, name, other)
    try:
        yield
    finally:
        setattr(owner, name, usual)


@dataclass(frozen=True)
class Frame:
    """Margins of a figure around its panels (top, left, right, bottom) and between them (across, down), mm."""

    top: float
    left: float = 13.0
    right: float = 2.5
    bottom: float = 9.0
    across: float = 16.0
    down: float = 14.0


def panels(figure: Figure, rows: int, columns: int, frame: Frame, **options: Any) -> NDArray[Any]:
    """Axes of shape (rows, columns) inside the frame; `options` as for `Figure.subplots`."""
    width, height = width_of(figure), height_of(figure)
    wide = (width - frame.left - frame.right + frame.across) / columns - frame.across
    tall = (height - frame.top - frame.bottom + frame.down) / rows - frame.down
    grid = {
        "left": frame.left / width,
        "right": 1 - frame.right / width,
        "top": 1 - frame.top / height,
        "bottom": frame.bottom / height,
        "wspace": frame.across / wide,
        "hspace": frame.down / tall,
    }
    axes = figure.subplots(rows, columns, squeeze=False, gridspec_kw=grid, **options)
    figure.align_ylabels(axes)
    return axes


def width_of(figure: Figure) -> float:
    """Width in mm."""
    return round(figure.get_figwidth() * 25.4, 3)


def height_of(figure: Figure) -> float:
    return round(figure.get_figheight() * 25.4, 3)


def heading(figure: Figure, text: str, handles: Sequence[Any] = ()) -> float:
    """Write the title at the top left and the legend below it; returns their height in mm."""
    width, height = width_of(figure), height_of(figure)
    figure.text(2 / width, 1 - 1.5 / height, fit(text, width - 4, 7, "bold"), va="top", weight="bold", size=7)
    if not handles:
        return 6.0
    columns = _legend_columns([handle.get_label() for handle in handles], width - 4)
    corner = (2 / width, 1 - 5.5 / height)
    figure.legend(handles=list(handles), loc="upper left", bbox_to_anchor=corner, ncols=columns)
    return 6.5 + 3.2 * -(-len(handles) // columns)


def _legend_columns(labels: list[str], width: float) -> int:
    """The largest number of columns that fits; a legend fills its columns one after the other."""
    for columns in range(len(labels), 1, -1):
        stacks = np.array_split([text_width(label, 6.5) for label in labels], columns)
        if sum(9.2 + max(stack) for stack in stacks) <= width:
            return columns
    return 1


def key(label: str, **style: Any) -> Any:
    """A line in the legend."""
    from matplotlib.lines import Line2D

    return Line2D([], [], label=label, **style)


def patch(label: str, **style: Any) -> Any:
    """A patch in the legend."""
    from matplotlib.patches import Patch

    return Patch(label=label, linewidth=0, **style)


def label(axis: Axis, name: str, raw_unit: str, values: Sequence[float] | NDArray[np.float64]) -> None:
    """Label an axis that shows `values` with name and unit; for very small or large values the unit carries a power of
    ten, as in `residual [10⁻⁶ m]`."""
    from matplotlib.ticker import FuncFormatter

    largest = float(np.nanmax(np.abs(values), initial=0.0))
    power = 3 * math.floor(math.log10(largest) / 3) if 0 < largest < 1e-3 or 1e5 <= largest < math.inf else 0
    if power:
        closest = float(np.nanmax(values) - np.nanmin(values)) / largest
        digits = 6 if closest > 1e-3 else 8 - math.floor(math.log10(closest or 1.0))
        axis.set_major_formatter(FuncFormatter(lambda value, _: short(value / 10.0**power, digits)))
    parts = [power_of_ten(power)] * bool(power) + [unit(raw_unit)] * bool(unit(raw_unit)) or [raw_unit]
    axis.set_label_text(f"{name} [{' '.join(parts)}]".removesuffix(" []"))


def log_ticks(axis: Axis, name: str, raw_unit: str, span: Sequence[float]) -> None:
    """As `label`, for a logarithmic axis over `span` (lower, upper), with plain numbers at its ticks."""
    from matplotlib.ticker import FuncFormatter, LogLocator

    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0) if span[1] / span[0] < 300 else (1.0,), numticks=8))
    axis.set_major_formatter(FuncFormatter(lambda value, _: short(value)))
    _minor_ticks(axis)
    label(axis, name, raw_unit, span)


def _minor_ticks(axis: Axis) -> None:
    """Draw the minor ticks of a logarithmic axis, whose limits are set, as one line with markers: matplotlib makes five
    objects of each, and measures all of them again and again."""
    from matplotlib.lines import Line2D
    from matplotlib.markers import TICKDOWN, TICKLEFT
    from matplotlib.ticker import NullLocator

    low, high = sorted(axis.get_view_interval())
    places = np.array([place for place in axis.get_minorticklocs() if low <= place <= high])
    axis.set_minor_locator(NullLocator())
    foot, axes, across = np.zeros(places.size), axis.axes, axis is axis.axes.xaxis
    ticks = Line2D(
        *((places, foot) if across else (foot, places)),
        transform=axes.get_xaxis_transform("tick1") if across else axes.get_yaxis_transform("tick1"),
        marker=TICKDOWN if across else TICKLEFT,  # type: ignore[arg-type]
        linestyle="none",
        color=INK,
        markersize=_STYLE["xtick.minor.size"],
        markeredgewidth=_STYLE["xtick.minor.width"],
        clip_on=False,
        zorder=2.01,
    )
    axes.add_artist(ticks)


def file_content(figure: Figure, form: str) -> bytes:
    """The figure as the content of a file in the format `form` (svg, pdf); the same figure gives the same bytes."""
    file = io.BytesIO()
    if form == "svg":
        figure.savefig(file, format=form, metadata={"Date": None})
        return _rounded(file.getvalue().decode()).encode()
    with _fonts_without_shaping():
        figure.savefig(file, format=form, metadata={"CreationDate": None})
    return file.getvalue()


@contextmanager
def _fonts_without_shaping() -> Iterator[None]:
    """Fonts in a PDF are embedded without the tables that shape text, which no viewer reads: to subset them is most of
    the time in which a PDF is written."""
    from fontTools.subset import Options

    usual = Options._drop_tables_default
    Options._drop_tables_default = [*usual, "GDEF", "GPOS", "GSUB", "MATH"]
    try:
        yield
    finally:
        Options._drop_tables_default = usual


def _rounded(svg: str) -> str:
    """The SVG with path coordinates rounded to 0.01 point, finer than any printer resolves."""
    number = re.compile(r"-?\d+\.\d{3,}")
    return re.sub(
        r' d="[^"]*"', lambda path: number.sub(lambda match: f"{float(match[0]):.2f}", path[0]).replace(" \n", " "), svg
    )


def name_panel(axes: Axes, name: str, remark: str = "", place: int | None = None) -> None:
    """Title of a panel: the letter of its `place` among several, (a), (b), ..., its name, shortened to fit, and a
    remark in parentheses."""
    width = axes.get_position().width * width_of(axes.figure) + 2  # type: ignore[arg-type]
    letter = "" if place is None else f"({chr(97 + place % 26)}) "
    suffix = f" ({remark})" if remark else ""
    axes.set_title(letter + fit(name, width - text_width(letter + suffix, 6.5), 6.5) + suffix)
