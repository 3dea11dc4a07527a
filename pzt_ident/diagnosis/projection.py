"""The part of a signal that the fitted parameters can produce, each within its bounds."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

NEGLIGIBLE = 1e-7  # of the largest singular value: directions below are rounding
ROUNDING = 1e-12  # of a signal
OVERSHOOT = 1e-9  # of its range, by which a parameter may pass its bound


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
        self.basis = u[:, kept]
        self._steps = (vt[kept].T / s[kept]) / scales[:, None]  # (free, kept): basis coefficients to parameter steps
        self._responses = s[kept, None] * vt[kept] * scales  # (kept, free): parameter steps to basis coefficients
        self._least, self._most = np.minimum(-point, 0), np.maximum(1 - point, 0)

    def remainder(self, signal: Array) -> Array:
        """What is left of a signal (samples,) at best."""
        return self.fit(signal, np.zeros((signal.size, 0)), np.zeros(0, dtype=bool))[1]

    def fit(self, signal: Array, traces: Array, one_sided: NDArray[np.bool_]) -> tuple[Array, Array]:
        """Multiples of the traces (samples, amplitudes) that, together with the parameters, leave least of the signal,
        and what is left. A multiple is not negative where `one_sided`."""
        inside, trace_inside = self.basis.T @ signal, self.basis.T @ traces
        outside, trace_outside = signal - self.basis @ inside, traces - self.basis @ trace_inside
        amounts = _amounts(outside, trace_outside, one_sided)
        coefficients = inside + trace_inside @ amounts
        if self._reachable(-self._steps @ coefficients):
            return amounts, outside + trace_outside @ amounts
        q, r = np.linalg.qr(trace_outside)
        matrix = np.block([[self._responses, trace_inside], [np.zeros((len(r), self._least.size)), r]])
        least = np.concatenate([self._least, np.where(one_sided, 0, -np.inf)])
        most = np.concatenate([self._most, np.full(one_sided.size, np.inf)])
        steps = bounded(matrix, np.concatenate([inside, q.T @ outside]), least, most)
        amounts, coefficients = steps[self._least.size :], inside + matrix[: inside.size] @ steps
        return amounts, outside + trace_outside @ amounts + self.basis @ coefficients

    def _reachable(self, steps: Array) -> bool:
        return bool((steps >= self._least - OVERSHOOT).all() and (steps <= self._most + OVERSHOOT).all())


def _amounts(signal: Array, traces: Array, one_sided: NDArray[np.bool_]) -> Array:
    """Least-squares multiples of the traces (samples, amplitudes) that take the signal away."""
    amounts = np.asarray(np.linalg.lstsq(traces, -signal, rcond=1e-8)[0])
    if not (one_sided & (amounts < 0)).any():
        return amounts
    q, r = np.linalg.qr(traces)
    return bounded(r, q.T @ signal, np.where(one_sided, 0, -np.inf), np.full(one_sided.size, np.inf))


def bounded(matrix: Array, target: Array, least: Array, most: Array) -> Array:
    """Steps x, least <= 0 <= most, that leave least of target + matrix x.

    Active sets from x = 0 (Nocedal & Wright 2006, algorithm 16.3), so that never more is left than without a step,
    however ill-conditioned the matrix.
    """
    norms = np.linalg.norm(matrix, axis=0)
    scales = np.where(norms > 0, norms, 1)
    scaled, low, high = matrix / scales, least * scales, most * scales
    x, free = np.zeros(scales.size), high > low
    for _ in range(10 * scales.size):
        left = target + scaled @ x
        step = np.zeros(scales.size)
        step[free] = np.linalg.lstsq(scaled[:, free], -left, rcond=ROUNDING)[0]
        with np.errstate(divide="ignore", invalid="ignore"):
            room = np.where(step > 0, (high - x) / step, np.where(step < 0, (low - x) / step, np.inf))
        nearest = int(np.argmin(room))
        if room[nearest] < 1:
            x = np.clip(x + room[nearest] * step, low, high)
            x[nearest] = high[nearest] if step[nearest] > 0 else low[nearest]
            free[nearest] = False
            continue
        x = np.clip(x + step, low, high)
        gradient = scaled.T @ (target + scaled @ x)
        pull = np.where(free | (high <= low), 0, np.where(x >= high, gradient, np.where(x <= low, -gradient, 0)))
        if not pull.max(initial=0) > ROUNDING * np.linalg.norm(target):
            break
        free[np.argmax(pull)] = True
    return x / scales
