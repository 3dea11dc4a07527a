"""Trends and lines that are projected out of noise, and what noise with a memory was before."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from pzt_ident.libraries import extension

Array = NDArray[np.float64]

LINE_RATIO = 30.0  # power of a spectral line over that of the frequencies around it
ROUNDING = 1e-12  # of a signal: what is left below is no noise
MOST_MEMORY = 0.95  # from sample to sample: noise of a longer memory is not told from what settles
GOLDEN = (5**0.5 - 1) / 2


def deviation(noise: Array, basis: Array) -> float:
    """Standard deviation of noise that an orthonormal basis, (samples, columns), has been projected out of, which takes
    the more of it the longer its memory is."""
    power, alike = float(noise @ noise), float(noise[1:] @ noise[:-1])
    if power == 0:
        return 0.0
    return float(np.sqrt(power / expected_products(basis, memory_of(alike / power, basis))[0]))


def memory_of(alike: float, *bases: Array) -> float:
    """Memory of first order of noise that is so alike from sample to sample after a basis has been projected out of it,
    or bases out of parts of it."""

    def excess(memory: float) -> float:
        power, beside = np.sum([expected_products(basis, memory) for basis in bases], axis=0)
        return float(beside / power - alike)

    if excess(0.0) >= 0:
        return 0.0
    if excess(MOST_MEMORY) <= 0:
        return MOST_MEMORY
    zeros = extension("scipy.optimize", "_zeros")
    return float(zeros._brentq(excess, 0.0, MOST_MEMORY, 1e-4, 1e-9, 100, (), False, True))


def expected_products(basis: Array, memory: float) -> tuple[float, float]:
    """What the sum of squares of n, and that of n_t n_{t+1}, are expected to be, where n is noise of unit variance with
    the correlations R_st = memory^|s - t| that the basis B, (..., samples, columns), has been projected out of:
    tr(MRM) and the sum next to the diagonal of MRM, M = I - B B', over all windows."""
    filtered = extension("scipy.signal", "_sigtools")._linear_filter  # scipy.signal takes half a second to import
    basis = basis.reshape(-1, *basis.shape[-2:])
    onward, back = (filtered(np.ones(1), np.array([1.0, -memory]), rows, 1) for rows in (basis, basis[:, ::-1]))
    correlated = onward + back[:, ::-1] - basis
    inner = basis.swapaxes(1, 2) @ correlated
    across = (basis[:, :-1] * correlated[:, 1:]).sum() + (correlated[:, :-1] * basis[:, 1:]).sum()
    windows, samples, _ = basis.shape
    beside = windows * (samples - 1) * memory - across + ((basis[:, :-1] @ inner) * basis[:, 1:]).sum()
    return float(windows * samples - np.trace(inner, axis1=1, axis2=2).sum()), float(beside)


def without_lines(
    signal: Array, degree: int, shapes: Sequence[Array] = (), most: int = 5, near: int = 25
) -> tuple[Array, Array]:
    """The signal less a polynomial, shapes and, fitted together with them, up to `most` sinusoids whose power is
    LINE_RATIO times that of the `near` frequencies around them, all made white; and the orthonormal basis of what was
    taken off, (samples, columns)."""
    t = np.arange(signal.size)
    trend = np.polynomial.legendre.legvander(np.linspace(-1, 1, signal.size), degree)
    basis = np.linalg.qr(np.column_stack([trend, *shapes]))[0]

    def waves(frequency: float) -> Array:
        """Cosine and sine, orthonormal to each other and to the basis: (samples, 2)."""
        columns = np.column_stack([np.cos(2 * np.pi * frequency * t), np.sin(2 * np.pi * frequency * t)])
        return np.asarray(np.linalg.qr(columns - basis @ (basis.T @ columns))[0])

    def power_at(frequency: float) -> float:
        return float(np.square(waves(frequency).T @ signal).sum())

    noise = signal - basis @ (basis.T @ signal)
    for _ in range(most):
        if np.abs(noise).max() <= ROUNDING * np.abs(signal).max():
            break
        power = np.abs(np.fft.rfft(whitened(noise) * np.hanning(noise.size))) ** 2
        peak = int(np.argmax(power[3:])) + 3 if power.size > 2 * near else 0
        around = np.concatenate([power[max(1, peak - near) : max(1, peak - 2)], power[peak + 3 : peak + near]])
        if not peak or power[peak] <= LINE_RATIO * around.mean():
            break
        basis = np.hstack([basis, waves(top(power_at, (peak - 1) / noise.size, (peak + 1) / noise.size, 1e-9))])
        noise = signal - basis @ (basis.T @ signal)
    return np.asarray(noise), basis


def whitened(noise: Array) -> Array:
    """Noise less what follows of it from the sample before: without its memory of first order."""
    memory = noise[1:] @ noise[:-1] / (noise @ noise)
    return np.asarray(np.append(noise[0], noise[1:] - memory * noise[:-1]))


def top(function: Callable[[float], float], low: float, high: float, width: float) -> float:
    """Where a function of one hill between two places is largest, to a width: by golden sections (Kiefer 1953, Proc.
    Am. Math. Soc. 4, 502)."""
    left, right = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
    at_left, at_right = function(left), function(right)
    while high - low > width:
        if at_left > at_right:
            high, right, at_right = right, left, at_left
            left = high - GOLDEN * (high - low)
            at_left = function(left)
        else:
            low, left, at_left = left, right, at_right
            right = low + GOLDEN * (high - low)
            at_right = function(right)
    return (low + high) / 2
