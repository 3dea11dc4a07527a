"""Effects that leave the same trace: as declared, and on which standard drives they do and do not."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np

from pzt_ident.atlas.stage import Array, drives
from pzt_ident.atlas.traces import Traced, traced
from pzt_ident.model.registry import blocks

ALIKE = 0.5  # on all drives together, from which an effect is listed that no declaration names
VISIBLE = 0.25  # of the largest trace of an effect
PARTED = 0.9  # most that two effects have in common on a drive that tells them apart


class LookAlike(NamedTuple):
    """An effect that may be taken for another one: how much what both leave has in common on all standard drives
    together, and the drives on which it is most and least alike; cosines. apart: "" where none parts them."""

    word: str
    together: float
    alike: str
    most: float
    apart: str
    least: float


def look_alikes(word: str) -> list[LookAlike]:
    """Those that an effect declares, those that declare it, and those that look like it, the closest first."""
    others = [other for other in blocks.effects() if other != word]
    declared = {other for other in others if other in blocks[word].look_alikes or word in blocks[other].look_alikes}
    compared = [_compared(word, other) for other in others]
    return sorted(
        (pair for pair in compared if pair.word in declared or pair.together >= ALIKE), key=lambda pair: -pair.together
    )


def _compared(word: str, other: str) -> LookAlike:
    together, cosines = _cosines(*sorted((word, other)))
    alike, apart = max(cosines, key=lambda name: cosines[name]), min(cosines, key=lambda name: cosines[name])
    parting = drives()[apart].short if cosines[apart] < PARTED else ""
    return LookAlike(other, together, drives()[alike].short, cosines[alike], parting, cosines[apart])


@cache
def _cosines(word: str, other: str) -> tuple[float, dict[str, float]]:
    """On all drives together, and on each one on which either is visible."""
    a, b = traced(word), traced(other)
    common = [name for name in a.left if name in b.left]
    together = cosine(
        *(np.concatenate([traces.left[name] / traces.left[name].size ** 0.5 for name in common]) for traces in (a, b))
    )
    return together, {name: _on_drive(a, b, name) for name in common if _visible(a, name) or _visible(b, name)}


def _visible(traces: Traced, name: str) -> bool:
    return traces.size(name) > VISIBLE * traces.largest


def _on_drive(a: Traced, b: Traced, name: str) -> float:
    """0 where one of them leaves next to nothing."""
    visible = min(a.size(name) / a.largest, b.size(name) / b.largest) >= VISIBLE / 10
    return cosine(a.left[name], b.left[name]) if visible else 0.0


def cosine(x: Array, y: Array) -> float:
    """Between two traces, without its sign."""
    return float(abs(x @ y) / np.sqrt((x @ x) * (y @ y)))
