"""The period of a drive."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def period_of(drive: Array, tolerance: float = 2e-3) -> int:
    """Samples after which every drive repeats, 0 where it does not: the first valley of the mean squared difference
    between the drive and itself delayed."""
    span = np.ptp(drive, axis=1)
    moving = drive[span > 0]
    samples = drive.shape[1]
    if not moving.size or samples < 8:
        return 0
    scaled = moving / span[span > 0][:, None]
    lags = np.arange(1, samples // 2 + 1)
    correlation = np.sum([correlation_of(part, lags.size + 1) for part in scaled], axis=0)
    power = np.concatenate([[0], np.cumsum((scaled**2).sum(axis=0))])
    distance = (power[-1] - power[lags] + power[samples - lags] - 2 * correlation[lags]) / (samples - lags)
    low = np.flatnonzero(distance < tolerance**2)
    risen = low[low > np.argmax(distance >= tolerance**2)] if distance.max() >= tolerance**2 else low[:0]
    if not risen.size:
        return 0
    valley = risen[: np.argmax(np.diff(risen, append=risen[-1] + 2) > 1) + 1]
    return int(lags[valley[np.argmin(distance[valley])]])


def correlation_of(signal: Array, lags: int) -> Array:
    """Sums of products of a signal with itself so many samples later, from lag 0 on: (lags,)."""
    least = signal.size + lags  # what is later than the end is zero
    power = 2 ** int(np.ceil(np.log2(least)))
    size = power if least > 3 * power // 4 else 3 * power // 4
    lines = np.fft.rfft(signal, size)
    return np.asarray(np.fft.irfft(lines.real**2 + lines.imag**2, size)[:lags])
