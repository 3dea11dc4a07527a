"""How much of a response no model can explain."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pzt_ident.record import Record

Array = NDArray[np.float64]


class Floor(NamedTuple):
    """Standard deviation of the noise, SI units, and what it was taken from."""

    value: float
    source: str


def noise_floor(records: list[Record], axis: int) -> Floor:
    """Noise of an axis, from the best evidence there is: rest segments, repeated periods, else the high frequencies.

    Never less than the quantiser's q / sqrt(12) where the response takes few values. The high-frequency part is weak
    evidence: it takes slow noise for signal and fast signal for noise.
    """
    signals = [(r.drive, r.response[axis], r.settle) for r in records]
    step = min((quantiser(y) for _, y, _ in signals), default=0.0)
    least = step / np.sqrt(12)
    for find, source in (
        (resting, "rest segments"),
        (repeated, "repeated periods"),
        (rough, "high frequencies (weak)"),
    ):
        found = [value for u, y, settle in signals for value in find(u[:, settle:], y[settle:])]
        if found:
            value = float(np.sqrt(np.mean(np.square(found))))
            return Floor(value, source) if value > least else Floor(least, "quantiser")
    return Floor(least, "quantiser")


def quantiser(response: Array) -> float:
    """Step of the quantiser, 0 where none shows: the values lie on a grid of at most a third as many points."""
    values = np.unique(response)
    if values.size < 2 or values.size > response.size / 3:
        return 0.0
    gaps = np.diff(values)
    step = float(gaps[gaps > 1e-6 * gaps.max()].min())
    whole = gaps / step
    return step if np.allclose(whole, np.round(whole), atol=0.05) else 0.0


def resting(drive: Array, response: Array, least: int = 100) -> list[float]:
    """Scatter about a quartic, which follows creep, in the last four fifths of every stretch of constant drive."""
    span = np.ptp(drive, axis=1, keepdims=True)
    still = (np.abs(np.diff(drive, axis=1)) <= 1e-6 * np.maximum(span, 1e-300)).all(axis=0)
    edges = np.flatnonzero(np.diff(np.concatenate([[0], still.astype(int), [0]])))
    found = []
    for first, last in zip(edges[::2], edges[1::2], strict=True):
        first += (last - first) // 5
        if last - first >= least:
            found.append(scatter(response[first:last], 4))
    return found


def repeated(drive: Array, response: Array, least: int = 3) -> list[float]:
    """Half the variance of the difference of successive periods, each about its own line."""
    period = period_of(drive)
    if not period or response.size < least * period:
        return []
    found = []
    for first in range(0, response.size - 2 * period + 1, period):
        change = response[first + period : first + 2 * period] - response[first : first + period]
        found.append(scatter(change, 1) / np.sqrt(2))
    return [float(np.median(found))]


def rough(drive: Array, response: Array) -> list[float]:
    """Third differences of white noise have twenty times its variance."""
    third = np.diff(response, 3)
    return [float(np.median(np.abs(third)) / 0.6745 / np.sqrt(20))] if third.size > 10 else []


def scatter(signal: Array, degree: int) -> float:
    x = np.linspace(-1, 1, signal.size)
    return float(np.std(signal - np.polynomial.Polynomial.fit(x, signal, degree)(x)))


def period_of(drive: Array, tolerance: float = 2e-3) -> int:
    """Samples after which every drive repeats, 0 where it does not: the first valley of the distance to itself."""
    span = np.ptp(drive, axis=1)
    moving = drive[span > 0]
    samples = drive.shape[1]
    if not moving.size or samples < 8:
        return 0
    scaled = moving / span[span > 0][:, None]
    size = 2 ** int(np.ceil(np.log2(2 * samples)))
    correlation = np.fft.irfft(np.abs(np.fft.rfft(scaled, size)) ** 2, size).sum(axis=0)
    power = np.concatenate([[0], np.cumsum((scaled**2).sum(axis=0))])
    lags = np.arange(1, samples // 2 + 1)
    apart = (power[-1] - power[lags] + power[samples - lags] - 2 * correlation[lags]) / (samples - lags)
    low = np.flatnonzero(apart < tolerance**2)
    risen = low[low > np.argmax(apart >= tolerance**2)] if apart.max() >= tolerance**2 else low[:0]
    if not risen.size:
        return 0
    valley = risen[: np.argmax(np.diff(risen, append=risen[-1] + 2) > 1) + 1]
    return int(lags[valley[np.argmin(apart[valley])]])
