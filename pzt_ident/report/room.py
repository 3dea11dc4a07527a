"""Room for the texts of a figure: how wide they are, how they are shortened, and panels that leave them their place."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.backend_bases import RendererBase
    from matplotlib.figure import Figure
    from matplotlib.transforms import BboxBase

EDGE = 1.0
"""Least distance of a text from the edge of its figure, mm."""
ROUNDS = 3  # a text in the middle of a panel moves less than the edge of the panel


def make_room(figure: Figure) -> None:
    """Shrink the panels of a figure until the texts beside them end EDGE within it."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.transforms import Bbox

    renderer = FigureCanvasAgg(figure).get_renderer()  # matplotlib would make one for each text
    width, height = figure.bbox.size
    edge = EDGE / 25.4 * figure.dpi
    for _ in range(ROUNDS):
        texts = Bbox.union([box for axes in figure.axes for box in _beside(axes, renderer)])
        low = np.maximum(0, edge - texts.p0) / (width, height)
        high = np.maximum(0, [texts.x1 - (width - edge), 0]) / (width, height)
        if not (low.any() or high.any()):
            return
        places = [axes.get_position(original=True) for axes in figure.axes]
        inner = Bbox.union(places)
        scale = 1 - (low + high) / inner.size
        for axes, place in zip(figure.axes, places, strict=True):
            corners = inner.p0 + low + (place.get_points() - inner.p0) * scale
            axes.set_position(Bbox(corners))


def _beside(axes: Axes, renderer: RendererBase) -> Iterator[BboxBase]:
    """Where the texts of a panel are, in pixels, but for its title and those within it, which are out of the layout."""
    boxes = [axis.get_tightbbox(renderer) for axis in (axes.xaxis, axes.yaxis) if axes.axison]
    boxes += [text.get_window_extent(renderer) for text in axes.texts if text.get_in_layout()]
    yield from (box for box in boxes if box is not None)


def fit(text: str, width: float, size: float = 7.0, weight: str = "normal") -> str:
    """`text`, its middle replaced by an ellipsis where it does not fit into `width` mm at `size` pt."""
    if text_width(text, size, weight) <= width:
        return text
    cuts = [f"{text[: letters - letters // 3]}…{text[len(text) - letters // 3 :]}" for letters in range(len(text))]
    return cuts[max(0, bisect_right(cuts, width, key=lambda cut: text_width(cut, size, weight)) - 1)]


def text_width(text: str, size: float, weight: str = "normal") -> float:
    """Of a line at `size` pt, mm."""
    from matplotlib.font_manager import FontProperties
    from matplotlib.textpath import text_to_path

    font = FontProperties(size=size, weight=weight)
    return text_to_path.get_text_width_height_descent(text, font, False)[0] * 25.4 / 72
