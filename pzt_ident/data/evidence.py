"""Estimates of the noise of a record from what should be still or the same again: rests and repeated periods."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.drive_noise import without_noise
from pzt_ident.data.periods import period_of
from pzt_ident.data.projections import (
    MOST_MEMORY,
    ROUNDING,
    deviation,
    expected_products,
    memory_of,
    without_lines,
)
from pzt_ident.data.quantiser import errors_of_readings
from pzt_ident.data.stretches import rests

Array = NDArray[np.float64]

QUIETEST = 0.25  # of all that is measured: as much as no ringing and no transient need have reached
LOUDER = 1.5  # times those: above that an estimate has more in it than noise
UNLIKE = 4.0  # times the quietest one: that far apart they have more than noise in them
DECAY = 2.0  # of the variance between the halves of a rest: more is a transient, and the later half is taken
SHAPED = 64  # samples: of shorter periods the changes of their shape would take too much
FARTHEST = 4.0  # standard deviations of an estimate, by which it may be above the quieter ones of the same noise
AS_LOUD = 1.25  # times those: the noise of a sensor may be as much larger elsewhere in its range
FEWEST = 0.05  # of all that is measured: less, which is quieter than the rest, may be a reading that hung
LONG, SHORT = 100, 24  # samples of a rest in which lines are told from noise, and of those that count together
ROUNDS = 3  # in which rests that are of the noise alone are told from others
MISMATCH = 0.5  # of the noise: more may not come from periods that are no whole number of samples


def quiet(deviations: Array, seconds: Array) -> NDArray[np.bool_]:
    """Which estimates are up to LOUDER times the one that the QUIETEST share of the seconds stays below."""
    order = np.argsort(deviations)
    measured = np.cumsum(seconds[order])
    return deviations <= LOUDER * deviations[order][np.searchsorted(measured, QUIETEST * measured[-1])]


def quiet_deviation(deviations: Array, seconds: Array) -> float:
    """Root mean square of the quiet estimates, weighed by their seconds."""
    kept = quiet(deviations, seconds)
    return mean_deviation(deviations[kept], seconds[kept])


def mean_deviation(deviations: Array, weights: Array) -> float:
    """Root mean square of estimates of one noise."""
    return float(np.sqrt(np.average(deviations**2, weights=weights)))


def alike(deviations: Array, seconds: Array) -> bool:
    """Whether the quiet estimates may be of one noise."""
    kept = deviations[quiet(deviations, seconds)]
    return bool(kept.max() <= UNLIKE * kept.min())


class Estimate(NamedTuple):
    """Standard deviation of noise, the number of samples that it is of, and its own relative standard deviation."""

    value: float
    samples: int
    spread: float


def of_one_noise(values: Array, seconds: Array, spreads: Array) -> NDArray[np.bool_]:
    """Which estimates are of the noise alone: from the quietest on those that are no farther above the quieter ones
    than these leave open, which are no less than FEWEST of all, and what is up to AS_LOUD times those. What a stage
    adds, such as ringing, is louder."""
    order, least = np.argsort(values), FEWEST * seconds.sum()
    skipped = np.searchsorted(np.cumsum(seconds[order]), least)
    groups = [with_quieter(order[begin:], values, spreads) for begin in range(skipped + 1)]
    core = next((group for group in groups if seconds[group].sum() > least), groups[0])
    level = mean_deviation(values[core], seconds[core])
    return (values >= values[core[0]]) & (values <= max(AS_LOUD * level, values[core[-1]]))


def with_quieter(order: NDArray[np.int_], values: Array, spreads: Array) -> NDArray[np.int_]:
    """The first of some estimates in rising order, and those after it that may be of the same noise."""
    for last in range(1, order.size):
        quieter, weights = order[:last], spreads[order[:last]] ** -2.0
        level = mean_deviation(values[quieter], weights)
        if values[order[last]] > level * (1 + FARTHEST * np.hypot(spreads[order[last]], weights.sum() ** -0.5)):
            return quieter
    return order


@dataclass(frozen=True)
class Rest:
    """What is left of a rest, and the orthonormal basis of what was taken off, (samples, columns)."""

    noise: Array
    basis: Array

    @cached_property
    def products(self) -> tuple[float, float]:
        """The sum of the squares, and that of the products of each sample and the next."""
        return float(self.noise @ self.noise), float(self.noise[1:] @ self.noise[:-1])

    @cached_property
    def memory(self) -> float:
        """That of its noise, as far as the rest shows it."""
        return common_memory([self])

    @property
    def is_short(self) -> bool:
        return self.noise.size < LONG

    def estimate(self, least: float = 0.0) -> Estimate:
        """The noise. least: the memory that it has at least if the rest is short."""
        memory = max(self.memory, least) if self.is_short else self.memory
        power = self.products[0]
        value = (power / expected_products(self.basis, memory)[0]) ** 0.5 if power else 0.0
        free = 2 * (self.noise.size - self.basis.shape[1]) * (1 - memory**2) / (1 + memory**2)
        return Estimate(value, self.noise.size, free**-0.5)


def still_rests(drive: Array, response: Array) -> list[Rest]:
    """The last four fifths of each interval of a drive that is constant but for its noise, or less where these still
    settle, less a quartic, which follows creep, that noise, which a stage may follow, and the lines of mains and floor;
    none of a short rest in which the reading hangs."""
    found = []
    for first, last in rests(np.array([without_noise(row) for row in drive])):
        first += (last - first) // 5
        if last - first >= SHORT and (last - first >= LONG or np.ptp(response[first:last]) > 0):
            noisy = [row[first:last] for row in drive if np.ptp(row[first:last]) > 0]
            rest = Rest(*settled(response[first:last], noisy))
            if rest.memory < MOST_MEMORY:  # what rings or settles is more alike from sample to sample
                found.append(rest)
    return found


def common_memory(found: Sequence[Rest]) -> float:
    """The memory of the noise of rests; zero where nothing is left of them."""
    power, alike = np.sum([rest.products for rest in found], axis=0)
    return memory_of(alike / power, *(rest.basis for rest in found)) if power > 0 else 0.0


def rest_noise(found: Sequence[Rest], seconds: Array, step: float) -> list[Estimate]:
    """The noise of each rest. Short ones have the memory of those that are of the noise alone: they show less of it,
    and noise with a memory is quieter in them."""

    def alone(estimates: list[Estimate]) -> NDArray[np.bool_]:
        values, spreads = np.array([(part.value, part.spread) for part in estimates]).T
        return of_one_noise(errors_of_readings(values, seconds, step), seconds, spreads)

    if not any(rest.is_short for rest in found):
        return [rest.estimate() for rest in found]
    estimates, memory = [rest.estimate(common_memory(found)) for rest in found], 0.0
    if alone(estimates).all():
        return estimates
    for _ in range(ROUNDS):
        estimates = [rest.estimate(memory) for rest in found]
        kept = [rest for rest, is_noise in zip(found, alone(estimates), strict=True) if is_noise]
        memory = max(memory, common_memory(kept))
    return [rest.estimate(memory) for rest in found]


def settled(signal: Array, followed: Sequence[Array] = ()) -> tuple[Array, Array]:
    """A signal less a quartic, what it follows and lines, and their basis: of its later half, and so on, while the
    earlier one has DECAY times its variance."""
    noise, basis = without_lines(signal, 4, followed)
    half = noise.size // 2
    if half >= LONG and np.var(noise[:half]) > DECAY * np.var(noise[half:]):
        return settled(signal[half:], [row[half:] for row in followed])
    return noise, basis


def period_noise(drive: Array, response: Array, least: int = 3) -> list[Estimate]:
    """The noise of a periodic record: half the variance of the difference of successive periods, less its straight
    line, what a change of gain makes of it and lines of the mains, of the quiet ones. None where the drive repeats so
    roughly, as with periods of no whole number of samples, that the response must too."""
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
    return [Estimate(quiet_part, response.size, (2 * response.size) ** -0.5)] if known else []


def shape_changes(shape: Array) -> list[Array]:
    """What is added to a period y(t) to first order where its gain, its gain with time, its curvature or its delay
    changes: y, y t, y^2 and dy/dt."""
    scaled = (shape - shape.mean()) / max(float(np.ptp(shape)), 1e-300)
    return [scaled, scaled * np.linspace(-1, 1, shape.size), scaled**2, np.gradient(scaled)]
