"""Effects that leave the same trace: as declared, and on which standard drives they do and do not."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from pzt_ident.atlas.stage import drives
from pzt_ident.atlas.traces import Traced, traced
from pzt_ident.model.registry import blocks

VISIBLE = 0.25  # of the largest trace of an effect


class LookAlike(NamedTuple):
    """An effect that may be taken for another one: the standard drives on which what both leave is most and least
    alike, with the cosine between the two traces."""

    word: str
    alike: str
    most: float
    apart: str
    least: float


def look_alikes(word: str) -> list[LookAlike]:
    """Those that an effect declares, and those that declare it."""
    declared = set(blocks[word].look_alikes) | {w for w in blocks.effects() if word in blocks[w].look_alikes}
    return sorted(_compared(word, other) for other in declared)


def _compared(word: str, other: str) -> LookAlike:
    a, b = traced(word), traced(other)
    seen = [name for name in a.left if name in b.left and (_visible(a, name) or _visible(b, name))]
    cosines = {name: cosine(a, b, name) for name in seen}
    alike, apart = max(seen, key=lambda name: cosines[name]), min(seen, key=lambda name: cosines[name])
    return LookAlike(other, drives()[alike].short, cosines[alike], drives()[apart].short, cosines[apart])


def _visible(found: Traced, name: str) -> bool:
    return found.size(name) > VISIBLE * found.largest


def cosine(a: Traced, b: Traced, name: str) -> float:
    """Between what both leave on a drive, without its sign; 0 where one of them leaves next to nothing."""
    if min(a.size(name) / a.largest, b.size(name) / b.largest) < VISIBLE / 10:
        return 0.0
    x, y = a.left[name], b.left[name]
    return float(abs(x @ y) / np.sqrt((x @ x) * (y @ y)))
