"""Blocks in signal order, and their parameters on each axis."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from copy import copy
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from numpy.typing import NDArray

from pzt_ident.model.block import OTHER, Addition, Block, Coupling, Modes, Place, Term, argument_names
from pzt_ident.model.parameter import Parameter

Array = NDArray[np.float64]


@cache
def in_one(forms: tuple[type[Block], ...]) -> type[Block]:
    """A block in several forms at once; of a function that two of them define, that of the first is taken."""
    forms = tuple(dict.fromkeys(forms))
    name = "".join(form.__name__ for form in forms)
    return type(name, forms, {"__module__": forms[0].__module__}) if len(forms) > 1 else forms[0]


@dataclass(frozen=True)
class Entry:
    """One parameter of one block on one axis (or of one ordered pair of axes: `other` acts on `axis`)."""

    name: str
    block: type[Block]
    word: str
    axis: int
    other: int
    parameter: Parameter


class Chain:
    """A chain of blocks over all axes of a stage.

    theta is (candidates, parameters) in SI units, in the order of `entries`; a simulation is (candidates, measured
    axes, samples). An axis without a response is simulated as far as the last coupling, with the parameters of the
    first measured axis except those in `given`, such as `y.lumped.mass`. Parameter names contain the axis if more
    than one is measured. A parameter of an effect exists only if the effect is among the blocks. A parameter in
    `shared`, such as `bouc_wen.alpha`, has one value for all axes. `amounts` are the parameters of which each record
    has its own: numbers of the columns behind those of the entries, of measured axes only.
    """

    def __init__(
        self,
        blocks: Sequence[type[Block]],
        axes: Sequence[str],
        measured: Sequence[int],
        shared: Sequence[str] = (),
        given: Collection[str] = (),
    ) -> None:
        chain = [block for block in blocks if not issubclass(block, Term | Addition)]
        self.blocks = tuple(sorted(chain, key=lambda block: (block.place, issubclass(block, Coupling))))
        self.additions = tuple(block for block in blocks if issubclass(block, Addition))
        self.listed_terms = tuple(block for block in blocks if issubclass(block, Term))
        acting = [block for block in blocks if issubclass(block, Term) or block.lead]
        self._listed = {item for block in acting for item in (block.name, block.item())}
        self.axes, self.measured, self.shared = tuple(axes), tuple(measured), frozenset(shared)
        entries = [entry for block in self.blocks for entry in self._entries(block, given)]
        added = [entry for block in self.additions for entry in self._entries(block, given)]
        self.entries = tuple(entry for entry in entries + added if not entry.parameter.per_record)
        self.amounts = tuple(entry for entry in entries if entry.parameter.per_record and entry.axis in self.measured)

    def terms(self, block: type[Block]) -> set[str]:
        """The listed effects that act inside a block's equation."""
        names = {item for term in self.listed_terms for item in (term.name, term.item())}
        return names & {item for parameter in block.parameters().values() for item in parameter.effects}

    def form_of(self, block: type[Block]) -> type[Block]:
        """The block, with the listed effects in its equation."""
        forms = [form for effect, form in block.forms.items() if effect in self._listed]
        joint = [next((form.joint[item] for item in form.joint if item in self._listed), form) for form in forms]
        return in_one(tuple(joint) or (block,))

    @property
    def has_readout(self) -> bool:
        """Whether the prompt response of the operator has another input than its memory."""
        return {Place.READOUT, Place.OPERATOR} <= {block.place for block in self.blocks}

    @property
    def from_rest(self) -> bool:
        """Whether a block or an effect in its equation needs the response counted from that at rest."""
        return any(block.about_rest for block in (*self.blocks, *self.listed_terms))

    def _entries(self, block: type[Block], given: Collection[str]) -> list[Entry]:
        entries = []
        for axis in range(len(self.axes)):
            measured = axis in self.measured
            prefix = f"{self.axes[axis]}." if not measured or len(self.measured) > 1 else ""
            others = [b for b in range(len(self.axes)) if b != axis] if issubclass(block, Coupling) else [axis]
            for other in others:
                suffix = f"_from_{self.axes[other]}" if len(others) > 1 else ""
                for word, parameter in block.parameters().items():
                    plain, per = f"{block.name}.{word}", self._per(block, word, parameter)
                    if parameter.effects and self._listed.isdisjoint(parameter.effects):
                        continue
                    name = plain if per == "stage" else f"{prefix}{plain}{suffix}"
                    exists = measured or (name in given and self.allowed_without_response(block, parameter))
                    if exists and (per == "axis" or (per == "stage") == (axis == self.measured[0])):
                        entries.append(Entry(name, block, word, axis, other, parameter))
        return entries

    @staticmethod
    def allowed_without_response(block: type[Block], parameter: Parameter) -> bool:
        """Whether an axis that is not measured can have a value of its own of the parameter."""
        return not issubclass(block, Coupling | Modes | Addition) and parameter.per == "axis"

    def _per(self, block: type[Block], word: str, parameter: Parameter) -> str:
        """What has a value of its own (see Parameter.per), as the block declares it or the job shares it."""
        return "stage" if f"{block.name}.{word}" in self.shared else parameter.per

    def spellings(self, entry: Entry) -> tuple[str, ...]:
        """The names of a parameter that a job may use, the most specific first."""
        plain = f"{entry.block.name}.{entry.word}"
        if self._per(entry.block, entry.word, entry.parameter) == "stage":
            return (plain,)
        paired = (f"{plain}_from_{self.axes[entry.other]}",) if entry.other != entry.axis else ()
        return *(f"{self.axes[entry.axis]}.{name}" for name in (*paired, plain)), *paired, plain

    def without_terms(self, refused: Callable[[type[Block]], bool]) -> tuple[Chain, list[int]]:
        """The chain without some of the terms in its blocks' equations, and which columns of theta it keeps."""
        chain, left = copy(self), [term for term in self.listed_terms if refused(term)]
        gone = {name for term in left for name in (term.name, term.item())}
        chain.listed_terms = tuple(term for term in self.listed_terms if term not in left)
        kept = [column for column, entry in enumerate(self.entries) if gone.isdisjoint(entry.parameter.effects)]
        chain._listed, chain.entries = self._listed - gone, tuple(self.entries[column] for column in kept)
        return chain, kept

    def margin_chain(self, block: type[Block]) -> Chain:
        """The chain up to and including a block, whose output is replaced by its margin."""
        chain, margin = copy(self), block.margin
        assert margin
        chain.blocks = (*self.blocks[: self.blocks.index(block)], margin)
        chain.entries = tuple(replace(entry, block=margin) if entry.block is block else entry for entry in self.entries)
        return chain

    def threshold_of(self, column: int, theta: Array) -> float | None:
        """The drive at which the branch of a counted parameter acts, for one candidate; None if its block has none."""
        entry = self.entries[column]
        threshold = getattr(entry.block, "threshold", None)
        if threshold is None or entry.parameter.count is None:
            return None
        columns = self.columns(entry.block, entry.axis, entry.other) or {}
        branch = np.flatnonzero(np.array(columns[entry.parameter.name]) == column)[0]
        values = {word: theta[place] for word, place in columns.items()} | entry.block.numbers() | {"branch": branch}
        return float(threshold(*(values[word] for word in argument_names(threshold))))

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(entry.name for entry in self.entries)

    @property
    def lead(self) -> int:
        """Samples ahead of a record in which a block leads the memory to where it was when the record began."""
        return max((block.lead for block in self.blocks), default=0)

    @property
    def oversample(self) -> int:
        return max((block.oversample for block in self.blocks), default=1)

    @property
    def solving(self) -> float:
        """Seconds of a step in which its blocks solve equations; see `Block.solving`."""
        return sum(block.solving for block in self.blocks)

    def columns(self, block: type[Block], axis: int, other: int) -> dict[str, int | list[int]] | None:
        """Columns of theta that hold a block's parameters; None for a pair onto an axis that is not measured."""
        if axis not in self.measured and issubclass(block, Coupling | Modes):
            return None
        columns: dict[str, int | list[int]] = {}
        by_word = self._columns_by_word(block, axis, other)
        for word, parameter in {
            entry.word: entry.parameter for entry in self._columned if entry.block is block
        }.items():
            if word in by_word and parameter.count is None:
                columns[parameter.name] = by_word[word]
            elif word in by_word:
                columns.setdefault(parameter.name, []).append(by_word[word])  # type: ignore[union-attr]
        return columns

    def columns_of_others(self, block: type[Coupling], axis: int, other: int) -> dict[str, int | list[int]]:
        """Columns of theta that hold what a coupling asks of the mechanics, and of the same pair the other way round,
        in its words."""
        host = block.mechanics_in(self.blocks)
        if host is None:
            return {}
        own, there = self.columns(host, axis, axis) or {}, self.columns(host, other, other) or {}
        there |= self.columns(block, other, axis) or {}
        return own | {f"{OTHER}{word}": column for word, column in there.items()}

    @property
    def _columned(self) -> tuple[Entry, ...]:
        """What has a column in a theta that is complete."""
        return (*self.entries, *self.amounts)

    def _columns_by_word(self, block: type[Block], axis: int, other: int) -> dict[str, int]:
        """Column of each parameter of a block. An axis that is not measured has the columns of the first measured axis,
        except for its `given` parameters."""
        measured = axis in self.measured
        columns = {} if measured else self._columns_by_word(block, self.measured[0], self.measured[0])
        columns = {word: column for word, column in columns.items() if column < len(self.entries)}
        for column, entry in enumerate(self._columned):
            stage = self._per(entry.block, entry.word, entry.parameter) == "stage"
            if entry.block is block and (stage or (entry.axis, entry.other) == (axis, other)):
                columns[entry.word] = column
        return columns
