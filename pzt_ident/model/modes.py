"""The modes that a model's mechanics have, from their parameters."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import chain
from typing import NamedTuple

import numpy as np

from pzt_ident.model.block import Modes
from pzt_ident.model.chain import Chain, Entry

Values = dict[str, float]


class Mode(NamedTuple):
    """A mode: its axis, natural frequency and damping ratio, and its number among those of its block, from `_1`, empty
    where that has one."""

    axis: int
    frequency: float
    damping: float
    number: str = ""


def modes_of(model: Chain, values: Values) -> list[Mode]:
    """Those of the mechanics; of several modes that each axis has once only."""
    modes = list[Mode]()
    for entry in model.entries:
        block = entry.name.removesuffix(entry.word)
        if entry.word == "mass" and hasattr(entry.block, "at_mode"):
            mass, damping, stiffness = (values[f"{block}{word}"] for word in ("mass", "damping", "stiffness"))
            pace = np.sqrt(stiffness / mass)
            modes.append(Mode(entry.axis, float(pace / (2 * np.pi)), float(damping / (2 * mass * pace))))
        elif issubclass(entry.block, Modes) and entry.word.startswith("frequency"):
            number = entry.word.removeprefix("frequency")
            modes.append(Mode(entry.axis, values[entry.name], values[f"{block}damping{number}"], number))
    return modes


def second_modes(model: Chain, values: Values) -> Iterator[tuple[Entry, Mode]]:
    """The second modes, each with the parameter that is its share."""
    for entry in model.entries:
        block = entry.name.removesuffix("share")
        if entry.word == "share" and f"{block}frequency" in values:
            yield entry, Mode(entry.axis, values[f"{block}frequency"], values[f"{block}damping"])


def fastest_mode(model: Chain, values: Values) -> float:
    """The highest natural frequency, Hz; 0 without modes."""
    seconds = (mode for _, mode in second_modes(model, values))
    return max((mode.frequency for mode in chain(modes_of(model, values), seconds)), default=0.0)
