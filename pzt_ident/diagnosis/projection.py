"""The part of a signal that the fitted parameters can produce, each within its bounds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

NEGLIGIBLE = 1e-7  # of the largest singular value: directions below are rounding
ROUNDING = 1e-12  # of a signal
MOST_EXCHANGES = 12  # of bounds, all at once
OVERSHOOT = 1e-9  # of its range, by which a parameter may pass its bound
ALIKE = 1e-14  # of the largest inner product: traces that differ by less are one
STRETCH = 2048  # samples that are projected at once


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
    together into a few rows for each set: norms and inner products stay, to half the digits. signal: as it is; outside:
    of the traces, (sets, count, samples)."""

    signals: Split
    traces: Split
    signal: Split
    outside: Array

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
        columns = np.vstack([self.outside[number], self.signal.outside]).T
        triangle = np.asarray(np.linalg.qr(columns, mode="r"))
        inside = self.traces.inside[number]
        return Split(self.signal.inside, triangle[:, -1:].T), Split(inside, triangle[:, :-1].T)


class Projection:
    """Least squares along the derivatives of the fitted parameters, where no parameter passes its bounds.

    jacobian: (samples, free), derivatives over the unit cube. point: (free,), from which parameter i may step from
    -point[i] to 1 - point[i]. Where all steps stay within, what remains of a signal is its orthogonal projection; a
    parameter on its bound, or one that the data hardly move, cannot go as far as that would take it.
    """

    def __init__(self, jacobian: Array, point: Array) -> None:
        norms = np.linalg.norm(jacobian, axis=0)
        scales = np.where(norms > 0, norms, 1)
        u, s, vt = np.linalg.svd(jacobian / scales, full_matrices=False)
        kept = s > NEGLIGIBLE * s.max(initial=1e-300)
        self._basis = u[:, kept]
        self._steps = (vt[kept].T / s[kept]) / scales[:, None]  # (free, kept): basis coefficients to parameter steps
        self._responses = s[kept, None] * vt[kept] * scales  # (kept, free): parameter steps to basis coefficients
        self._least, self._most = np.minimum(-point, 0), np.maximum(1 - point, 0)

    def split(self, signals: Array) -> Split:
        """Of signals, (signals, samples)."""
        inside = signals @ self._basis
        return Split(inside, signals - inside @ self._basis.T)

    def split_sets(self, signal: Split, traces: Array, count: int) -> Sets:
        """Sets of so many traces, (sets * count, samples), beside one signal; what is inside of the traces is taken
        away in place."""
        inside = traces @ self._basis
        products = np.zeros((len(traces) // count, 1 + count, 1 + count))
        for first in range(0, traces.shape[1], STRETCH):
            at = slice(first, first + STRETCH)
            outside = traces[:, at]
            outside -= inside @ self._basis[at].T
            both = np.empty((*products.shape[:2], outside.shape[1]))
            both[:, 0], both[:, 1:] = signal.outside[0, at], outside.reshape(-1, count, outside.shape[1])
            products += both @ both.swapaxes(1, 2)
        rows = rows_of(products)
        alone = np.broadcast_to(signal.inside, (len(rows), *signal.inside.shape))
        short = Split(alone, rows[:, :1]), Split(inside.reshape(-1, count, inside.shape[1]), rows[:, 1:])
        return Sets(*short, signal, traces.reshape(-1, count, traces.shape[1]))

    def left(self, signals: Split) -> Array:
        """Norms of what is left of signals at best: (signals,)."""
        beside = np.array([np.linalg.norm(self._left_inside(inside)) for inside in signals.inside])
        return np.hypot(beside, signals.norms_outside)

    def _left_inside(self, inside: Array) -> Array:
        if self._reachable(-self._steps @ inside):
            return np.zeros(0)
        return inside + self._responses @ bounded(self._responses, inside, self._least, self._most)

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
        steps = bounded(both, wanted, low, high)
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
    amounts = np.asarray(np.linalg.lstsq(traces, -signal, rcond=1e-8)[0])
    if not (one_sided & (amounts < 0)).any():
        return amounts
    return bounded(traces, signal, np.where(one_sided, 0, -np.inf), np.full(one_sided.size, np.inf))


def bounded(matrix: Array, target: Array, least: Array, most: Array) -> Array:
    """Steps x, least <= 0 <= most, that leave least of target + matrix x: by exchanges of all bounds at once
    where these settle, else of one. Never more is left than without a step, however ill-conditioned the matrix."""
    norms = np.linalg.norm(matrix, axis=0)
    scales = np.where(norms > 0, norms, 1)
    box = (matrix / scales, target, least * scales, most * scales)
    x = exchanged_together(*box)
    return (exchanged_singly(*box) if x is None else x) / scales


def exchanged_together(matrix: Array, target: Array, low: Array, high: Array) -> Array | None:
    """The steps by block pivoting (Portugal, Judice & Vicente 1994, Math. Comp. 63, 625); None where it does not
    settle, as where a set of free steps comes back."""
    x, free, seen = np.zeros(low.size), low < high, set[bytes]()
    while len(seen) < MOST_EXCHANGES and free.tobytes() not in seen:
        seen.add(free.tobytes())
        beside = target + matrix[:, ~free] @ x[~free]
        x[free] = np.linalg.lstsq(matrix[:, free], -beside, rcond=ROUNDING)[0]
        beyond = free & ((x < low) | (x > high))
        x = np.clip(x, low, high)
        pull = pull_inward(matrix, target, x, low, high)
        back = ~free & (low < high) & (pull > ROUNDING * np.linalg.norm(target))
        if not (beyond | back).any():
            return x if np.linalg.norm(target + matrix @ x) <= np.linalg.norm(target) else None
        free = free & ~beyond | back
    return None


def exchanged_singly(matrix: Array, target: Array, low: Array, high: Array) -> Array:
    """The steps by active sets from x = 0 (Nocedal & Wright 2006, algorithm 16.3)."""
    x, free = np.zeros(low.size), low < high
    for _ in range(10 * low.size):
        left = target + matrix @ x
        step = np.zeros(low.size)
        step[free] = np.linalg.lstsq(matrix[:, free], -left, rcond=ROUNDING)[0]
        with np.errstate(divide="ignore", invalid="ignore"):
            room = np.where(step > 0, (high - x) / step, np.where(step < 0, (low - x) / step, np.inf))
        nearest = int(np.argmin(room))
        if room[nearest] < 1:
            x = np.clip(x + room[nearest] * step, low, high)
            x[nearest] = high[nearest] if step[nearest] > 0 else low[nearest]
            free[nearest] = False
            continue
        x = np.clip(x + step, low, high)
        pull = np.where(free | (high <= low), 0, pull_inward(matrix, target, x, low, high))
        if not pull.max(initial=0) > ROUNDING * np.linalg.norm(target):
            break
        free[np.argmax(pull)] = True
    return x


def pull_inward(matrix: Array, target: Array, x: Array, low: Array, high: Array) -> Array:
    """By how much the sum of squares falls along each step that rests on its bound, as that leaves it; 0 for others."""
    gradient = matrix.T @ (target + matrix @ x)
    return np.where(x >= high, gradient, np.where(x <= low, -gradient, 0))
