"""A second mode that is the main one: the mechanics of the model rest elsewhere, where they stand in for something."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from typing import NamedTuple

import numpy as np

from pzt_ident.diagnosis.fit import Fit
from pzt_ident.model.block import Place


class Mode(NamedTuple):
    """The axis, natural frequency and damping ratio of a mode."""

    axis: int
    frequency: float
    damping: float


def mechanics_at_main_mode(fit: Fit, kept: Collection[str] = ()) -> dict[str, float]:
    """Parameters of mechanics, by name, at the second mode that has the largest share which it may have; empty where
    none has, none but one with a parameter that is kept, and where the mechanics cannot be put there."""
    values, moved = values_of(fit), dict[str, float]()
    for mode in main_modes(fit, values, kept):
        for entry in fit.problem.model.entries:
            if entry.axis == mode.axis and entry.block.place == Place.MECHANICS and hasattr(entry.block, "at_mode"):
                stiffness = stiffness_at(fit, values, entry.name.removesuffix(entry.word), mode.frequency)
                there = entry.block.at_mode(mode.frequency, mode.damping, stiffness)
                moved |= (
                    {entry.name: there[entry.word]} if entry.word in there and entry.name in fit.problem.names else {}
                )
    return moved


def stiffness_at(fit: Fit, values: dict[str, float], block: str, frequency: float) -> float:
    """The stiffness with which a mass has a natural frequency, within its bounds; that of the block where it is no free
    parameter."""
    problem, name = fit.problem, f"{block}stiffness"
    if name not in problem.names:
        return values[name]
    place = problem.names.index(name)
    wanted = values[f"{block}mass"] * (2 * np.pi * frequency) ** 2
    return float(np.clip(wanted, problem.lower[place], problem.upper[place]))


def main_modes(fit: Fit, values: dict[str, float], kept: Collection[str]) -> Iterator[Mode]:
    """The second modes whose share ended on its upper bound, but for those with a parameter that is kept."""
    places = dict(zip(fit.problem.names, fit.point.tolist(), strict=True))
    for entry in fit.problem.model.entries:
        block = entry.name.removesuffix("share")
        is_share = entry.word == "share" and f"{block}frequency" in values and entry.name not in kept
        if is_share and places.get(entry.name, 0.0) > 0.5 and entry.name in fit.on_bounds:
            yield Mode(entry.axis, values[f"{block}frequency"], values[f"{block}damping"])


def values_of(fit: Fit) -> dict[str, float]:
    """All parameters of a fit by name, SI units."""
    return dict(zip(fit.problem.model.names, fit.problem.parameters(fit.point)[0].tolist(), strict=True))
