"""Estimates of the noise of a record from what should be still or the same again: rests and repeated periods."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.periods import period_of
from pzt_ident.data.projections import MOST_MEMORY, ROUNDING, deviation, memory_of, without_lines

Array = NDArray[np.float64]

QUIETEST = 0.25  # of all that is measured: as much as no ringing and no transient need have reached
LOUDER = 1.5  # times those: above that an estimate has more in it than noise
UNLIKE = 4.0  # times the quietest one: that far apart they have more than noise in them
DECAY = 2.0  # of the variance between the halves of a rest: more is a transient, and the later half is taken
SHAPED = 64  # samples: of shorter periods the changes of their shape would take too much
MISMATCH = 0.5  # of the noise: more may not come from periods that are no whole number of samples


def quiet(deviations: Array, seconds: Array) -> NDArray[np.bool_]:
    """Which estimates are up to LOUDER times the one that the QUIETEST share of the seconds stays below."""
    order = np.argsort(deviations)
    measured = np.cumsum(seconds[order])
    return deviations <= LOUDER * deviations[order][np.searchsorted(measured, QUIETEST * measured[-1])]


def quiet_deviation(deviations: Array, seconds: Array) -> float:
    """Root mean square of the quiet estimates, weighed by their seconds."""
    kept = quiet(deviations, seconds)
    return float(np.sqrt(np.average(deviations[kept] ** 2, weights=seconds[kept])))


def alike(deviations: Array, seconds: Array) -> bool:
    """Whether the quiet estimates may be of one noise."""
    kept = deviations[quiet(deviations, seconds)]
    return bool(kept.max() <= UNLIKE * kept.min())


def rest_noise(drive: Array, response: Array, least: int = 100) -> list[tuple[float, int]]:
    """Standard deviation and number of samples of each rest: the last four fifths of an interval of constant drive, or
    less where these still settle, less a quartic, which follows creep, and the lines of the mains and the floor."""
    span = np.ptp(drive, axis=1, keepdims=True)
    still = (np.abs(np.diff(drive, axis=1)) <= 1e-6 * np.maximum(span, 1e-300)).all(axis=0)
    edges = np.flatnonzero(np.diff(np.concatenate([[0], still.astype(int), [0]])))
    estimates = []
    for first, last in zip(edges[::2], edges[1::2], strict=True):
        first += (last - first) // 5
        if last - first >= least:
            noise, basis = settled(response[first:last], least)
            if not rings(noise, basis):
                estimates.append((deviation(noise, basis), noise.size))
    return estimates


def settled(signal: Array, least: int) -> tuple[Array, Array]:
    """A signal less a quartic and lines, and their basis: of its later half, and so on, while the earlier one has DECAY
    times its variance."""
    noise, basis = without_lines(signal, 4)
    half = noise.size // 2
    if half >= least and np.var(noise[:half]) > DECAY * np.var(noise[half:]):
        return settled(signal[half:], least)
    return noise, basis


def rings(noise: Array, basis: Array) -> bool:
    """Whether it is as alike from sample to sample as what settles or rings."""
    power = float(noise @ noise)
    return power > 0 and memory_of(float(noise[1:] @ noise[:-1]) / power, basis) >= MOST_MEMORY


def period_noise(drive: Array, response: Array, least: int = 3) -> list[tuple[float, int]]:
    """Standard deviation and number of samples of a periodic record: half the variance of the difference of successive
    periods, less its straight line, what a change of gain makes of it and lines of the mains, of the quiet ones. None
    where the drive repeats so roughly, as with periods of no whole number of samples, that the response must too."""
    period = period_of(drive)
    if not period or response.size < least * period:
        return []

    def changes(signal: Array) -> list[Array]:
        firsts = range(0, response.size - 2 * period + 1, period)
        return [signal[i + period : i + 2 * period] - signal[i : i + period] for i in firsts]

    whole = response[: response.size // period * period].reshape(-1, period)
    shapes = shape_changes(whole.mean(axis=0)) if period >= SHAPED else []
    parts = [deviation(*without_lines(change, 1, shapes)) for change in changes(response)]
    deviations = np.array(parts) / np.sqrt(2)
    quiet_part = quiet_deviation(deviations, np.ones(deviations.size))
    scaled = drive / np.maximum(np.ptp(drive, axis=1, keepdims=True), 1e-300)
    mismatch, span = max(float(np.median(np.std(changes(row), axis=1))) for row in scaled), np.ptp(response)
    known = mismatch * span <= max(MISMATCH * quiet_part, ROUNDING * span)
    return [(quiet_part, response.size)] if known else []


def shape_changes(shape: Array) -> list[Array]:
    """What is added to a period y(t) to first order where its gain, its gain with time, its curvature or its delay
    changes: y, y t, y^2 and dy/dt."""
    scaled = (shape - shape.mean()) / max(float(np.ptp(shape)), 1e-300)
    return [scaled, scaled * np.linspace(-1, 1, shape.size), scaled**2, np.gradient(scaled)]
