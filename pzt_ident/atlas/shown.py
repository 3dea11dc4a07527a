"""A word of the registry at work: the standard stage with it and without it, at values from its declaration alone."""

from __future__ import annotations

from functools import cache, cached_property
from typing import NamedTuple

import numpy as np

from pzt_ident.atlas.fitted import fitted
from pzt_ident.atlas.stage import MECHANICS, OPERATOR, SENSOR, SPAN, STROKE, VALUES, Array, Drive, Stage, drives, record
from pzt_ident.engine.additions import Additions
from pzt_ident.engine.program import Program
from pzt_ident.model.block import Addition, Place, Term
from pzt_ident.model.parameter import Parameter
from pzt_ident.model.registry import blocks, word_of

LARGEST = 0.3  # of the range of a parameter
VISIBLE = 0.12  # of the span of the response: the largest change of a loop or a hold
SEEN_IN = ("loops", "fast", "holds", "other", "rest")


class Value(NamedTuple):
    """A parameter, or an amount of a record, in the user's units."""

    name: str
    value: float
    unit: str


class Shown:
    """An item of the registry in the standard chain: `respond` with it, `bare` without it.

    An effect, or what leads to a record, is shown at a share of its ranges: the largest, up to LARGEST, at which it
    changes no loop and no hold by more than VISIBLE. Operators and mechanics are fitted; without them a straight line
    is left, or a rigid stage.
    """

    def __init__(self, item: str) -> None:
        self.item, self.block = item, blocks[item]
        self.effect = blocks.is_effect(word_of(item)) or self.block.lead > 0
        words, self.fixed = fitted(self._host() if self.effect else item)
        words += (SENSOR,) if self.block.ahead_of == Place.SENSOR else ()
        self.stage = self._stage([*words, *([item] if self.effect else [])])
        self.rest = [word for word in words if word != item]
        self.share = self._share() if self.effect else 0.0

    def _host(self) -> str:
        """The block in whose equation an effect acts, of the standard stage where that holds it, and in this form."""
        if not issubclass(self.block, Term):
            return OPERATOR
        holders = [w for w in (OPERATOR, MECHANICS, *blocks.words()) if blocks[w].holds(self.block)]
        return min(holders, key=lambda word: not blocks[word].distinguishes(self.block))

    def _stage(self, items: list[str]) -> Stage:
        return Stage([blocks[item] for item in items], VALUES | self.fixed)

    def _share(self) -> float:
        """The largest at which the change is as small as it should be: by factors of two, and closer where that leaves
        next to nothing."""
        share, least = LARGEST, 1e-3
        while share > least and not self._largest(share) < VISIBLE:
            share /= 2
        above = 2 * share
        while share < LARGEST and self._largest(share) < VISIBLE / 8 and above > 1.01 * share:
            middle = (share * above) ** 0.5
            share, above = (middle, above) if self._largest(middle) < VISIBLE else (share, middle)
        return share

    def _largest(self, share: float) -> float:
        """The largest change of the response over the stroke in any loop or hold."""
        return max(self._change(drives()[name], share) for name in SEEN_IN)

    def _change(self, drive: Drive, share: float) -> float:
        """The largest change of the response over the stroke, NaN where the item at that share cannot be simulated."""
        return float(np.abs(self._respond(drive, share) - self.bare(drive)).max() / STROKE)

    @cached_property
    def values(self) -> list[Value]:
        """All that the item declares, as it is shown."""
        problem, chain = self.stage.problem, self.stage.chain
        theta = self._theta(self.share) / problem.factors
        rows = zip(chain.entries, theta, problem.all_units, strict=True)
        mine = [Value(e.name, float(v), u) for e, v, u in rows if self._declares(e.parameter, e.block)]
        units = {"drive": ("V", 1.0), "response": ("um", 1e6)}
        amounts = [(p, amount, *units[p.unit]) for p, amount in self._amounts(self.share)]
        return mine + [Value(f"{self.block.name}.{p.name}", scale * amount, unit) for p, amount, unit, scale in amounts]

    def _declares(self, parameter: Parameter, block: type) -> bool:
        items = {self.block.name, self.block.item()}
        return bool(items & {*parameter.effects}) if parameter.effects else block is self.block

    def _theta(self, share: float) -> Array:
        problem = self.stage.problem
        entries = (self.stage.chain.entries[column] for column in problem.free)
        ranges = zip(entries, problem.lower, problem.upper, strict=True)
        values = [_value(entry.parameter, float(low), float(high), share) for entry, low, high in ranges]
        return problem.parameters_at(np.array(values))

    def _amounts(self, share: float) -> list[tuple[Parameter, float]]:
        """The parameters of which each record has its own, V or m."""
        spans = {"drive": SPAN, "response": STROKE}
        declared = [p for p in self.block.parameters().values() if p.per_record and self._declares(p, self.block)]
        return [(parameter, share * parameter.bounds[1] * spans[parameter.unit]) for parameter in declared]

    def respond(self, drive: Drive) -> Array:
        """The response with the item, m: (samples,)."""
        return self._respond(drive, self.share)

    def _respond(self, drive: Drive, share: float) -> Array:
        theta, own = self._theta(share), {parameter.name: amount for parameter, amount in self._amounts(share)}
        added = issubclass(self.block, Addition)
        ahead = [own.get(entry.word, 0.0) for entry in self.stage.chain.amounts]
        with np.errstate(all="ignore"):
            response = self.stage.respond(drive, theta if added else np.append(theta, ahead))
        if added:
            signals = Additions(Program(self.stage.chain, record(drive))).basis(0, theta)[:, 1:]
            response = response + signals @ [*own.values()]
        return response

    def bare(self, drive: Drive) -> Array:
        """The response without the item, m: (samples,). Without an operator, the straight line nearest to it."""
        if self.effect or (self.block.place == Place.MECHANICS and self.rest):
            stage = self._stage(self.rest)
            return stage.respond(drive, stage.problem.theta)
        with_it, line = self.respond(drive), np.column_stack([drive.u, np.ones(drive.u.size)])
        if self.rest and np.ptp(drive.u):
            stage = self._stage(self.rest)
            line[:, 0] = stage.respond(drive, stage.problem.theta)
        return line @ np.linalg.lstsq(line, with_it, rcond=None)[0]


def _value(parameter: Parameter, low: float, high: float, share: float) -> float:
    """At a share of the way from the null to the upper bound; the middle of the range where there is no null."""
    if parameter.scale == "log":
        return float(np.sqrt(low * high))
    if parameter.null is None or not parameter.null <= high:
        return (low + high) / 2
    return parameter.null + share * (high - parameter.null)


@cache
def shown(item: str) -> Shown:
    """Each is made once."""
    return Shown(item)
