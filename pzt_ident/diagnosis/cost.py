"""How long the score of an effect takes."""

from __future__ import annotations

from math import prod

from pzt_ident.diagnosis.case import Case
from pzt_ident.model.block import Block, Coupling
from pzt_ident.model.registry import blocks

MANY_AMOUNTS = 10  # of the branches of an effect
MANY_TRIALS = 50  # values of the shape parameters
MOST_SIMULATIONS = 2000  # of a form beside the first


def has_many_trials(block: type[Block]) -> bool:
    """Whether there are many values of an effect's shape parameters to try."""
    return prod(block.trials.values()) > MANY_TRIALS


def simulations(case: Case, item: str) -> int:
    """How many a score takes: one for each amplitude, of an axis or of a pair of axes, and value of the shapes."""
    block, record = blocks[item], case.records[0]
    inputs = len(record.axes) - 1 if issubclass(block, Coupling) else 1
    return prod(block.trials.values()) * len(record.measured) * inputs


def is_costly(block: type[Block]) -> bool:
    """Whether a score takes long: of an effect with many trials, or with amounts of each record."""
    return bool(block.amounts()) or has_many_trials(block)


def has_many_amounts(block: type[Block]) -> bool:
    """Whether an effect has an amount of each of many branches, as a density of plays, which takes long to refit."""
    counts = (parameter.count for parameter in block.parameters().values() if parameter.count is not None)
    return sum(getattr(block, count) if isinstance(count, str) else count for count in counts) >= MANY_AMOUNTS
