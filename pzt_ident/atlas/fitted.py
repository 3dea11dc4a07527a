"""Operators and mechanics as they follow the standard stage best: so a plugin's is shown like any other."""

from __future__ import annotations

from functools import cache
from typing import Any, NamedTuple

from pzt_ident.atlas.stage import MECHANICS, OPERATOR, VALUES, Drive, Stage, drives, record
from pzt_ident.errors import RunError
from pzt_ident.model.block import Place
from pzt_ident.model.registry import blocks, optimizers
from pzt_ident.search.cube import FixedValue
from pzt_ident.search.loop import Stop, optimize
from pzt_ident.search.problem import Problem

Values = dict[str, float]

EVALUATIONS = 150


class Range(NamedTuple):
    """Bounds of a free parameter, as a specification of a problem."""

    bounds: tuple[float, float]
    value: None = None


@cache
def fitted(word: str) -> tuple[tuple[str, ...], Values]:
    """An operator or mechanics as it follows the standard stage best: its chain of words, and the values of its free
    parameters in the user's units. Mechanics are fitted on a sweep, operators on loops."""
    if word in (OPERATOR, MECHANICS):
        return (OPERATOR, MECHANICS), {}
    if (first := _same_parameters(word)) != word:
        chain, values = fitted(first)
        renamed = {name.replace(f"{first}.", f"{word}."): value for name, value in values.items()}
        return tuple(word if part == first else part for part in chain), renamed
    mechanics = blocks[word].place == Place.MECHANICS
    drive = drives()["sweep" if mechanics else "loops"]
    chains = ((OPERATOR, word), (word,)) if mechanics else ((word, MECHANICS),)
    fits = [fit for chain in chains if (fit := _fit(chain, drive))]
    _, chain, values = min(fits, key=lambda fit: fit[0])
    return chain, values


def _same_parameters(word: str) -> str:
    """The first word in the alphabet with the same parameters in the same place: both are shown at the same values."""
    declared = list(blocks[word].parameters())
    hosts = (block for block in blocks if not blocks.is_effect(block.name) and block.place == blocks[word].place)
    return next(block.name for block in hosts if list(block.parameters()) == declared)


def _fit(chain: tuple[str, ...], drive: Drive) -> tuple[float, tuple[str, ...], Values] | None:
    """Loss, chain and values of the best fit to the standard stage; None where every candidate of a start failed."""
    standard, stage = Stage([blocks[OPERATOR], blocks[MECHANICS]], VALUES), Stage([blocks[w] for w in chain], VALUES)
    measured = record(drive)
    measured.response[0] = standard.respond(drive, standard.problem.theta)
    free = stage.problem
    specs: dict[str, Any] = {name: FixedValue(value) for name, value in VALUES.items()}
    for name, low, high in zip(free.names, free.lower, free.upper, strict=True):
        specs[name] = Range((float(low), float(high)))
    problem = Problem(stage.chain, [measured], specs)
    search = optimizers["least_squares"].make().with_budget(EVALUATIONS)
    try:
        outcome = optimize(search, problem.dimensions, problem.loss, 1, Stop(EVALUATIONS), problem.residuals)
    except RunError:
        return None
    values = map(float, problem.physical(outcome.point)[0])
    return outcome.loss, chain, dict(zip(problem.names, values, strict=True))
