"""How far the samples of a signal are off the lines through their neighbours, and how far drives kink."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

CLEAR = 12.0  # times what half of all samples do is beyond any noise


def off_line(signal: Array) -> Array:
    """How far each sample is off the line through its neighbours, and those at the ends off that through the next
    two."""
    inner = signal[1:-1] - (signal[:-2] + signal[2:]) / 2
    return np.concatenate([[signal[0] - 2 * signal[1] + signal[2]], inner, [signal[-1] - 2 * signal[-2] + signal[-3]]])


def kinked(signals: Array, spans: Array, around: int) -> Array:
    """How far signals, (signals, samples), are off the lines through their neighbours at most within so many samples,
    of their ranges, and beyond their noise."""
    sizes = np.abs([off_line(signal) for signal in signals])
    beyond = np.maximum(sizes - CLEAR * np.median(sizes, axis=1, keepdims=True), 0)
    most = (beyond / np.where(spans > 0, spans, 1)).max(axis=0)
    windows = np.lib.stride_tricks.sliding_window_view(np.pad(most, around), 2 * around + 1)
    return np.asarray(windows.max(axis=1))


def scatter(signal: Array) -> float:
    """How far half of the samples are off the lines through their neighbours: the noise of a smooth signal."""
    return float(np.median(np.abs(off_line(signal))))
