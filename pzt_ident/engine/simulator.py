"""A model on one record: the kernel's program, its scratch, and what it leaves."""

from __future__ import annotations

from functools import cached_property
from itertools import product
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.record import Record, between
from pzt_ident.engine.precomputed import Precomputation
from pzt_ident.model.block import TILES, Bank, Beside, Block, Coupling, Modes, Operator, Place, Shift, asked
from pzt_ident.model.chain import Chain

Array = NDArray[np.float64]
SIGNALS: WeakKeyDictionary[Record, dict[Any, Array]] = WeakKeyDictionary()


class Simulator:
    """A model made ready for one record: the kernel's program and the layout of its scratch."""

    def __init__(self, model: Chain, record: Record) -> None:
        from pzt_ident.engine.lanes import Variant

        self.model, self.record = model, record
        self.program: list[tuple[int, ...]] = []
        self.given: list[tuple[int, int]] = []  # row of the scratch, column of theta
        self.known: list[tuple[int, float]] = []  # row of the scratch, the same number for every candidate
        self.solved: list[
            tuple[Precomputation, NDArray[np.int64]]
        ] = []  # what finds numbers, their rows (branches, words)
        self.rows = 0
        self._fresh = set(range(len(model.axes)))  # axes whose tile does not hold a signal yet
        last = max((i for i, block in enumerate(model.blocks) if issubclass(block, Coupling | Modes)), default=-1)
        for number, block in enumerate(model.blocks):
            if issubclass(block, Coupling | Modes):
                for axis in range(len(model.axes)):
                    self._keep(number, axis)
                self._fill(set(self._fresh))
                self._add(block, 0, Variant(axes=len(model.axes)))
                continue
            for axis in range(len(model.axes)):
                if axis in model.measured or number < last:
                    self._keep(number, axis)
                    self._append(block, axis)
        self._fill(self._fresh & set(model.measured))
        self._measured = np.array(model.measured, dtype=np.int64)
        self.sums = self.rows
        self.rows += 2 * len(model.measured)

    def _append(self, block: type[Block], axis: int) -> None:
        """A block of one axis, in the variant that the others around it ask for."""
        from pzt_ident.engine.lanes import Variant

        operator = block.place == Place.OPERATOR
        readout = operator and self.model.reads_out
        terms = issubclass(block, Operator) and bool(self.model.terms(block))
        driven = axis in self._fresh and issubclass(block, Operator) and not (readout or terms)
        if not (driven or issubclass(block, Shift)):
            self._fill(self._fresh & {axis})
        self._fresh.discard(axis)
        self._add(block, axis, Variant(driven, readout, terms))

    def _keep(self, number: int, axis: int) -> None:
        """Ahead of the first block of a stage, put aside what a readout or a path beside the mechanics needs of it."""
        from pzt_ident.engine.kernel import address, keep_force, keep_prompt

        blocks = self.model.blocks
        beside = any(issubclass(block, Beside) for block in blocks)
        stages = [(keep_prompt, Place.READOUT, self.model.reads_out), (keep_force, Place.GUIDE, beside)]
        for keep, first, needed in stages:
            enters = blocks[number].place >= first and (number == 0 or blocks[number - 1].place < first)
            if enters and needed:
                self._fill(self._fresh & {axis})
                self.program.append((address(keep), 0, 2 * axis, TILES * axis, 0))

    def _fill(self, axes: set[int]) -> None:
        from pzt_ident.engine.kernel import address, fill

        self.program += [(address(fill), 0, 2 * axis, TILES * axis, 0) for axis in sorted(axes)]
        self._fresh -= axes

    def _add(self, block: type[Block], axis: int, variant: Any) -> None:
        from pzt_ident.engine.lanes import compile_block

        axes = range(len(self.model.axes))
        coupling = issubclass(block, Coupling)
        form = self.model.form(block)
        made = compile_block(form, variant)  # type: ignore[arg-type]
        tile = TILES * axis + (1 if block.place == Place.READOUT and self.model.reads_out else 0)
        self.program.append((made.address, self.rows, 2 * axis, tile, 0))
        axis = self.model.measured[0] if issubclass(block, Modes) else axis
        places = [(a, b) for a in axes for b in axes if b != a] if coupling else [(axis, axis)]
        branches = range(block.branches) if issubclass(block, Bank | Modes) else [0]
        words = (*form.arguments(), *(asked(block.terms) if variant.terms else ()))  # type: ignore[attr-defined]
        nulls = {p.name: p.null for p in block.parameters().values() if p.null is not None}
        row = self.rows + made.layout.first_given
        for axis, other in places:
            columns = self.model.columns(block, axis, other)
            known = (
                nulls
                | block.numbers()
                | {
                    "dt": self.record.dt / self.times,
                    "span": float(np.ptp(self.record.drive[axis])),
                    "peak": float(np.abs(self.record.drive[axis]).max()),
                }
            )
            if issubclass(block, Bank) and block.solved:
                at = [[row + branch * len(words) + words.index(word) for word in block.solved] for branch in branches]
                self.solved.append((Precomputation(block, columns or {}, known), np.array(at)))
            for branch in branches:
                for word in words:
                    column = columns.get(word) if columns else None
                    if column is None:
                        self.known.append((row, (known | {"branch": branch}).get(word, 0.0)))
                    else:
                        self.given.append((row, column[branch] if isinstance(column, list) else column))
                    row += 1
                if issubclass(block, Modes):
                    row = self._weigh(block, branch, row)
        self.rows += made.layout.rows

    def _weigh(self, block: type[Modes], mode: int, row: int) -> int:
        """What push and motion of each axis count for a mode: their own, 1 for the push of the first axis, 0 for one
        that is not measured. From a row of the scratch on; the row behind them."""
        for word, axis in product(block.weights, range(len(self.model.axes))):
            columns = self.model.columns(block, axis, axis)
            if columns is None or word not in columns:
                self.known.append((row, 0.0 if columns is None else 1.0))
            else:
                self.given.append((row, columns[word][mode]))  # type: ignore[index]
            row += 1
        return row

    @property
    def times(self) -> int:
        """Steps of the simulation in a sample."""
        return self.model.oversample * self.record.steps

    @property
    def signals(self) -> Array:
        """What the kernel reads of the record, the same array for every model that takes its steps."""
        known = SIGNALS.setdefault(self.record, {})
        key = self.times, self.model.oversample > 1, self.model.measured
        if key not in known:
            known[key] = self._signals()
        return known[key]

    def _signals(self) -> Array:
        """Each drive over the run-in and the record and behind it its runs, then the responses about their means; a
        sample of rest ahead and padding behind."""
        from pzt_ident.engine.kernel import PADDING, runs_of

        record, model = self.record, self.model
        rows = []
        for row in record.drive:
            drive = np.tile(self._fine(row), record.run_in + 1)
            rows += [drive, runs_of(drive)]
        for axis in model.measured:
            response = np.zeros(rows[0].size)
            if self.times == 1:
                response[-record.samples :] = record.response[axis] - record.response[axis].mean()
            rows.append(response)
        table = np.array(rows)
        return np.hstack([table[:, :1], table, np.repeat(table[:, -1:], PADDING, axis=1)])

    def _fine(self, drive: Array) -> Array:
        return between(drive, self.times, bool(self.record.run_in), smooth=self.model.oversample > 1)

    def _scratch(self, theta: Array) -> Array:
        """What every block's `prepare` is given, in lanes: (groups, rows * WIDTH)."""
        from pzt_ident.engine.kernel import WIDTH, aligned

        groups = -(-theta.shape[0] // WIDTH)
        lanes = np.minimum(np.arange(groups * WIDTH), theta.shape[0] - 1).reshape(groups, 1, WIDTH)
        scratch = aligned(groups, self.rows, WIDTH)
        rows, columns, known, values = self._sources
        scratch[:, rows] = theta[lanes, columns]
        scratch[:, known] = values
        for solve, places in self.solved:
            scratch[:, places] = solve(theta)[lanes[:, 0]].transpose(0, 2, 3, 1)
        return scratch.reshape(groups, -1)

    @cached_property
    def _sources(self) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64], Array]:
        """Rows that come from columns of theta, and rows that hold the same number for every candidate."""
        rows, columns = np.array(self.given, dtype=np.int64).reshape(-1, 2).T
        known, values = np.array(self.known, dtype=float).reshape(-1, 2).T
        return rows, columns[:, None], known.astype(np.int64), values[:, None]

    @cached_property
    def _scoring(self) -> NDArray[np.int64]:
        """The program with the sums of errors behind it."""
        from pzt_ident.engine.kernel import address, errors

        since = self.record.run_in * self.record.samples + self.record.settle
        behind = 2 * len(self.model.axes)
        sums = [
            (address(errors), self.sums + 2 * i, behind + i, TILES * a, since)
            for i, a in enumerate(self.model.measured)
        ]
        return np.array(self.program + sums, dtype=np.int64)

    def _run(self, theta: Array, program: NDArray[np.int64], output: Array) -> Array:
        from pzt_ident.engine.kernel import run

        scratch = self._scratch(theta)
        since = self.record.run_in * self.record.samples * self.times
        samples = since + self.record.samples * self.times
        run(program, self.signals, scratch, len(self.model.axes), samples, since, self.times, output, self._measured)
        return scratch

    def simulate(self, theta: Array) -> Array:
        """(candidates, measured axes, samples), before the free offset."""
        from pzt_ident.engine.kernel import WIDTH

        theta = np.atleast_2d(theta)
        lanes = -(-theta.shape[0] // WIDTH) * WIDTH
        output = np.empty((lanes, len(self.model.measured), self.record.samples))
        self._run(theta, np.array(self.program, dtype=np.int64).reshape(-1, 5), output)
        return output[: theta.shape[0]]

    @property
    def scored(self) -> int:
        return self.record.samples - self.record.settle

    def squares(self, theta: Array) -> Array:
        """Sum of squared errors over the scored samples, each record's free offset removed: (candidates, axes)."""
        from pzt_ident.engine import kernel

        theta = np.atleast_2d(theta)
        if self.times > 1 or self.model.additions:
            error = self.residuals(theta)
            return np.einsum("mas,mas->ma", error, error)
        scratch = self._run(theta, self._scoring, np.empty((0, 0, 0)))
        sums = scratch.reshape(scratch.shape[0], self.rows, kernel.WIDTH)[:, self.sums :]
        with np.errstate(invalid="ignore", over="ignore"):
            left = sums[:, 1::2] - (sums[:, 0::2] / np.sqrt(self.scored)) ** 2  # overflows no sooner than the first
        left = np.maximum(left, 0)  # rounding leaves less than nothing of a perfect fit
        return left.swapaxes(1, 2).reshape(-1, len(self.model.measured))[: theta.shape[0]]

    def residuals(self, theta: Array) -> Array:
        """Model minus measurement over the scored samples, what each record adds of its own removed."""
        return self.errors(theta)[:, :, self.record.settle :]

    def errors(self, theta: Array) -> Array:
        """Model minus measurement over all samples: (candidates, measured axes, samples). The offset of the record and
        the amounts of its additions are those of least squares over the scored samples."""
        theta = np.atleast_2d(theta)
        error = self.simulate(theta) - self.record.response[list(self.model.measured)]
        settle = self.record.settle
        if not self.model.additions:
            error -= error[:, :, settle:].mean(axis=2, keepdims=True)
            return error
        for i, axis in enumerate(self.model.measured):
            shapes = [entry.axis == axis and entry.block in self.model.additions for entry in self.model.entries]
            kinds, which = np.unique(theta[:, shapes], axis=0, return_inverse=True)
            for kind in range(len(kinds)):
                same = np.flatnonzero(which.ravel() == kind)
                basis = self._basis(axis, theta[same[0]])
                size = np.linalg.norm(basis, axis=0)
                if not np.isfinite(size).all():
                    error[same, i] = np.nan
                    continue
                basis /= np.where(size > 0, size, 1)
                own = basis[settle:]
                solve = np.linalg.pinv(own.T @ own, rcond=1e-12)
                for _ in range(2):  # the second time takes back the rounding of the first
                    error[same, i] -= (basis @ (solve @ (own.T @ error[same, i, settle:].T))).T
        return error

    def broken(self, theta: Array) -> tuple[str, ...]:
        """What one candidate breaks of the conditions of its blocks' equations over this record."""
        said = []
        for block in self.model.blocks:
            if block.watch:
                room = Simulator(self.model.watched(block), self.record).simulate(theta)
                if share := float(np.mean(room <= 0)):
                    said.append(f"at {share:.1%} of its samples {block.broken}")
        return tuple(said)

    def added(self, theta: Array) -> dict[str, Array]:
        """What each addition puts into the record with one candidate, root mean square about its mean, SI units: by
        name of the effect, (measured axes,)."""
        left = self.record.response[list(self.model.measured)] - self.simulate(theta)[0]
        found = {block.name: np.zeros(len(left)) for block in self.model.additions}
        for i, axis in enumerate(self.model.measured):
            one, settle = np.atleast_2d(theta)[0], self.record.settle
            basis = self._basis(axis, one)[settle:]
            amounts = np.linalg.lstsq(basis, left[i, settle:], rcond=1e-12)[0]
            owners = ["", *(block.name for block in self.model.additions for _ in self._signals_of(block, axis, one))]
            for name in found:
                own = [owner == name for owner in owners]
                found[name][i] = np.std(basis[:, own] @ amounts[own])
        return found

    def _basis(self, axis: int, theta: Array) -> Array:
        """One, and the signals of all additions of an axis: (samples, signals)."""
        found = [self._signals_of(block, axis, theta) for block in self.model.additions]
        return np.array([np.ones(self.record.samples), *(signal for own in found for signal in own)]).T

    def _signals_of(self, addition: type[Block], axis: int, theta: Array) -> tuple[Array, ...]:
        columns = self.model.columns(addition, axis, axis) or {}
        words = asked(addition.basis)[1:]  # type: ignore[attr-defined]
        signals: tuple[Array, ...] = addition.basis(self.record.time, *(theta[columns[word]] for word in words))  # type: ignore[attr-defined]
        return signals
