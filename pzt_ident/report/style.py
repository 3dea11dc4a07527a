"""One look for every figure: paper sizes, type, colours, and how many points a line is worth."""

from __future__ import annotations

import io
import itertools
import math
import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.notation import power_of_ten, short, unit

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure

COLUMN, PAGE = 88, 180
"""Widths of a figure in a paper's column and across its page, mm."""

INK, QUIET, SHADE = "#1a1a1a", "#8a8a8a", "#e4e4e4"
MEASURED: dict[str, Any] = {"color": "#7aa6c8", "linewidth": 1.8, "solid_capstyle": "butt"}
MODEL: dict[str, Any] = {"color": "#b3400f", "linewidth": 0.7}
NOISE: dict[str, Any] = {"color": "#009e73", "alpha": 0.25}
PALETTE = ("#0072b2", "#d55e00", "#009e73", "#aa4499", "#ddaa33", "#56b4e9", "#222222")
"""Okabe and Ito's colours, the yellow darkened: told apart by the colour-blind and, with DASHES, in grey."""
DASHES = ("-", (0, (5, 1.5)), (0, (1.5, 1)), (0, (6, 1.2, 1.2, 1.2)), (0, (3, 1)), (0, (8, 2)), "-")
MARKERS = ("o", "s", "^", "D", "v", "P", "X")

_STYLE: Any = {
    "font.family": ["sans-serif", "DejaVu Sans"],
    "font.sans-serif": ["Arial", "Helvetica", "Liberation Sans", "DejaVu Sans"],
    "font.size": 6.5,
    "text.parse_math": False,
    "axes.titlesize": 6.5,
    "axes.titlelocation": "left",
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


@contextmanager
def style() -> Iterator[None]:
    """The look, for what is drawn and saved inside."""
    import warnings

    import matplotlib

    with matplotlib.rc_context(_STYLE), warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Glyph .* missing from")
        yield


@dataclass(frozen=True)
class Frame:
    """What a figure leaves around its panels, and between them, in mm."""

    top: float
    left: float = 13.0
    right: float = 2.5
    bottom: float = 9.0
    across: float = 13.0
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
    """Write what the figure shows at its top left and the legend below it; return the height taken, in mm."""
    width, height = width_of(figure), height_of(figure)
    figure.text(2 / width, 1 - 1.5 / height, fit(text, width - 4), va="top", weight="bold", size=7)
    if not handles:
        return 6.0
    columns = _legend_columns([handle.get_label() for handle in handles], width - 4)
    corner = (2 / width, 1 - 5.5 / height)
    figure.legend(handles=list(handles), loc="upper left", bbox_to_anchor=corner, ncols=columns)
    return 6.5 + 3.2 * -(-len(handles) // columns)


def _legend_columns(labels: list[str], width: float) -> int:
    """As many as fit; a legend fills column after column, the first ones fuller."""
    for columns in range(len(labels), 1, -1):
        stacks = np.array_split([len(label) for label in labels], columns)
        if sum(8.5 + 1.15 * max(stack) for stack in stacks) <= width:
            return columns
    return 1


def key(label: str, **look: Any) -> Any:
    """A line of the legend."""
    from matplotlib.lines import Line2D

    return Line2D([], [], label=label, **look)


def patch(label: str, **look: Any) -> Any:
    """A patch of the legend."""
    from matplotlib.patches import Patch

    return Patch(label=label, linewidth=0, **look)


def fit(text: str, width: float, size: float = 7.0) -> str:
    """`text`, its middle left out where it would not fit into `width` mm."""
    most = int(width / (0.185 * size))
    if len(text) <= most:
        return text
    return f"{text[: most - most // 3 - 1]}…{text[-(most // 3) :]}"


def label(axis: Axis, name: str, of: str, values: Sequence[float] | NDArray[np.float64]) -> None:
    """Name and unit of an axis that shows `values`; a power of ten goes to the unit, `residual [10⁻⁶ m]`, where the
    numbers would be long."""
    from matplotlib.ticker import FuncFormatter

    largest = float(np.nanmax(np.abs(values), initial=0.0))
    power = 3 * math.floor(math.log10(largest) / 3) if 0 < largest < 1e-3 or 1e5 <= largest < math.inf else 0
    if power:
        axis.set_major_formatter(FuncFormatter(lambda value, _: short(value / 10.0**power, 6)))
    words = [power_of_ten(power)] * bool(power) + [unit(of)] * bool(unit(of)) or [of]
    axis.set_label_text(f"{name} [{' '.join(words)}]".removesuffix(" []"))


def log_ticks(axis: Axis, name: str, of: str, span: Sequence[float]) -> None:
    """`label` of a logarithmic axis from the lower to the upper value of `span`, with plain numbers at its ticks."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0) if span[1] / span[0] < 300 else (1.0,), numticks=8))
    axis.set_major_formatter(FuncFormatter(lambda value, _: short(value)))
    axis.set_minor_formatter(NullFormatter())
    label(axis, name, of, span)


def decimate(values: NDArray[np.float64], bins: int) -> NDArray[np.intp]:
    """Indices of the lowest and highest value of each of `bins` stretches, and of both ends, in order."""
    size = values.size
    if size <= 2 * bins:
        return np.arange(size)
    edges = np.linspace(0, size, bins + 1).astype(int)
    known = np.nan_to_num(values, nan=0.0, posinf=0.0, neginf=0.0)
    found = [
        start + pick(known[start:stop]) for start, stop in itertools.pairwise(edges) for pick in (np.argmin, np.argmax)
    ]
    return np.unique([0, *found, size - 1])


def along(xs: NDArray[np.float64], ys: NDArray[np.float64], points: int) -> NDArray[np.intp]:
    """Indices of points at even distances along a curve, and of the turns of x, in order."""
    if xs.size <= points:
        return np.arange(xs.size)
    steps = [np.diff(np.nan_to_num(values)) / (float(np.ptp(np.nan_to_num(values))) or 1.0) for values in (xs, ys)]
    way = np.append(0.0, np.cumsum(np.hypot(*steps)))
    return np.union1d(decimate(xs, points // 4), np.searchsorted(way, np.linspace(0.0, way[-1], points)))


def saved(figure: Figure, form: str) -> bytes:
    """The figure as a file's content, `form` being svg or pdf; the same bytes for the same figure."""
    file = io.BytesIO()
    figure.savefig(file, format=form, metadata={"Date": None} if form == "svg" else {"CreationDate": None})
    return file.getvalue() if form == "pdf" else _rounded(file.getvalue().decode()).encode()


def _rounded(svg: str) -> str:
    """Path coordinates to a hundredth of a point, which is finer than any printer."""
    number = re.compile(r"-?\d+\.\d{3,}")
    return re.sub(
        r' d="[^"]*"', lambda path: number.sub(lambda match: f"{float(match[0]):.2f}", path[0]).replace(" \n", " "), svg
    )


def name_panel(axes: Axes, name: str, remark: str = "", place: int | None = None) -> None:
    """What a panel shows, above it: behind the letter of its place among several, (a), (b), ..., and before a remark
    that is never cut."""
    width = axes.get_position().width * width_of(axes.figure) + 2  # type: ignore[arg-type]
    first = "" if place is None else f"({chr(97 + place % 26)}) "
    last = f" ({remark})" if remark else ""
    axes.set_title(first + fit(name, width - 1.2 * len(first + last), 6.5) + last)
