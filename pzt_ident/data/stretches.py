"""Stretches of samples: where a condition holds, and where no drive moves."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

STILL = 1e-6  # of the range of a drive: what moves by no more from one sample to the next rests


def stretches(where: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Start and stop of each stretch of samples, (samples,), that are marked."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], where, [False]]).astype(np.int8)))
    return [(start, stop) for start, stop in edges.reshape(-1, 2).tolist()]


def rests(drives: NDArray[np.float64]) -> list[tuple[int, int]]:
    """First and last sample of each stretch in which no drive moves. drives: (axes, samples)."""
    spans = np.ptp(drives, axis=1, keepdims=True)
    still = np.abs(np.diff(drives, axis=1)) <= STILL * np.maximum(spans, np.finfo(float).tiny)
    return stretches(still.all(axis=0))
