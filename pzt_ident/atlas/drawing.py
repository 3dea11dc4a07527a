"""Line drawings as compact SVG: axes with units, curves thinned to what the eye can see."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape
from typing import NamedTuple

import numpy as np

from pzt_ident.atlas.stage import Array

WIDTH, LEFT, RIGHT, TOP = 330, 46, 14, 18
VISIBLE = 0.25  # deviation of a curve from a straight piece, in units of the drawing


class Curve(NamedTuple):
    """Class for the style, and the points."""

    style: str
    x: Array
    y: Array


class Panel(NamedTuple):
    """Curves over one pair of axes; label: quantity with unit."""

    curves: Sequence[Curve]
    label: str
    height: int
    log: bool = False


class Axis:
    """From data to the drawing, and its ticks."""

    def __init__(self, values: Iterable[Array], start: float, end: float, log: bool, margin: float = 0.0) -> None:
        finite = np.concatenate([v[np.isfinite(v) & ((v > 0) | (not log))] for v in map(np.asarray, values)])
        low, high = (float(finite.min()), float(finite.max())) if finite.size else (0.0, 1.0)
        self.log, self.start, self.end = log, start, end
        if log:
            low, high = np.log10(max(low, high * 1e-5)), np.log10(high)
        if high - low < 1e-12 * max(1.0, abs(high)):
            low, high = low - 1, high + 1
        pad = margin * (high - low)
        self.low, self.high = low - pad, high + pad

    def __call__(self, values: Array) -> Array:
        with np.errstate(divide="ignore", invalid="ignore"):
            shares = ((np.log10(values) if self.log else values) - self.low) / (self.high - self.low)
        return self.start + np.clip(shares, -0.02, 1.02) * (self.end - self.start)

    def ticks(self, most: int) -> list[float]:
        """Round values, a few within the range."""
        if self.log:
            decades = np.arange(np.ceil(self.low), np.floor(self.high) + 1)
            if decades.size >= 2:
                return [float(10.0**d) for d in decades[:: max(1, decades.size // most)]]
            fine = [m * 10.0**d for d in np.arange(np.floor(self.low), self.high + 1) for m in (1, 2, 5)]
            return [value for value in fine if self.low <= np.log10(value) <= self.high]
        rough = (self.high - self.low) / most
        size = 10.0 ** np.floor(np.log10(rough))
        step = next(size * m for m in (1, 2, 2.5, 5, 10) if size * m >= rough)
        return [float(step * k) for k in range(int(np.ceil(self.low / step)), int(np.floor(self.high / step)) + 1)]


def drawing(panels: Sequence[Panel], x_label: str, name: str, title: str, log: bool = False, width: int = WIDTH) -> str:
    """Panels above each other over one axis. name: prefix of the ids of the curves of the first panel, "" for none."""
    x_axis = Axis([c.x for panel in panels for c in panel.curves], LEFT, width - RIGHT, log)
    top, parts = TOP, []
    for number, panel in enumerate(panels):
        parts.append(_panel(panel, x_axis, top, name if not number else ""))
        top += panel.height + TOP + 6
    bottom = top - TOP - 6
    for value in _x_ticks(x_axis):
        x = _number(float(x_axis(np.array(value))))
        parts.append(f'<text x="{x}" y="{bottom + 14}" text-anchor="middle">{_tick(value)}</text>')
    parts.append(
        f'<text class="label" x="{width - RIGHT}" y="{bottom + 28}" text-anchor="end">{escape(x_label)}</text>'
    )
    size = f'viewBox="0 0 {width} {bottom + 34}"'
    return f'<svg {size} role="img" aria-label="{escape(title)}">{"".join(parts)}</svg>'


def _panel(panel: Panel, x_axis: Axis, top: int, name: str) -> str:
    bottom = top + panel.height
    y_axis = Axis([c.y for c in panel.curves], bottom, top, panel.log, 0.06)
    y_ticks = y_axis.ticks(4 if panel.height > 50 else 3)
    grid = "".join(f"M{LEFT} {y}H{_number(x_axis.end)}" for y in (_number(float(y_axis(np.array(v)))) for v in y_ticks))
    grid += "".join(f"M{x} {top}V{bottom}" for x in (_number(float(x_axis(np.array(v)))) for v in _x_ticks(x_axis)))
    parts = [f'<path class="grid" d="{grid}"/>']
    for value in y_ticks:
        y = _number(float(y_axis(np.array(value))) + 3.5)
        parts.append(f'<text x="{LEFT - 4}" y="{y}" text-anchor="end">{_tick(value)}</text>')
    for curve in panel.curves:
        identity = f' id="{name}-{curve.style}"' if name else ""
        draw = dots if curve.style == "dots" else path
        parts.append(f'<path{identity} class="{curve.style}" d="{draw(x_axis(curve.x), y_axis(curve.y))}"/>')
    label = f'<text class="label" x="{LEFT}" y="{top - 5}">{escape(panel.label)}</text>'
    return "".join(parts) + label


def _x_ticks(axis: Axis) -> list[float]:
    return axis.ticks(int(axis.end - axis.start) // 50)


def thumbnail(name: str, styles: Sequence[str], height: int) -> str:
    """The curves of the first panel of a drawing, again and small."""
    uses = "".join(f'<use href="#{name}-{style}"/>' for style in styles)
    box = f"{LEFT} {TOP} {WIDTH - LEFT - RIGHT} {height}"
    return f'<svg class="thumbnail" viewBox="{box}" aria-hidden="true">{uses}</svg>'


def path(x: Array, y: Array) -> str:
    """A line through points in units of the drawing, without points that cannot be seen."""
    kept = thinned(np.column_stack([x, y]).round(1))
    if not len(kept):
        return ""
    steps = np.round(10 * np.diff(kept, axis=0)).astype(int) / 10
    moves = "".join(f"{dx:+g}{dy:+g}" for dx, dy in steps)
    return f"M{kept[0, 0]:g} {kept[0, 1]:g}l{moves}" if moves else ""


def dots(x: Array, y: Array) -> str:
    """Points in units of the drawing, as lines of no length."""
    return "".join(f"M{a:.1f} {b:.1f}h0" for a, b in zip(x, y, strict=True))


def thinned(points: Array) -> Array:
    """Douglas & Peucker (1973): no point left out is further than VISIBLE from the line; finite points only."""
    points = points[np.isfinite(points).all(axis=1)]
    keep = np.zeros(len(points), dtype=bool)
    keep[:1] = keep[-1:] = True
    pieces = [(0, len(points) - 1)] if len(points) > 2 else []
    while pieces:
        first, last = pieces.pop()
        if last - first < 2:
            continue
        start, along = points[first], points[last] - points[first]
        between = points[first + 1 : last] - start
        length = float(np.hypot(*along))
        away = np.abs(between @ np.array([-along[1], along[0]])) / length if length > 1e-9 else np.hypot(*between.T)
        furthest = int(np.argmax(away))
        if away[furthest] > VISIBLE:
            middle = first + 1 + furthest
            keep[middle] = True
            pieces += [(first, middle), (middle, last)]
    return points[keep]


def _number(value: float) -> str:
    return f"{value:.1f}".removesuffix(".0")


def _tick(value: float) -> str:
    if value != 0 and (abs(value) >= 1e5 or abs(value) < 1e-3):
        return f"{value:.0e}".replace("e-0", "e-").replace("e+0", "e").replace("-", "−")
    return f"{value:.10g}".replace("-", "−")
