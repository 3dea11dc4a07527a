"""The part of a signal that the fitted parameters can produce, each within its bounds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from pzt_ident.engine.gather import lapack

Array = NDArray[np.float64]

NEGLIGIBLE = 1e-7  # of the largest singular value: directions below are rounding
ROUNDING = 1e-12  # of a signal
OVERSHOOT = 1e-9  # of its range, by which a parameter may pass its bound
PANEL = 32  # columns that LAPACK takes together
ALIKE = 1e-14  # of the largest inner product: traces that differ by less are one
LOST = 1e-8  # of the square of a trace: so little outside is told by taking away what is inside, not from squares


@dataclass(frozen=True)
class Split:
    """Signals in two parts: inside what small steps of the parameters can produce, as (signals, directions), and
    outside of it, (signals, samples), or rotated into fewer rows; or several sets of them."""

    inside: Array
    outside: Array

    def __getitem__(self, rows: int | slice | Sequence[int]) -> Split:
        return Split(self.inside[rows], self.outside[rows])

    @cached_property
    def norms_outside(self) -> Array:
        return np.linalg.norm(self.outside, axis=-1)

    @cached_property
    def norms(self) -> Array:
        return np.hypot(np.linalg.norm(self.inside, axis=-1), self.norms_outside)


@dataclass(frozen=True)
class Sets:
    """Sets of traces beside a signal. signals: (sets, 1, ...), and traces: (sets, count, ...), what is outside rotated
    together into a few rows for each set: norms and inner products stay, to half the digits. whole: the traces as they
    are, (sets, count, samples)."""

    projection: Projection
    signals: Split
    traces: Split
    whole: Array

    @cached_property
    def least(self) -> Array:
        """Norms that multiples of each set would leave of the signal if nothing had bounds: (sets,)."""
        traces, target = self.traces.outside, self.signals.outside[:, 0]
        products, directions = np.linalg.eigh(traces @ traces.swapaxes(1, 2))
        along = np.einsum("scd,sc->sd", directions, np.einsum("scr,sr->sc", traces, target))
        told = products > ALIKE * products[:, -1:]
        taken = np.where(told, along**2 / np.where(told, products, 1), 0).sum(axis=1)
        return np.asarray(np.sqrt(np.maximum(np.square(target).sum(axis=1) - taken, 0)))

    def exact(self, number: int) -> tuple[Split, Split]:
        """The signal and a set of traces, what is outside rotated together to all digits."""
        signal, traces = self.projection.signal, self.projection.split(self.whole[number])
        triangle = np.asarray(np.linalg.qr(np.vstack([traces.outside, signal.outside]).T, mode="r"))
        return Split(signal.inside, triangle[:, -1:].T), Split(traces.inside, triangle[:, :-1].T)


class Projection:
    """Least squares along the derivatives of the fitted parameters, where no parameter passes its bounds.

    jacobian: (samples, free), derivatives over the unit cube. point: (free,), from which parameter i may step from
    -point[i] to 1 - point[i]. Where all steps stay within, what remains of a signal is its orthogonal projection; a
    parameter on its bound, or one that the data hardly move, cannot go as far as that would take it. signal:
    (samples,), what traces are to take away.
    """

    def __init__(self, jacobian: Array, point: Array, signal: Array) -> None:
        norms = np.linalg.norm(jacobian, axis=0)
        scales = np.where(norms > 0, norms, 1)
        u, s, vt = np.linalg.svd(jacobian / scales, full_matrices=False)
        kept = s > NEGLIGIBLE * s.max(initial=1e-300)
        self._basis = u[:, kept]
        self._steps = (vt[kept].T / s[kept]) / scales[:, None]  # (free, kept): basis coefficients to parameter steps
        self._responses = s[kept, None] * vt[kept] * scales  # (kept, free): parameter steps to basis coefficients
        self._least, self._most = np.minimum(-point, 0), np.maximum(1 - point, 0)
        self.signal, self._begin = self.split(signal[None]), np.zeros(point.size)
        self._begin = self._within(self.signal.inside[0])

    def split(self, signals: Array) -> Split:
        """Of signals, (signals, samples)."""
        inside = signals @ self._basis
        return Split(inside, signals - inside @ self._basis.T)

    def split_sets(self, traces: Array, count: int) -> Sets:
        """Sets of so many traces, (sets * count, samples), beside the signal."""
        whole, outside = traces.reshape(-1, count, traces.shape[1]), self.signal.outside[0]
        inside = (traces @ self._basis).reshape(-1, count, len(self._responses))
        products = np.empty((len(whole), 1 + count, 1 + count))
        products[:, 0, 0], products[:, 1:, 0] = outside @ outside, whole @ outside
        squares = whole @ whole.swapaxes(1, 2)
        products[:, 1:, 1:] = squares - inside @ inside.swapaxes(1, 2)
        products[:, 0, 1:] = products[:, 1:, 0]
        for number in lost(products[:, 1:, 1:], squares):
            both = np.vstack([outside, self.split(whole[number]).outside])
            products[number] = both @ both.T
        rows = rows_of(products)
        alone = np.broadcast_to(self.signal.inside, (len(rows), *self.signal.inside.shape))
        return Sets(self, Split(alone, rows[:, :1]), Split(inside, rows[:, 1:]), whole)

    def left(self, signals: Split) -> Array:
        """Norms of what is left of signals at best: (signals,)."""
        return np.hypot(self._norms_left(signals.inside), signals.norms_outside)

    def left_of(self, signals: Array) -> Array:
        """The same of signals as they are, (signals, samples), to half the digits."""
        inside = signals @ self._basis
        outside = np.einsum("ij,ij->i", signals, signals) - np.einsum("ij,ij->i", inside, inside)
        return np.sqrt(self._norms_left(inside) ** 2 + np.maximum(outside, 0))

    def _norms_left(self, inside: Array) -> Array:
        return np.array([np.linalg.norm(self._left_inside(signal)) for signal in inside])

    def _left_inside(self, inside: Array) -> Array:
        if self._reachable(-self._steps @ inside):
            return np.zeros(0)
        return inside + self._responses @ self._within(inside)

    def _within(self, inside: Array) -> Array:
        """The steps within the bounds that take most of a signal away."""
        return bounded(self._responses, inside, self._least, self._most, self._begin)

    def fit(
        self, signal: Split, traces: Split, one_sided: NDArray[np.bool_], least: float = np.inf
    ) -> tuple[Array, float]:
        """Multiples of the traces that, together with the parameters, leave least of the signal, and the norm of what
        is left. A multiple is not negative where `one_sided`. least: no less needs to be told exactly."""
        matrix, target = traces.outside.T, signal.outside[0]
        inside, trace_inside = signal.inside[0], traces.inside.T
        amounts = _amounts(matrix, target, one_sided)
        left = float(np.linalg.norm(target + matrix @ amounts))
        if left >= least or self._reachable(-self._steps @ (inside + trace_inside @ amounts)):
            return amounts, left
        both = np.block([[self._responses, trace_inside], [np.zeros((len(matrix), self._least.size)), matrix]])
        low = np.concatenate([self._least, np.where(one_sided, 0, -np.inf)])
        high = np.concatenate([self._most, np.full(one_sided.size, np.inf)])
        wanted = np.concatenate([inside, target])
        steps = bounded(both, wanted, low, high, np.concatenate([self._begin, np.zeros(one_sided.size)]))
        return steps[self._least.size :], float(np.linalg.norm(wanted + both @ steps))

    def _reachable(self, steps: Array) -> bool:
        return bool((steps >= self._least - OVERSHOOT).all() and (steps <= self._most + OVERSHOOT).all())


def rows_of(products: Array) -> Array:
    """Vectors of the inner products (sets, vectors, vectors): (sets, vectors, rows)."""
    norms = np.sqrt(np.einsum("svv->sv", products))
    scales = np.where(norms > 0, norms, 1)[:, :, None]
    values, directions = np.linalg.eigh(products / scales / scales.swapaxes(1, 2))
    return np.asarray(scales * directions * np.sqrt(np.maximum(values, 0))[:, None, :])


def _amounts(traces: Array, signal: Array, one_sided: NDArray[np.bool_]) -> Array:
    """Least-squares multiples of the traces, (rows, amplitudes), that take the signal away."""
    amounts = least_squares(traces, -signal, 1e-8)
    if not (one_sided & (amounts < 0)).any():
        return amounts
    low, high = np.where(one_sided, 0, -np.inf), np.full(one_sided.size, np.inf)
    return bounded(traces, signal, low, high, np.zeros(one_sided.size))


def lost(outside: Array, whole: Array) -> NDArray[np.intp]:
    """Numbers of the sets, by inner products (sets, traces, traces), of which a trace has too little outside."""
    least = LOST * np.einsum("scc->sc", whole)
    return np.flatnonzero((np.einsum("scc->sc", outside) < least).any(axis=1))


def bounded(matrix: Array, target: Array, low: Array, high: Array, begin: Array) -> Array:
    """Steps x, low <= x <= high, that leave least of target + matrix x, by active sets (Nocedal & Wright 2006,
    algorithm 16.3) from steps within, of which those on a bound are held at first. Never more is left than with these,
    however ill-conditioned the matrix."""
    norms = np.linalg.norm(matrix, axis=0)
    scales = np.where(norms > 0, norms, 1)
    return np.clip(exchanged(matrix / scales, target, low * scales, high * scales, begin * scales) / scales, low, high)


def exchanged(matrix: Array, target: Array, low: Array, high: Array, x: Array) -> Array:
    """The steps, from x on, where all columns are of one size."""
    free = (x > low) & (x < high)
    least, left = ROUNDING * np.linalg.norm(target), target + matrix @ x
    for _ in range(10 * low.size):
        step = np.zeros(low.size)
        step[free] = least_squares(matrix[:, free], -left, ROUNDING)
        room = room_along(step, x, low, high)
        nearest = int(np.argmin(room))
        if room[nearest] < 1:
            x = within(x + room[nearest] * step, low, high)
            x[nearest] = high[nearest] if step[nearest] > 0 else low[nearest]
            free[nearest] = False
            left = target + matrix @ x
            continue
        x = within(x + step, low, high)
        left = target + matrix @ x
        gradient = matrix.T @ left
        pull = np.where(free | (high <= low), 0, np.where(x >= high, gradient, -gradient))
        if not pull.max(initial=0) > least:
            break
        free[np.argmax(pull)] = True
    return x


def least_squares(matrix: Array, target: Array, rank: float) -> Array:
    """The shortest x that leaves least of matrix x - target, by a complete orthogonal factorization; directions below
    that share of the largest are rounding."""
    rows, columns = matrix.shape
    if not matrix.size:
        return np.zeros(columns)
    right = np.zeros((max(rows, columns), 1))
    right[:rows, 0] = target
    room = min(rows, columns) + 2 * columns + PANEL * (columns + 1)
    return np.asarray(lapack.dgelsy(matrix, right, np.zeros((columns, 1), np.int32), rank, room)[1][:columns, 0])


def within(x: Array, low: Array, high: Array) -> Array:
    """Steps, those beyond a bound on it."""
    return np.minimum(np.maximum(x, low), high)


def room_along(step: Array, x: Array, low: Array, high: Array) -> Array:
    """The multiples of each step after which its bound is reached."""
    room = np.full(step.size, np.inf)
    return np.divide(np.where(step > 0, high, low) - x, step, out=room, where=step != 0)
