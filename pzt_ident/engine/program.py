"""The kernel's program for a chain of blocks on one record, and the layout of its scratch."""

from __future__ import annotations

from copy import copy
from functools import cached_property
from itertools import product
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.record import Record
from pzt_ident.engine.precomputed import Precomputation
from pzt_ident.model.block import (
    TILES,
    Bank,
    Beside,
    Block,
    Coupling,
    Modes,
    Operator,
    Place,
    Shift,
    argument_names,
)
from pzt_ident.model.chain import Chain

Array = NDArray[np.float64]


class Operation(NamedTuple):
    """One step of a program: a `block` acts on a tile, with its numbers from a row of the scratch on; or the drive of
    an axis fills its tile; or the signal is kept as the operator's prompt input, or as the force on the mechanics.
    idle: how many of its rows are not counted as work."""

    action: Literal["block", "fill", "keep_prompt", "keep_force"]
    axis: int
    tile: int
    place: Place
    block: type[Block] | None = None
    variant: Any = None
    row: int = 0
    idle: int = 0


class Program:
    """`operations` in signal order; `rows` is the number of rows of the scratch, a number for each lane in a row.
    single: for one candidate and one sample a call, as in real time (see `realtime`).

    Sources of the arguments of a block's `prepare`: `given` pairs a row of the scratch with a column of theta, `known`
    with a number that is the same for every candidate, `of_record` with an axis and one of its facts, see `facts`, and
    `precomputed` holds those that a bank computes with NumPy, with their axes and rows (branches, words).
    """

    def __init__(self, model: Chain, record: Record, single: bool = False) -> None:
        from pzt_ident.engine.lanes import Variant

        self.model, self.record, self.single = model, record, single
        self.operations: list[Operation] = []
        self.given: list[tuple[int, int]] = []
        self.known: list[tuple[int, float]] = []
        self.of_record: list[tuple[int, int, str]] = []
        self.precomputed: list[tuple[Precomputation, int, NDArray[np.int64]]] = []
        self.rows = 0
        self._fresh = set(range(len(model.axes)))  # axes whose tile does not hold a signal yet
        last = max((i for i, block in enumerate(model.blocks) if issubclass(block, Coupling | Modes)), default=-1)
        for number, block in enumerate(model.blocks):
            if single and block.amounts():
                continue  # of no record: the identity
            if issubclass(block, Coupling | Modes):
                for axis in range(len(model.axes)):
                    self._keep(number, axis)
                self._fill(set(self._fresh), block.place)
                self._add(block, 0, Variant(axes=len(model.axes), single=single))
                continue
            for axis in range(len(model.axes)):
                if axis in model.measured or number < last:
                    self._keep(number, axis)
                    self._append(block, axis)
        self._fill(self._fresh & set(model.measured), Place.SENSOR)
        self.chain_rows = self.rows
        self.additions = {axis: self._additions(axis) for axis in model.measured} if not single else {}
        if not single:
            self.steps  # noqa: B018  what cannot be compiled is refused before anything is simulated

    def on(self, record: Record) -> Program:
        """The program of the same model on another record."""
        other = copy(self)
        other.record = record
        for fact in ("steps", "substeps", "facts", "_sources"):
            vars(other).pop(fact, None)
        return other

    @cached_property
    def ends(self) -> list[int]:
        """Of each operation the first row of the scratch that is not of it or of one before."""
        rows = [*[item.row for item in self.operations if item.block][1:], self.chain_rows]
        number = np.cumsum([item.block is not None for item in self.operations])
        return [rows[n - 1] if n else 0 for n in number]

    def uncounted(self, shared: int) -> int:
        """Rows that are not counted as work where candidates share so many operations: those of these, and idle ones of
        the others."""
        return (self.ends[shared - 1] if shared else 0) + sum(item.idle for item in self.operations[shared:])

    @cached_property
    def operator_end(self) -> int | None:
        """That row of the first operator; None where there is none."""
        operators = (item.block is not None and item.place == Place.OPERATOR for item in self.operations)
        return next((end for end, operator in zip(self.ends, operators, strict=True) if operator), None)

    @cached_property
    def steps(self) -> list[tuple[int, ...]]:
        """Rows of (address, row of the scratch, row of signals, tile, first sample), for the kernel: what is not of the
        memory sets out from rest where that of what was before the record has led."""
        lead = 0 if self.single else self.model.lead * self.substeps
        return [
            (self.address(item), item.row, 2 * item.axis, item.tile, 0 if self._remembers(item) else lead)
            for item in self.operations
        ]

    @staticmethod
    def _remembers(item: Operation) -> bool:
        """Whether an operation is a part of the memory, or feeds it."""
        return item.block is None or item.place == Place.OPERATOR or item.block.lead > 0

    def address(self, item: Operation) -> int:
        """Of the compiled function of an operation."""
        from pzt_ident.engine.kernel import address
        from pzt_ident.engine.lanes import compile_block

        if item.block is None:
            return address(f"{item.action}_of_sample" if self.single else item.action)
        return compile_block(self.model.form_of(item.block), item.variant).address  # type: ignore[arg-type]

    @cached_property
    def substeps(self) -> int:
        """Steps of the simulation in a sample."""
        return self.model.oversample * self.record.steps

    @property
    def lead(self) -> int:
        """Samples that are simulated ahead of the record."""
        return self.model.lead + self.record.ahead + self.record.run_in * self.record.samples

    def _append(self, block: type[Block], axis: int) -> None:
        """Add a block of one axis, in the variant that the blocks around it require."""
        from pzt_ident.engine.lanes import Variant

        operator = block.place == Place.OPERATOR
        readout = operator and self.model.has_readout
        terms = issubclass(block, Operator) and bool(self.model.terms(block))
        driven = axis in self._fresh and issubclass(block, Operator) and not (readout or terms or self.single)
        if not (driven or issubclass(block, Shift)):
            self._fill(self._fresh & {axis}, block.place)
        self._fresh.discard(axis)
        self._add(block, axis, Variant(driven, readout, terms, single=self.single))

    def _keep(self, number: int, axis: int) -> None:
        """Ahead of the first readout block or guide, keep the signal that the operator or a path beside needs later."""
        blocks = self.model.blocks
        beside = any(issubclass(block, Beside) for block in blocks)
        kept: tuple[tuple[Literal["keep_prompt", "keep_force"], Place, bool], ...] = (
            ("keep_prompt", Place.READOUT, self.model.has_readout),
            ("keep_force", Place.GUIDE, beside),
        )
        for keep, first, needed in kept:
            enters = blocks[number].place >= first and (number == 0 or blocks[number - 1].place < first)
            if enters and needed:
                self._fill(self._fresh & {axis}, blocks[number].place)
                self.operations.append(Operation(keep, axis, TILES * axis, blocks[number].place))

    def _fill(self, axes: set[int], place: Place) -> None:
        """Ahead of a block at a place, have the drives fill the tiles of axes."""
        self.operations += [Operation("fill", axis, TILES * axis, place) for axis in sorted(axes)]
        self._fresh -= axes

    def _add(self, block: type[Block], axis: int, variant: Any) -> None:
        """Add the step of a block, and the sources of the parameters of its copies (branches, or pairs of axes)."""
        from pzt_ident.engine.lanes import layout_of

        form = self.model.form_of(block)
        tile = TILES * axis + (1 if block.place == Place.READOUT and self.model.has_readout else 0)
        layout = layout_of(form, variant)  # type: ignore[arg-type]
        self.operations.append(Operation("block", axis, tile, block.place, block, variant, self.rows, layout.idle))
        words = (*form.arguments(), *(argument_names(block.terms) if variant.terms else ()))  # type: ignore[attr-defined]
        self._give(block, layout, words, self._places(block, axis))

    def _give(self, block: type[Block], layout: Any, words: tuple[str, ...], places: list[tuple[int, int]]) -> None:
        """Take rows of the scratch for a block, with the sources of its arguments."""
        row = self.rows + layout.first_given
        for target, source in places:
            row = self._place(block, target, source, words, row)
        self.rows += layout.rows

    def _additions(self, axis: int) -> list[Operation]:
        """The signals of the additions of an axis, each in a tile of its own behind those of all axes and one more."""
        from pzt_ident.engine.lanes import TIME, Variant, layout_of

        operations, tile = [], self.tiles + 1
        for block in self.model.additions:
            variant = Variant()
            operations.append(Operation("block", axis, tile, block.place, block, variant, self.rows))
            self._give(block, layout_of(block, variant), (*TIME, *block.arguments()), [(axis, axis)])  # type: ignore[arg-type]
            tile += block.amounts()
        return operations

    @property
    def tiles(self) -> int:
        """Number of tiles of the signals of all axes."""
        return TILES * len(self.model.axes)

    def _places(self, block: type[Block], axis: int) -> list[tuple[int, int]]:
        """The pairs (axis, axis), or ordered pairs of different axes, that have their own parameters."""
        if issubclass(block, Coupling):
            axes = range(len(self.model.axes))
            return [(a, b) for a in axes for b in axes if b != a]
        owner = self.model.measured[0] if issubclass(block, Modes) else axis
        return [(owner, owner)]

    def _place(self, block: type[Block], axis: int, other: int, words: tuple[str, ...], row: int) -> int:
        """Add the parameters of a block on an axis or pair of axes from a scratch row on; returns the next row."""
        columns = self.model.columns(block, axis, other)
        constants = {p.name: p.null for p in block.parameters().values() if p.null is not None} | block.numbers()
        if issubclass(block, Coupling) and block.of_mechanics:
            columns = (columns or {}) | self.model.columns_of_others(block, axis, other)
        branches = range(block.branches) if issubclass(block, Bank | Modes) else [0]
        if issubclass(block, Bank) and block.solved:
            rows = [[row + branch * len(words) + words.index(word) for word in block.solved] for branch in branches]
            self.precomputed.append((Precomputation(block, columns or {}, constants), axis, np.array(rows)))
        for branch in branches:
            for word in words:
                column = columns.get(word) if columns else None
                if column is not None and not (self.single and self._is_amount(column)):
                    self.given.append((row, column[branch] if isinstance(column, list) else column))
                elif word in self.facts[axis]:
                    self.of_record.append((row, axis, word))
                else:
                    self.known.append((row, (constants | {"branch": branch}).get(word, 0.0)))
                row += 1
            if issubclass(block, Modes):
                row = self._weigh(block, branch, row)
        return row

    def _is_amount(self, column: int | list[int]) -> bool:
        """Whether a column of theta is one of the parameters of which each record has its own, which are behind all."""
        return max(np.atleast_1d(column)) >= len(self.model.entries)

    @cached_property
    def facts(self) -> list[dict[str, float]]:
        """What `prepare` may ask for, besides the parameters of the model, of each axis of the record."""
        record = self.record
        same = {"dt": record.dt / self.substeps, "duration": record.dt * (record.samples - 1)}
        same |= {"from_rest": float(self.model.from_rest), "lead": float(self.model.lead * self.substeps)}
        same |= {"_first": self.lead, "_dt": record.dt}
        peaks = np.maximum(record.peaks, np.abs(record.levels))
        return [same | {"span": span, "peak": peak} for span, peak in zip(record.spans, peaks, strict=True)]

    def _weigh(self, block: type[Modes], mode: int, row: int) -> int:
        """Add the weights of a mode for force and motion of each axis from a row of the scratch on: 1 for the force of
        the first axis, 0 for an axis that is not measured, a parameter otherwise. Returns the next row."""
        for word, axis in product(block.weights, range(len(self.model.axes))):
            columns = self.model.columns(block, axis, axis)
            if columns is None or word not in columns:
                self.known.append((row, 0.0 if columns is None else 1.0))
            else:
                self.given.append((row, columns[word][mode]))  # type: ignore[index]
            row += 1
        return row

    def scratch(self, theta: Array, rows: int) -> Array:
        """The scratch with the arguments of every block's `prepare`, in lanes: (groups, rows * lanes). theta: with or
        without the amounts of the record, which are zero then."""
        from pzt_ident.engine.kernel import WIDTH, aligned_zeros

        missing = len(self.model.entries) + len(self.model.amounts) - theta.shape[1]
        theta = np.pad(theta, ((0, 0), (0, missing))) if missing else theta
        width = 1 if self.single else WIDTH
        groups = -(-theta.shape[0] // width)
        lanes = np.minimum(np.arange(groups * width), theta.shape[0] - 1).reshape(groups, 1, width)
        scratch = aligned_zeros(groups, rows, width)
        given, columns, known, values = self._sources
        scratch[:, given] = theta[lanes, columns]
        scratch[:, known] = values
        for precompute, axis, places in self.precomputed:
            scratch[:, places] = precompute(theta, self.facts[axis])[lanes[:, 0]].transpose(0, 2, 3, 1)
        return scratch.reshape(groups, -1)

    @cached_property
    def _sources(self) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64], Array]:
        """Rows that come from columns of theta, and rows that hold the same number for every candidate."""
        rows, columns = np.array(self.given, dtype=np.int64).reshape(-1, 2).T
        facts = [(row, self.facts[axis][word]) for row, axis, word in self.of_record]
        known, values = np.array([*self.known, *facts], dtype=float).reshape(-1, 2).T
        return rows, columns[:, None], known.astype(np.int64), values[:, None]
