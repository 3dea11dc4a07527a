"""Blocks in signal order, and the parameters that each has on each axis."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from copy import copy
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from pzt_ident.model.block import Addition, Block, Coupling, Modes, Place, Term, asked
from pzt_ident.model.parameter import Parameter

Array = NDArray[np.float64]


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

    theta is (candidates, parameters) in SI units, in the order of `slots`; a simulation is (candidates, measured axes,
    samples). An axis without a response is simulated as far as the last coupling, with the parameters of the first
    measured axis but for those that it is `given`, such as `y.lumped.mass`. Parameter names carry the axis where more
    than one is measured. A parameter that belongs to an effect is there only where the effect is among the blocks. One
    in `shared`, such as `bouc_wen.alpha`, is the same on every axis.
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
        self.blocks = tuple(sorted(chain, key=lambda block: block.place))
        self.additions = tuple(block for block in blocks if issubclass(block, Addition))
        self._listed = {block.name for block in blocks if issubclass(block, Term)}
        self.axes, self.measured, self.shared = tuple(axes), tuple(measured), frozenset(shared)
        self.entries = tuple(
            entry for block in (*self.blocks, *self.additions) for entry in self._entries(block, given)
        )

    def terms(self, block: type[Block]) -> set[str]:
        """The effects that act inside a block's equation."""
        return self._listed & {parameter.effect for parameter in block.parameters().values() if parameter.effect}

    def form(self, block: type[Block]) -> type[Block]:
        """The block, with the listed effects in its equation."""
        return next((form for effect, form in block.forms.items() if effect in self._listed), block)

    @property
    def reads_out(self) -> bool:
        """Whether the prompt response of an operator is driven by another signal than its memory."""
        return {Place.READOUT, Place.OPERATOR} <= {block.place for block in self.blocks}

    def _entries(self, block: type[Block], given: Collection[str]) -> list[Entry]:
        found = []
        for axis in range(len(self.axes)):
            measured = axis in self.measured
            prefix = f"{self.axes[axis]}." if not measured or len(self.measured) > 1 else ""
            others = [b for b in range(len(self.axes)) if b != axis] if issubclass(block, Coupling) else [axis]
            for other in others:
                suffix = f"_from_{self.axes[other]}" if len(others) > 1 else ""
                for word, parameter in block.parameters().items():
                    plain, each = f"{block.name}.{word}", self._each(block, word, parameter)
                    if parameter.per_record or (parameter.effect and parameter.effect not in self._listed):
                        continue
                    name = plain if each == "stage" else f"{prefix}{plain}{suffix}"
                    own = measured or (name in given and self.alone(block, parameter))
                    if own and (each == "axis" or (each == "stage") == (axis == self.measured[0])):
                        found.append(Entry(name, block, word, axis, other, parameter))
        return found

    @staticmethod
    def alone(block: type[Block], parameter: Parameter) -> bool:
        """Whether an axis can have the parameter without a response of its own."""
        return not issubclass(block, Coupling | Modes | Addition) and parameter.each == "axis"

    def _each(self, block: type[Block], word: str, parameter: Parameter) -> str:
        """Who has one of its own, as the block declares it or the job shares it."""
        return "stage" if f"{block.name}.{word}" in self.shared else parameter.each

    def spellings(self, entry: Entry) -> tuple[str, ...]:
        """The names that a job may call a parameter by, the most particular first."""
        plain = f"{entry.block.name}.{entry.word}"
        if self._each(entry.block, entry.word, entry.parameter) == "stage":
            return (plain,)
        paired = (f"{plain}_from_{self.axes[entry.other]}",) if entry.other != entry.axis else ()
        return *(f"{self.axes[entry.axis]}.{name}" for name in (*paired, plain)), *paired, plain

    def watched(self, block: type[Block]) -> Chain:
        """The chain as far as a block, of which it gives what its equation wants above zero."""
        made, watch = copy(self), block.watch
        assert watch
        made.blocks = (*self.blocks[: self.blocks.index(block)], watch)
        made.entries = tuple(replace(entry, block=watch) if entry.block is block else entry for entry in self.entries)
        return made

    def stands(self, column: int, theta: Array) -> float | None:
        """The drive that a counted parameter of one candidate stands for, None where its block says nothing of that."""
        entry = self.entries[column]
        stands = getattr(entry.block, "stands", None)
        if stands is None or entry.parameter.count is None:
            return None
        columns = self.columns(entry.block, entry.axis, entry.other) or {}
        known = {word: theta[at] for word, at in columns.items()} | entry.block.numbers()
        branch = np.flatnonzero(np.array(columns[entry.parameter.name]) == column)[0]
        return float(stands(*((known | {"branch": branch})[word] for word in asked(stands))))

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(entry.name for entry in self.entries)

    @property
    def oversample(self) -> int:
        return max((block.oversample for block in self.blocks), default=1)

    def columns(self, block: type[Block], axis: int, other: int) -> dict[str, int | list[int]] | None:
        """Columns of theta that hold a block's parameters; None for a pair onto an axis that is not measured."""
        if axis not in self.measured and issubclass(block, Coupling | Modes):
            return None
        found: dict[str, int | list[int]] = {}
        own = self._own(block, axis, other)
        for word, parameter in {entry.word: entry.parameter for entry in self.entries if entry.block is block}.items():
            if word in own and parameter.count is None:
                found[parameter.name] = own[word]
            elif word in own:
                found.setdefault(parameter.name, []).append(own[word])  # type: ignore[union-attr]
        return found

    def _own(self, block: type[Block], axis: int, other: int) -> dict[str, int]:
        """Column of each parameter of a block; an axis that is not measured has those of the first that is, but for
        what it is given."""
        measured = axis in self.measured
        found = {} if measured else self._own(block, self.measured[0], self.measured[0])
        for column, entry in enumerate(self.entries):
            stage = self._each(entry.block, entry.word, entry.parameter) == "stage"
            if entry.block is block and (stage or (entry.axis, entry.other) == (axis, other)):
                found[entry.word] = column
        return found
