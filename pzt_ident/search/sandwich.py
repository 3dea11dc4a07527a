"""Covariance of least squares with correlated residuals, from samples that come stretch by stretch."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable

import numpy as np
from numpy.typing import NDArray

from pzt_ident.engine.gather import Triangle, lapack

Array = NDArray[np.float64]
Samples = Callable[[], Iterable[tuple[int, Array]]]

BLOCKS = 40  # of neighbouring samples, if all are of one series
OPEN = 1e-9  # of the largest singular value: a direction below is one that the data leave open
DIED = 1e-6  # of a filtered direction's squares: what is less has died away
STRETCH = 4096  # samples in which it may die away


class Sandwich:
    """(J'J)^-1 M (J'J)^-1 with M summed over blocks of neighbouring samples (White 1980; Newey & West 1987), in no
    direction less than white noise or noise with the spectrum of the residual gives.

    samples: gives residual and Jacobian as `Problem.samples` does, as often as it is called. jacobian: rotated, (rows,
    free). covariance: (free, free) in the unit cube, huge along directions that the data leave open.
    """

    def __init__(self, samples: Samples) -> None:
        triangle, lags = None, Lags()
        for series, rows in samples():
            lags.add(series, rows[0])
            triangle = triangle or Triangle(len(rows))
            triangle.add(np.array(rows[[*range(1, len(rows)), 0]]))
        if triangle is None:
            raise ValueError("no samples")
        self.jacobian, self.size = triangle.r[:, :-1], lags.size
        _, s, vt = np.linalg.svd(self.jacobian, full_matrices=False)
        self._directions = vt.T / np.maximum(s, OPEN * max(s.max(initial=0), 1e-300))
        sums, least = self._moments(samples, *autoregression(lags))
        meat = sums.T @ sums
        white = lags.sums[0] / max(1, self.size - s.size)
        least = np.maximum(white, least)  # a direction without influence has no gradient
        meat += np.diag(np.maximum(least - np.diag(meat), 0))
        self.covariance = self._directions @ meat @ self._directions.T

    def _moments(self, samples: Samples, weights: Array, variance: float) -> tuple[Array, Array]:
        """Sums of the gradient along each direction over each block, and the variance of the sum along each with noise
        of this autoregression: (blocks, directions), (directions,). No block is of two series."""
        count, length = self._directions.shape[1], -(-self.size // BLOCKS)
        energy = np.zeros(count)
        sums: dict[tuple[int, int], Array] = defaultdict(lambda: np.zeros(count))
        lengths: dict[int, int] = defaultdict(int)
        after = np.zeros((count, weights.size - 1))
        states: dict[int, Array] = defaultdict(lambda: after)
        for series, rows in samples() if count else ():
            along = self._directions.T @ rows[1:]
            pulls, at = along * rows[0], lengths[series]
            for begin in range(-(at % length), along.shape[1], length):
                sums[series, (at + begin) // length] += pulls[:, max(begin, 0) : begin + length].sum(axis=1)
            lengths[series] += along.shape[1]
            filtered, states[series] = answer(weights, states[series], along)
            energy += np.square(filtered).sum(axis=1)
        for state in states.values():
            energy += died_away(weights, state, energy, self.size)
        return np.array([*sums.values()]).reshape(-1, count), variance * energy


def answer(weights: Array, before: Array, along: Array) -> tuple[Array, Array]:
    """y in sum_i a_i y[k - i] = x[k] with a_0 = 1, (directions, samples), and its last values; before: those that came
    before, (directions, order). The equations of all samples are a triangle with few diagonals."""
    order, samples = before.shape[1], along.shape[1]
    if not before.size:
        return along, before
    right = np.array(along.T, order="F")
    for direction, known in enumerate(before):
        carried = np.convolve(known, weights)[order : order + samples]
        right[: carried.size, direction] -= carried
    diagonals = np.tile(weights[:, None], (1, samples))
    after = lapack.dtbtrs(diagonals, right, uplo="L", diag="U", overwrite_b=1)[0].T
    return after, np.hstack([before, after])[:, samples:]


def died_away(weights: Array, state: Array, energy: Array, most: int) -> Array:
    """Squares of what comes out of a filter after its input has ended: (directions,)."""
    total = np.zeros(len(state))
    for _ in range(0, most if state.any() else 0, STRETCH):
        rest, state = answer(weights, state, np.zeros((len(state), STRETCH)))
        more = np.square(rest).sum(axis=1)
        total += more
        if (more <= DIED * (energy + total)).all():
            break
    return total


class Lags:
    """Sums of products of the residual with itself so many samples later: `sums`, from lag 0 on. size: of samples."""

    def __init__(self, most: int = 100) -> None:
        self.sums, self.size = np.zeros(most + 1), 0
        self._before: dict[int, Array] = defaultdict(lambda: np.zeros(0))

    def add(self, series: int, residual: Array) -> None:
        """Take up the next samples of a series."""
        known = self._before[series]
        both = np.concatenate([known, residual])
        most = min(self.sums.size, both.size)
        for lag in range(most):
            late = residual[max(0, lag - known.size) :]
            self.sums[lag] += late @ both[both.size - late.size - lag : both.size - lag]
        self.size += residual.size
        self._before[series] = both[-(self.sums.size - 1) :]


def autoregression(lags: Lags) -> tuple[Array, float]:
    """Weights a, from 1, and variance of e in sum_i a_i r[k - i] = e[k], from the equations of Yule and Walker,
    solved order by order (Durbin 1960). The order is that of the least AIC (Akaike 1974), 10 log10 of the number of
    samples at most."""
    size, lagged = lags.size, lags.sums / lags.size
    most = min(size - 1, int(10 * np.log10(size)), lagged.size - 1)
    weights, variance = np.ones(1), float(lagged[0])
    best, least = (weights, variance), 0.0
    for order in range(1, most + 1 if lagged[0] > 0 else 1):
        reflected = -float(weights @ lagged[order:0:-1]) / variance
        weights = np.append(weights, 0.0) + reflected * np.append(0.0, weights[::-1])
        variance *= 1 - reflected**2
        if not variance > 1e-12 * lagged[0]:
            break
        criterion = size * np.log(variance / lagged[0]) + 2 * order
        if criterion < least:
            best, least = (weights, variance), criterion
    return best
