"""Simulation of a model on one record for many candidates at once, and its errors."""

from __future__ import annotations

from functools import cached_property
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.record import Record, interpolated
from pzt_ident.engine.additions import Additions
from pzt_ident.engine.program import Program
from pzt_ident.model.block import TILES
from pzt_ident.model.chain import Chain

Array = NDArray[np.float64]
SIGNALS: WeakKeyDictionary[Record, dict[Any, Array]] = WeakKeyDictionary()


class Simulator:
    """A chain of blocks on one record.

    theta is (candidates, parameters) in SI units, in the order of the chain's entries.
    """

    def __init__(self, model: Chain, record: Record) -> None:
        self.model, self.record = model, record
        self._program = Program(model, record)
        self._additions = Additions(self._program)
        self._measured = TILES * np.array(model.measured, dtype=np.int64)
        self._sums = self._program.rows  # row of the scratch after those of the blocks
        self._each = self._additions.sums or 2  # rows of sums of an axis
        self._rows = self._sums + self._each * len(model.measured)

    @property
    def substeps(self) -> int:
        """Steps of the simulation in a sample."""
        return self._program.substeps

    @property
    def scored(self) -> int:
        """Number of samples that are scored, those after the settling."""
        return self.record.samples - self.record.settle

    def simulate(self, theta: Array) -> Array:
        """Responses without the free offset, SI units: (candidates, measured axes, samples)."""
        theta = np.atleast_2d(theta)
        output = np.empty((theta.shape[0], len(self.model.measured), self.record.samples))
        self._run(theta, np.array(self._program.steps, dtype=np.int64).reshape(-1, 5), output)
        return output

    def squares(self, theta: Array) -> Array:
        """Sum of squared errors over the scored samples, without the free offset: (candidates, measured axes)."""
        from pzt_ident.engine.kernel import WIDTH

        theta = np.atleast_2d(theta)
        if self.substeps > 1:
            error = self.residuals(theta)
            return np.einsum("mas,mas->ma", error, error)
        scratch = self._run(theta, self._scoring, np.empty((0, 0, 0)))
        sums = scratch.reshape(scratch.shape[0], self._rows, WIDTH)[:, self._sums :]
        if self.model.additions:
            table = sums.reshape(-1, len(self.model.measured), self._each, WIDTH).transpose(0, 3, 1, 2)
            squares, sure = self._additions.squares(table.reshape(-1, *table.shape[2:])[: theta.shape[0]], self.scored)
            if not sure.all():
                error = self.residuals(theta[~sure])
                squares[~sure] = np.einsum("mas,mas->ma", error, error)
            return squares
        with np.errstate(invalid="ignore", over="ignore"):
            squares = (
                sums[:, 1::2] - (sums[:, 0::2] / np.sqrt(self.scored)) ** 2
            )  # overflows only where the sum of squares does
        squares = np.maximum(squares, 0)  # negative by rounding for a perfect fit
        return squares.swapaxes(1, 2).reshape(-1, len(self.model.measured))[: theta.shape[0]]

    def residuals(self, theta: Array) -> Array:
        """Model minus measurement over the scored samples, without offset and additions; see `errors`."""
        return self.errors(theta)[:, :, self.record.settle :]

    def errors(self, theta: Array) -> Array:
        """Model minus measurement over all samples: (candidates, measured axes, samples). The offset of the record and
        the amounts of its additions are subtracted; they follow from least squares over the scored samples."""
        theta = np.atleast_2d(theta)
        error = self.simulate(theta) - self.record.response[list(self.model.measured)]
        self._additions.remove(error, theta)
        return error

    def added(self, theta: Array) -> dict[str, Array]:
        """Standard deviation of each addition with one candidate; see `Additions.sizes`."""
        residual = self.record.response[list(self.model.measured)] - self.simulate(theta)[0]
        return self._additions.sizes(residual, theta)

    def violations(self, theta: Array) -> tuple[str, ...]:
        """Sentences on the conditions of the blocks' equations that one candidate violates on this record."""
        sentences = []
        for block in self.model.blocks:
            if block.margin:
                margin = Simulator(self.model.margin_chain(block), self.record).simulate(theta)
                if share := float(np.mean(margin <= 0)):
                    sentences.append(f"at {share:.1%} of its samples {block.violation}")
        return tuple(sentences)

    @cached_property
    def _scoring(self) -> NDArray[np.int64]:
        """The program, followed by the sums of errors."""
        from pzt_ident.engine.kernel import address, errors, products

        since = self.record.run_in * self.record.samples + self.record.settle
        responses = 2 * len(self.model.axes)  # first row of signals after those of the drives
        sums, added = products if self.model.additions else errors, []
        for i, a in enumerate(self.model.measured):
            added += [(*step[:-1], since) for step in self._additions.steps(a)]
            added.append((address(sums), self._sums + self._each * i, responses + i, TILES * a, since))
        return np.array(self._program.steps + added, dtype=np.int64)

    def _run(self, theta: Array, program: NDArray[np.int64], output: Array) -> Array:
        from pzt_ident.engine.kernel import run

        scratch = self._program.scratch(theta, self._rows)
        self._additions.begin(scratch.reshape(len(scratch), self._rows, -1)[:, self._sums :])
        since = self.record.run_in * self.record.samples * self.substeps
        samples = since + self.record.samples * self.substeps
        tiles = self._program.tiles + self._additions.tiles
        run(program, self._signals, scratch, tiles, samples, since, self.substeps, output, self._measured)
        return scratch

    @property
    def _signals(self) -> Array:
        """The signals that the kernel reads, one array for all models with the same substeps and measured axes."""
        cached = SIGNALS.setdefault(self.record, {})
        key = self.substeps, self.model.oversample > 1, self.model.measured
        if key not in cached:
            cached[key] = self._build_signals()
        return cached[key]

    def _build_signals(self) -> Array:
        """Rows: each drive over run-in and record, followed by its runs, then the responses about their means; with a
        sample of rest ahead and padding behind."""
        from pzt_ident.engine.kernel import PADDING, runs_of

        record, model = self.record, self.model
        rows = []
        for row in record.drive:
            drive = np.tile(self._fine(row), record.run_in + 1)
            rows += [drive, runs_of(drive)]
        for axis in model.measured:
            response = np.zeros(rows[0].size)
            if self.substeps == 1:
                response[-record.samples :] = record.response[axis] - record.response[axis].mean()
            rows.append(response)
        table = np.array(rows)
        return np.hstack([table[:, :1], table, np.repeat(table[:, -1:], PADDING, axis=1)])

    def _fine(self, drive: Array) -> Array:
        return interpolated(drive, self.substeps, bool(self.record.run_in), smooth=self.model.oversample > 1)


def simulate(model: Chain, record: Record, theta: Array) -> Array:
    """Responses without their free offset, in SI units: (candidates, measured axes, samples)."""
    return Simulator(model, record).simulate(theta)
