"""The part of a signal that the fitted parameters can produce, each within its bounds."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

NEGLIGIBLE = 1e-7  # of the largest singular value: directions below are rounding
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
        self._least, self._most = -point, 1 - point

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
        matrix = np.block([[self._responses, trace_inside], [np.zeros((len(r), self._responses.shape[1])), r]])
        target = np.concatenate([inside, q.T @ outside])
        amounts, coefficients = self._bounded(matrix, target, one_sided)
        return amounts, outside + trace_outside @ amounts + self.basis @ coefficients[: inside.size]

    def _reachable(self, steps: Array) -> bool:
        return bool((steps >= self._least - OVERSHOOT).all() and (steps <= self._most + OVERSHOOT).all())

    def _bounded(self, matrix: Array, target: Array, one_sided: NDArray[np.bool_]) -> tuple[Array, Array]:
        """Bounded least squares (Stark & Parker 1995): the multiples, and what is left of the target."""
        from scipy.optimize import lsq_linear

        least = np.concatenate([np.minimum(self._least, 0), np.where(one_sided, 0, -np.inf)])
        most = np.concatenate([np.maximum(self._most, 0), np.full(one_sided.size, np.inf)])
        norms = np.linalg.norm(matrix, axis=0)
        scales = np.where(norms > 0, norms, 1)
        wide = np.where(most > least, most, least + 1e-300)
        solution = lsq_linear(matrix / scales, -target, (least * scales, wide * scales), method="bvls")
        steps = solution.x / scales
        return steps[len(self._least) :], target + matrix @ steps


def _amounts(signal: Array, traces: Array, one_sided: NDArray[np.bool_]) -> Array:
    """Least-squares multiples of the traces (samples, amplitudes) that take the signal away; 0 where `one_sided` and
    the multiple would be negative."""
    amounts, free = np.zeros(traces.shape[1]), np.ones(traces.shape[1], dtype=bool)
    while free.any():
        amounts[~free] = 0
        amounts[free] = np.linalg.lstsq(traces[:, free], -signal, rcond=1e-8)[0]
        if not (one_sided & (amounts < 0)).any():
            return amounts
        free &= ~(one_sided & (amounts < 0))
    return np.zeros(traces.shape[1])
