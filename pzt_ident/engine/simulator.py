"""Simulation of a model on one record for many candidates at once, and its errors."""

from __future__ import annotations

from collections.abc import Iterator
from copy import copy
from functools import cached_property
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.record import Record, interpolated
from pzt_ident.engine import work
from pzt_ident.engine.additions import SURE, Additions
from pzt_ident.engine.amounts import ROUGH, Amounts, Held
from pzt_ident.engine.distinct import Distinct, columns_of_axes, distinct
from pzt_ident.engine.gather import squares
from pzt_ident.engine.program import Program
from pzt_ident.model.block import TILES
from pzt_ident.model.chain import Chain

Array = NDArray[np.float64]
STRETCH = 4096  # samples that errors are gathered from at once
SIGNALS: WeakKeyDictionary[Record, dict[Any, Array]] = WeakKeyDictionary()


class Simulator:
    """A chain of blocks on one record.

    theta is (candidates, parameters) in SI units, in the order of the chain's entries. Errors are those with the
    `amounts` of the record that follow from them.
    """

    def __init__(self, model: Chain, record: Record) -> None:
        self.model = model
        self._begin(Program(model, record))
        self._measured = TILES * np.array(model.measured, dtype=np.int64)
        self._columns = columns_of_axes(model)
        self._sums = self._program.rows  # row of the scratch after those of the blocks
        self._each = self.additions.sums or 2  # rows of sums of an axis
        self._rows = self._sums + self._each * len(model.measured)

    def on(self, record: Record) -> Simulator:
        """The simulator of the same model on another record."""
        other = copy(self)
        for signals in ("_signals", "_scoring"):
            vars(other).pop(signals, None)
        other._begin(self._program.on(record))
        return other

    def _begin(self, program: Program) -> None:
        self.record, self._program = program.record, program
        self.additions = Additions(program)
        self.amounts: Amounts | Held = Amounts(self)

    def held(self, theta: Array) -> Held | None:
        """The amounts of the record with one candidate; None if it has none."""
        return (
            self.amounts.held(np.atleast_2d(theta))
            if isinstance(self.amounts, Amounts) and self.model.amounts
            else None
        )

    def near(self, held: Held) -> Simulator:
        """The simulator whose errors have the amounts follow to first order, for a fraction of the cost."""
        near = copy(self)
        near.amounts, near.additions = held, Additions(self._program, held.directions)
        return near

    def begun_at(self, held: Held) -> Simulator:
        """The simulator whose amounts are sought from those that are held."""
        begun = copy(self)
        if isinstance(self.amounts, Amounts):
            begun.amounts = self.amounts.beside(begun, held)
        return begun

    def rough(self) -> Simulator:
        """The simulator whose amounts end as soon as they tell points from each other; those that are held do."""
        if isinstance(self.amounts, Held):
            return self
        rough = copy(self)
        rough.amounts = Amounts(rough, ROUGH)
        return rough

    @property
    def substeps(self) -> int:
        """Steps of the simulation in a sample."""
        return self._program.substeps

    @property
    def scored(self) -> int:
        """Number of samples that are scored, those after the settling."""
        return self.record.samples - self.record.settle

    def simulate(self, theta: Array) -> Array:
        """Responses without the free offset, SI units: (candidates, measured axes, samples). Without the amounts of the
        record, unless theta has them."""
        return next(self._stretches(np.atleast_2d(theta), self._program.lead + self.record.samples))[1]

    def tiles(self, theta: Array) -> Iterator[tuple[slice, Array]]:
        """Model minus measurement over the scored samples, with the offset, a stretch after the other: its samples, and
        the errors (candidates, measured axes, samples of the stretch)."""
        return self.deviations(self.amounts.complete(np.atleast_2d(theta)))

    def distinct(self, theta: Array) -> Distinct:
        """The fewest candidates, with the amounts of the record, that have each axis of those of theta."""
        return distinct(self.amounts.complete(np.atleast_2d(theta)), self._columns)

    def deviations(self, theta: Array) -> Iterator[tuple[slice, Array]]:
        """The same without the amounts of the record, unless theta has them."""
        measured, settle = list(self.model.measured), self.record.settle
        for at, response in self._stretches(theta, STRETCH):
            if at.stop > settle:
                at = slice(max(at.start, settle), at.stop)
                error = response[:, :, at.start - at.stop :]
                error -= self.record.response[measured, at]
                yield at, error

    def _stretches(self, theta: Array, most: int) -> Iterator[tuple[slice, Array]]:
        """The responses (candidates, measured axes, samples), stretch by stretch of so many samples at most."""
        from pzt_ident.engine.kernel import TILE

        fewer = distinct(theta, self._columns)
        scratch = self._program.scratch(fewer.theta, self._rows)
        shared = self._shared(scratch, np.array(self._program.steps, dtype=np.int64).reshape(-1, 5))
        length = -(-most // TILE) * TILE
        lead, samples = self._program.lead, self.record.samples
        for first in range(0, lead + samples, length):
            last = min(first + length, lead + samples)
            at = slice(max(first - lead, 0), last - lead)
            output = np.empty((len(fewer.theta), len(self.model.measured), max(at.stop - at.start, 0)))
            self._run(scratch, *shared, len(fewer.theta), output, first, last)
            if output.size:
                yield at, fewer.of_candidates(output)

    def squares(self, theta: Array) -> Array:
        """Sum of squared errors over the scored samples, without the free offset: (candidates, measured axes)."""
        return self.sure_squares(theta) if self.model.additions else self._sums_of_squares(np.atleast_2d(theta))[0]

    def sure_squares(self, theta: Array) -> Array:
        """The same; where the sums of the samples have less than half of their digits, from the errors themselves."""
        theta = np.atleast_2d(theta)
        if self.substeps > 1 or self.additions.follow:
            return squares(self, theta)
        squared, sure = self._sums_of_squares(theta)
        if not sure.all():
            squared[~sure] = squares(self, theta[~sure])
        return squared

    def _sums_of_squares(self, theta: Array) -> tuple[Array, NDArray[np.bool_]]:
        """Those of `squares` as the kernel sums them up, and of which candidates rounding leaves enough digits."""
        from pzt_ident.engine.kernel import WIDTH

        if self.substeps > 1:
            return squares(self, theta), np.ones(len(theta), dtype=bool)
        fewer = self.distinct(theta)
        scratch = self._program.scratch(fewer.theta, self._rows)
        sums = scratch.reshape(scratch.shape[0], self._rows, WIDTH)[:, self._sums :]
        self.additions.begin(sums)
        shared = self._shared(scratch, self._scoring)
        self._run(scratch, *shared, len(fewer.theta), np.empty((0, 0, 0)), 0, self._program.lead + self.record.samples)
        table = sums.reshape(-1, len(self.model.measured), self._each, WIDTH).transpose(0, 3, 1, 2)
        table = fewer.of_candidates(table.reshape(-1, *table.shape[2:])[: len(fewer.theta)])
        if self.model.additions:
            return self.additions.squares(table, self.scored)
        with np.errstate(invalid="ignore", over="ignore"):  # overflows only where the sum of squares does
            squared = table[:, :, 1] - (table[:, :, 0] / np.sqrt(self.scored)) ** 2
            sure = ~(squared < SURE * table[:, :, 1]).any(axis=1)
        return np.maximum(squared, 0), sure  # negative by rounding for a perfect fit

    def put_residuals(self, theta: Array, sizes: Array, out: Array) -> None:
        """Put model minus measurement over the scored samples, see `errors`, over a size of each measured axis into
        `out`: (candidates, measured axes * scored samples)."""
        fewer, errors = self._distinct_errors(theta)
        scaled = errors[:, :, self.record.settle :]
        scaled /= sizes[:, None]
        for i, part in enumerate(np.split(out, len(sizes), axis=1)):
            fewer.put(scaled[:, i], i, part)

    def errors(self, theta: Array) -> Array:
        """Model minus measurement over all samples: (candidates, measured axes, samples). The offset of the record and
        the amounts of its additions are subtracted; they follow from least squares over the scored samples."""
        fewer, errors = self._distinct_errors(theta)
        return fewer.of_candidates(errors)

    def _distinct_errors(self, theta: Array) -> tuple[Distinct, Array]:
        """Those of the fewest candidates that have each axis, or where there are additions, which are solved for in
        groups of candidates, of all."""
        apart = not self.model.additions and not self.additions.follow
        fewer = self.distinct(theta) if apart else Distinct(self.amounts.complete(np.atleast_2d(theta)))
        errors = self.simulate(fewer.theta)
        errors -= self.record.response[list(self.model.measured)]
        self.additions.remove(errors, fewer.theta)
        return fewer, errors

    def added(self, theta: Array) -> dict[str, Array]:
        """Standard deviation over time of what each block with amounts of the record adds to the response with one
        candidate, SI units: by name, (measured axes,)."""
        complete = self.amounts.complete(np.atleast_2d(theta))
        response = self.simulate(complete)[0]
        sizes = self.additions.sizes(self.record.response[list(self.model.measured)] - response, theta)
        of_start = {block.name for block in self.model.blocks if block.lead}
        ahead = {entry.parameter.effect_word or entry.block.name for entry in self.model.amounts} - of_start
        moved = response - self.simulate(theta)[0] if ahead else response
        return sizes | dict.fromkeys(ahead, np.std(moved[:, self.record.settle :], axis=1))

    def violations(self, theta: Array) -> tuple[str, ...]:
        """Sentences on the conditions of the blocks' equations that one candidate violates on this record."""
        sentences, complete = [], self.amounts.complete(np.atleast_2d(theta))
        for block in self.model.blocks:
            if block.margin:
                margin = Simulator(self.model.margin_chain(block), self.record).simulate(complete)
                if share := float(np.mean(margin <= 0)):
                    sentences.append(f"at {share:.1%} of its samples {block.violation}")
        return tuple(sentences)

    @cached_property
    def _scoring(self) -> NDArray[np.int64]:
        """The program, followed by the sums of errors."""
        from pzt_ident.engine.kernel import address

        since = self._program.lead + self.record.settle
        responses = 2 * len(self.model.axes)  # first row of signals after those of the drives
        sums, added = address("products" if self.model.additions else "errors"), []
        for i, a in enumerate(self.model.measured):
            added += [(*step[:-1], since) for step in self.additions.steps(a)]
            added.append((sums, self._sums + self._each * i, responses + i, TILES * a, since))
        return np.array(self._program.steps + added, dtype=np.int64)

    def _shared(self, scratch: Array, steps: NDArray[np.int64]) -> tuple[NDArray[np.int64], Array, int]:
        """The steps and the signals, without those that all candidates share where they are known; and how many rows of
        the scratch are counted as work, those of what they do not share."""
        from pzt_ident.engine.prefix import shared_operations, shared_prefix

        count = shared_operations(self._program, scratch)
        steps, signals = shared_prefix(self._program, scratch, steps, self._signals, count)
        return steps, signals, self._rows - self._program.uncounted(count)

    def _run(
        self,
        scratch: Array,
        steps: NDArray[np.int64],
        signals: Array,
        rows: int,
        candidates: int,
        output: Array,
        first: int,
        last: int,
    ) -> None:
        """Step so many candidates from sample `first` to sample `last`, counted from where the lead begins. rows: that
        are counted as work."""
        from pzt_ident.engine.kernel import WIDTH, run

        fine = self.substeps
        since = self._program.lead * fine
        tiles = self._program.tiles + self.additions.tiles
        run(steps, signals, scratch, candidates, tiles, first * fine, last * fine, since, fine, output, self._measured)
        work.add(work.of_run(len(scratch) * WIDTH, (last - first) * fine, rows, self.model.solving))

    @cached_property
    def _signals(self) -> Array:
        """The signals that the kernel reads, one array for all models with the same substeps and measured axes."""
        cached = SIGNALS.setdefault(self.record, {})
        key = self.substeps, self.model.oversample > 1, self.model.measured, self.model.lead
        if key not in cached:
            cached[key] = self._build_signals()
        return cached[key]

    def _build_signals(self) -> Array:
        """Rows: each drive over lead, run-in and record, followed by its runs, then the responses about their means;
        with a sample of rest ahead and padding behind."""
        from pzt_ident.engine.kernel import PADDING, runs_of

        record, model = self.record, self.model
        ahead = model.lead * self.substeps
        samples = ahead + (record.ahead + record.samples * (record.run_in + 1)) * self.substeps
        table = np.zeros((2 * len(record.drive) + len(model.measured), 1 + samples + PADDING))
        for row, drive, level in zip(table[0::2], record.drive, record.levels, strict=False):
            rise = np.linspace(level, drive[0], record.ahead * self.substeps, endpoint=False)
            whole = np.append(rise, np.tile(self._fine(drive), record.run_in + 1))
            row[1 : 1 + samples] = np.pad(whole, (ahead, 0), mode="edge")
        for i in range(len(record.drive)):
            table[2 * i + 1, 1 : 1 + samples] = runs_of(table[2 * i, 1 : 1 + samples])
        for row, axis in zip(table[2 * len(record.drive) :], model.measured, strict=True):
            if self.substeps == 1:
                row[1 + samples - record.samples : 1 + samples] = record.response[axis] - record.response[axis].mean()
        table[:, 0], table[:, 1 + samples :] = table[:, 1], table[:, samples : samples + 1]
        return table

    def _fine(self, drive: Array) -> Array:
        given = self.record.smooth_drive
        smooth = self.model.oversample > 1 if given is None else given
        return interpolated(drive, self.substeps, bool(self.record.run_in), smooth)


def simulate(model: Chain, record: Record, theta: Array) -> Array:
    """Responses without their free offset, in SI units: (candidates, measured axes, samples)."""
    return Simulator(model, record).simulate(theta)
