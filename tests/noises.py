"""Noise, and records of it."""

import numpy as np
from scipy.signal import lfilter

from pzt_ident.data.record import Record


def record(drive, response, **more):
    return Record("r", "identify", 1e-3, np.atleast_2d(drive), np.atleast_2d(response), **more)


def rising(samples, rest=0):
    return np.concatenate([np.linspace(0, 100, samples), np.full(rest, 100.0)])


def white(samples, size=1.0, seed=0):
    return np.random.default_rng(seed).normal(0, size, samples)


def coloured(samples, memory, seed=0):
    """Noise of unit variance and of a memory of first order."""
    white_part = np.random.default_rng(seed).normal(0, np.sqrt(1 - memory**2), samples + 1000)
    return lfilter([1.0], [1.0, -memory], white_part)[1000:]
