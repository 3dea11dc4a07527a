"""Parameters of which each record has its own, ahead of blocks that are not linear: solved for inside a simulation."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.record import Record
from pzt_ident.model.chain import Entry

if TYPE_CHECKING:
    from pzt_ident.engine.simulator import Simulator

Array = NDArray[np.float64]

PASSES = 30  # of linearisation at most
SETTLED = 1e-9  # of the sum of squares: a step that promises less is not taken
NEAR = 1e-6  # beside a point from which a descent goes on
ROUGH = 1e-3  # where points are only ranked
WIDTH = 1e-5  # of the range of an amount: its difference
SHORTER = 0.25  # the next step after one that led uphill
DEPENDENT = 1e-10  # of the largest eigenvalue: directions of less are one


class Amounts:
    """The amounts of a record, from least squares over its scored samples together with the offset and the additions.

    Gauss and Newton's steps from zero, or from the best of the starts of a block, as many for every candidate, so that
    what follows is a smooth function of its other parameters; or from those of a candidate beside, `near`.
    """

    def __init__(self, simulator: Simulator, settled: float = SETTLED, near: Array | float = 0.0) -> None:
        self.simulator, self.settled, self.near = simulator, settled, near
        model, record = simulator.model, simulator.record
        sizes = [size_of(record, entry) for entry in model.amounts]
        bounds = np.array([entry.parameter.bounds for entry in model.amounts]).reshape(-1, 2)
        self._low, self._high = bounds.T * np.array(sizes)
        self._widths = WIDTH * (self._high - self._low)
        self._starts = starts_of(model.amounts) * self._high
        spans = record.scored_swings[list(model.measured)]
        self._scales = 1 / np.where(spans > 0, spans, 1)
        self._known: dict[bytes, Array] = {}  # amounts of the candidates that were asked for last
        self._held: dict[bytes, Held] = {}  # of the candidate that was asked for last

    def beside(self, simulator: Simulator, held: Held) -> Amounts:
        """Those of a simulator, sought from amounts that are held, less exactly: what is known stays known."""
        beside = Amounts(simulator, NEAR, held.values)
        beside._known, beside._held = self._known, self._held
        return beside

    def complete(self, theta: Array) -> Array:
        """theta (candidates, parameters) with the amounts behind them."""
        if not self._low.size:
            return theta
        keys, known = [row.tobytes() for row in theta], self._known  # which another thread may replace
        if not known.keys() >= {*keys}:
            known = self._known = dict(zip(keys, self._solved(theta), strict=True))
        return np.hstack([theta, [known[key] for key in keys]])

    def _solved(self, theta: Array) -> Array:
        """Those of each candidate: (candidates, amounts)."""
        amounts = self._begun(theta)
        best, steps, least = amounts.copy(), amounts.copy(), np.full(len(theta), np.inf)
        promised = np.full(len(theta), np.inf)  # by the next step, of the sum of squares
        moving = np.arange(len(theta))
        for _ in range(PASSES):
            table = self._products(theta[moving], amounts[moving])
            squares = table[:, 0, 0]
            better = squares < least[moving]
            inverse = np.linalg.pinv(table[:, 1:, 1:], rcond=DEPENDENT, hermitian=True)
            multiples = (inverse @ table[:, 1:, :1])[:, :, 0]
            full = (multiples * table[:, 0, 1:]).sum(axis=1)
            promised[moving] = np.where(better, full, SHORTER * promised[moving])
            steps[moving] = np.where(better[:, None], -multiples * self._widths, SHORTER * steps[moving])
            best[moving[better]], least[moving[better]] = amounts[moving[better]], squares[better]
            moving = moving[~(promised[moving] <= self.settled * least[moving])]
            if not moving.size:
                break
            amounts = np.clip(best + steps, self._low, self._high)
        return best

    def _begun(self, theta: Array) -> Array:
        """Where each candidate sets out from: (candidates, amounts)."""
        if len(self._starts) == 1 or np.ndim(self.near):
            return np.full((len(theta), self._low.size), self.near)
        tried = np.repeat(self._starts[None], len(theta), axis=0)
        squares = [self._products(theta, tried[:, k], alone=True)[:, 0, 0] for k in range(len(self._starts))]
        return np.asarray(self._starts[np.argmin(squares, axis=0)])

    def _products(self, theta: Array, amounts: Array, alone: bool = False) -> Array:
        """Of the error and its changes by a width of each amount, without offset and additions, summed over the
        measured axes in multiples of their spans: (candidates, 1 + amounts, 1 + amounts). A failed one has an
        infinite error, and no change. alone: of the error without its changes."""
        simulator, several = self.simulator, 1 if alone else 1 + amounts.shape[1]
        complete = np.hstack([theta, amounts])
        candidates = complete if alone else self._moved(complete)
        signals = 1 + simulator.additions.signals
        tables = np.zeros((len(self._scales), len(theta), signals + several, signals + several))
        level: Array | None = None  # of which nothing is left beside an offset; its square would drown small errors
        for at, error in simulator.deviations(candidates):
            errors = error.reshape(len(theta), several, *error.shape[1:])
            errors[:, 1:] -= errors[:, :1]
            level = errors[:, 0, :, :1].copy() if level is None else level
            errors[:, 0] -= level
            for i, axis in enumerate(simulator.model.measured):
                bases = simulator.additions.bases(axis, theta, at)
                rows = np.concatenate([bases, errors[:, :, i] * self._scales[i]], axis=1)
                tables[i] += rows @ rows.transpose(0, 2, 1)
        failed = ~np.isfinite(tables).all(axis=(0, 2, 3))
        tables[:, failed] = 0
        products = np.asarray(sum(without(table, signals) for table in tables))
        products[failed, 0, 0] = np.inf
        return products

    def _moved(self, complete: Array) -> Array:
        """Each candidate, followed by it with one amount after the other moved by its width."""
        moves = np.zeros((1 + self._widths.size, complete.shape[1]))
        moves[1:, complete.shape[1] - self._widths.size :] = np.diag(self._widths)
        return np.asarray((complete[:, None] + moves).reshape(-1, complete.shape[1]))

    def held(self, theta: Array) -> Held:
        """Those of one candidate."""
        key, known = theta.tobytes(), self._held  # which another thread may replace
        if key not in known:
            known = self._held = {key: self._held_at(theta)}
        return known[key]

    def _held_at(self, theta: Array) -> Held:
        complete, model = self.complete(theta), self.simulator.model
        response, *moved = self.simulator.simulate(self._moved(complete))
        changes = np.array(moved) - response
        rows = {axis: [k for k, entry in enumerate(model.amounts) if entry.axis == axis] for axis in model.measured}
        directions = {axis: changes[rows[axis], i] for i, axis in enumerate(model.measured)}
        return Held(complete[0, theta.shape[1] :], directions)


def starts_of(entries: Sequence[Entry]) -> Array:
    """Where amounts are sought from, as shares of their upper bounds: zero, and the starts that a block declares for
    its own, (starts, amounts)."""
    each = [entry.block.starts.get(entry.parameter.name, ()) for entry in entries]
    count = max(map(len, each), default=0)
    return np.array([np.zeros(len(each)), *([own[k] if own else 0.0 for own in each] for k in range(count))])


def size_of(record: Record, entry: Entry) -> float:
    """What the bounds of an amount are multiples of: the drive's span or largest value, or the span of the response
    that is scored, the zero of which means nothing."""
    if entry.parameter.unit == "drive":
        return max(record.spans[entry.axis], record.peaks[entry.axis])
    return float(record.scored_swings[entry.axis])


class Held(NamedTuple):
    """Amounts of a record that stay as they are, and follow a change of other parameters to first order.

    values: (amounts,). directions: by measured axis the change of its response by its amounts, (amounts, samples).
    """

    values: Array
    directions: Mapping[int, Array]

    def complete(self, theta: Array) -> Array:
        """theta (candidates, parameters) with the amounts behind them."""
        return np.hstack([theta, np.tile(self.values, (len(theta), 1))])


def without(table: Array, signals: int) -> Array:
    """Products (candidates, n, n) of what is left of the later rows without their projection on the first ones."""
    basis, across, rest = table[:, :signals, :signals], table[:, :signals, signals:], table[:, signals:, signals:]
    size = np.sqrt(np.maximum(np.diagonal(basis, axis1=1, axis2=2), 1e-300))
    basis = basis / (size[:, :, None] * size[:, None, :])
    across = across / size[:, :, None]
    return np.asarray(rest - across.transpose(0, 2, 1) @ np.linalg.pinv(basis, rcond=1e-12, hermitian=True) @ across)
