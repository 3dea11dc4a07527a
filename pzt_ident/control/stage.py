"""An identified stage one sample at a time, whole or in parts."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pzt_ident.data.record import Record
from pzt_ident.engine.lanes import Layout, layout_of
from pzt_ident.engine.program import Operation, Program
from pzt_ident.model.block import TILES, Beside, Block, Place, Shift
from pzt_ident.model.chain import Chain

Array = NDArray[np.float64]
Blocks = Collection[type[Block]]

ACTUATION = frozenset({Place.DELAY, Place.AMPLIFIER})
MATERIAL = frozenset(
    {Place.READOUT, Place.OPERATOR, Place.STATIC, Place.CREEP, Place.COUPLING, Place.GUIDE}
)  # what is solved for its input, sample by sample
MECHANICS = frozenset({Place.FLEXURE, Place.MECHANICS, Place.MODE})
MOTION = ACTUATION | MATERIAL | MECHANICS
EVERYTHING = frozenset(Place)


class Stage:
    """A model with its parameters at a sample time; its parts.

    theta: (parameters,), SI units. dt: s. span, peak: of each axis the peak-to-peak drive and its largest magnitude,
    which effects of a whole record ask for.
    """

    def __init__(self, model: Chain, theta: ArrayLike, dt: float, span: Sequence[float], peak: Sequence[float]) -> None:
        self.model, self.theta, self.dt = model, np.atleast_2d(np.asarray(theta, dtype=np.float64)), dt
        self.span, self.peak = tuple(span), tuple(peak)
        drive = np.array([(peak - span, peak) for span, peak in zip(span, peak, strict=True)])
        unmeasured = np.full(drive.shape, np.nan)
        record = Record("stage", "validate", dt, drive, unmeasured, axes=model.axes)
        self.program = Program(model, record, single=True)
        self.scratch = self.program.scratch(self.theta, self.program.rows)[0]

    @property
    def left_out(self) -> tuple[type[Block], ...]:
        """Blocks and additions that are no motion of the stage: disturbances and errors of the reading, and the slew
        limit, which is a limit."""
        return *(block for block in self.model.blocks if block.place not in MOTION), *self.model.additions

    @cached_property
    def solvable(self) -> Stage:
        """The stage without the terms of its equations that are not solvable for their input."""
        chain, kept = self.model.without_terms(lambda term: not term.solvable)
        return Stage(chain, self.theta[0, kept], self.dt, self.span, self.peak)

    def part(self, places: Collection[Place] = MOTION, without: Blocks = ()) -> Part:
        """The blocks at some places, at rest, but for those that it is to be `without`."""
        return Part(self, places, without)

    def respond(self, drive: Array, places: Collection[Place] = MOTION) -> Array:
        """Displacement (axes, samples), SI units, under a drive (axes, samples) that is linear between its samples,
        from rest under the first one."""
        return self.part(places).respond(drive)

    def operations(self, places: Collection[Place], without: Blocks = ()) -> list[Operation]:
        """The steps of the blocks at some places, in signal order; the force of a path beside the mechanics is what
        they start from, where it is not kept among them."""
        chosen = [
            operation
            for operation in self.program.operations
            if operation.action != "fill" and operation.place in places and operation.block not in without
        ]
        beside = any(operation.block and issubclass(operation.block, Beside) for operation in chosen)
        if not beside or any(operation.action == "keep_force" for operation in chosen):
            return chosen
        axes = range(len(self.model.axes))
        return [*(Operation("keep_force", axis, TILES * axis, Place.GUIDE) for axis in axes), *chosen]

    def given(self, operation: Operation) -> Array:
        """The arguments of the `prepare` of a block, one copy (branch, or pair of axes) after the other."""
        layout = self.layout(operation)
        first = operation.row + layout.first_given
        return self.scratch[first : first + layout.copies * layout.given + layout.given_terms]

    def layout(self, operation: Operation) -> Layout:
        """Of a block's numbers in the scratch."""
        return layout_of(self.form(operation), operation.variant)  # type: ignore[arg-type]

    def form(self, operation: Operation) -> type[Block]:
        """The block of an operation, with the effects in its equation."""
        assert operation.block
        return self.model.form_of(operation.block)

    @cached_property
    def late(self) -> Array:
        """Dead time of each axis, samples."""
        late = np.zeros(len(self.model.axes))
        for operation in self.program.operations:
            if operation.block and issubclass(operation.block, Shift):
                form: Any = self.form(operation)
                late[operation.tile // TILES] += float(form.prepare(*self.given(operation))[0])
        return late

    @property
    def history(self) -> int:
        """Number of inputs that are kept: two, or more for a delay."""
        return int(self.late.max()) + 3


class Part:
    """Blocks of a stage in signal order, with their state; at rest under the first input."""

    def __init__(self, stage: Stage, places: Collection[Place], without: Blocks) -> None:
        operations = stage.operations(places, without)
        rows = [operation.row for operation in operations if operation.block]
        ends = [o.row + stage.layout(o).rows for o in operations if o.block]
        low, high = min(rows, default=0), max(ends, default=0)
        addresses = map(stage.program.address, operations)
        table = [(at, max(o.row - low, 0), o.tile) for at, o in zip(addresses, operations, strict=True)]
        axes = len(stage.model.axes)
        self._program = np.array(table, dtype=np.int64).reshape(-1, 3)
        self._state = stage.scratch[low:high].copy(), np.zeros(TILES * axes), np.zeros((axes, stage.history))
        self._substeps, self._measured = stage.program.substeps, list(stage.model.measured)
        self._fresh = True

    def respond(self, inputs: Array) -> Array:
        """Outputs (axes, samples) to inputs (axes, samples), linear between samples and from where the last call
        ended."""
        from pzt_ident.engine.realtime import respond

        outputs = np.empty(inputs.shape)
        respond(self._program, *self._state, np.ascontiguousarray(inputs), self._substeps, self._fresh, outputs)
        self._fresh = False
        return outputs

    def respond_from_rest(self, inputs: Array) -> Array:
        """The same from rest under the first input."""
        self._fresh = True
        return self.respond(inputs)

    def solve(self, outputs: Array, held: Array, limits: Array, move: Array, slopes: Array) -> Solution:
        """Inputs of the measured axes under which the outputs (axes, samples) are as given, within limits (axes, 2) and
        at most `move` (axes,) a sample; the others have those of `held`. slopes: (axes, axes), rough ones of the
        outputs."""
        from pzt_ident.engine.realtime import solve

        inputs, wrong, missed = np.array(held), np.zeros(outputs.shape), np.zeros(outputs.shape)
        free = np.isin(np.arange(len(outputs)), self._measured)
        diagonal, mixing = np.diag(slopes).copy(), np.zeros(slopes.shape)
        among = np.ix_(self._measured, self._measured)
        mixing[among] = diagonal[self._measured, None] * np.linalg.inv(slopes[among])
        asked = np.ascontiguousarray(outputs)
        results = inputs, wrong, missed
        solve(self._program, *self._state, asked, free, limits, move, diagonal, mixing, self._fresh, *results)
        self._fresh = False
        return Solution(inputs, wrong > 0, missed)

    def regulate(
        self, target: Array, ahead: Array, gains: Array, limits: Array, quantum: Array, delay: int, steps: int
    ) -> tuple[Array, Array]:
        """Drive (axes, steps * samples) and reading (axes, samples) under PI control with `steps` of the stage in a
        sample; arguments as of `pzt_ident.engine.realtime.regulate`."""
        from pzt_ident.engine import realtime

        drive, reading = np.zeros((len(target), steps * target.shape[1])), np.zeros(target.shape)
        asked = np.ascontiguousarray(target), np.ascontiguousarray(ahead)
        settings = gains, limits, quantum, delay
        realtime.regulate(self._program, *self._state, self._substeps, *asked, *settings, drive, reading)
        self._fresh = False
        return drive, reading


class Solution(NamedTuple):
    """Inputs of a part for given outputs, each (axes, samples). wrong: where an output, on the way to what is asked,
    first moves away from it. missed: outputs beyond what is asked."""

    inputs: Array
    wrong: NDArray[np.bool_]
    missed: Array
