"""The texts of a figure that its edge cuts."""

from __future__ import annotations

from unittest.mock import patch

from matplotlib.figure import Figure
from matplotlib.text import Text

from pzt_ident.report.style import style


def cut_texts(figure: Figure) -> list[str]:
    shown: list[Text] = []
    draw = Text.draw
    with style(), patch.object(Text, "draw", lambda text, renderer: shown.append(text) or draw(text, renderer)):
        figure.draw_without_rendering()
    assert shown
    boxes = ((text, Text.get_window_extent(text)) for text in shown if text.get_text())
    return [text.get_text() for text, box in boxes if not _within(box, figure.bbox)]


def _within(box, edge) -> bool:
    return bool((box.min >= edge.min).all() and (box.max <= edge.max).all())
