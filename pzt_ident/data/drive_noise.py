"""Noise of a recorded drive, which is no drive of the stage: hysteresis would count each of its reversals as a path."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

WINDOW, DEGREE = 16, 3  # samples, and the degree of the polynomial that a drive is in so many
REACH = 4.0  # standard deviations: what the drive must go back before it has turned
SMALL = 1e-2  # of the drive's span: what changes more from sample to sample is the drive itself
JITTER = 0.5  # of the steps of a remainder change sign where it is noise; two thirds in white noise


def noise_of_drive(drive: Array) -> float:
    """Standard deviation of the noise of a drive, (samples,): what cubics leave of most of its windows of 16 samples; 0
    where that is no noise, as of a drive that is faster."""
    windows = drive[: drive.size // WINDOW * WINDOW].reshape(-1, WINDOW)
    if not len(windows):
        return 0.0
    basis = np.linalg.qr(np.vander(np.linspace(-1, 1, WINDOW), DEGREE + 1))[0]
    left = windows - windows @ basis @ basis.T
    deviations = np.sqrt((left**2).sum(axis=1) / (WINDOW - DEGREE - 1))
    noise = float(np.median(deviations))
    near = left[deviations <= 2 * noise]
    turns = np.diff(np.sign(np.diff(near, axis=1)), axis=1) != 0
    return noise if noise < SMALL * np.ptp(drive) and turns.mean() > JITTER else 0.0


def without_noise(drive: Array) -> Array:
    """A drive, (samples,), that turns where the recorded one goes back by more than its noise: the mean of plays of
    that half-width, forwards and backwards, of which one is as late as the other is early."""
    reach = REACH * noise_of_drive(drive)
    return (followed(drive, reach) + followed(drive[::-1], reach)[::-1]) / 2 if reach else drive


def followed(drive: Array, reach: float) -> Array:
    """The play of a half-width behind a drive, p <- max(u - r, min(u + r, p)): (samples,)."""
    low, high, p = (drive - reach).tolist(), (drive + reach).tolist(), float(drive[0])
    path = [p := max(least, min(most, p)) for least, most in zip(low, high, strict=True)]
    return np.array(path)


def path_of(drive: Array) -> float:
    """The sum of all its steps."""
    return float(np.abs(np.diff(drive)).sum())
