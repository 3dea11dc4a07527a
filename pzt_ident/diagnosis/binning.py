"""Samples and spectral lines sorted into bins, and the squared residual in each bin."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.periods import period_of

Array = NDArray[np.float64]
Indices = NDArray[Any]  # integers of any size


class Bin(NamedTuple):
    """A class of samples; one with limits has neighbours."""

    label: str
    lower: float | None = None
    upper: float | None = None


@dataclass(frozen=True, eq=False)
class Binning:
    """Every scored sample of every record in one of the bins: `places` has its bin's index, (samples,) per record, in
    as few bytes as hold it."""

    name: str
    unit: str
    bins: tuple[Bin, ...]
    places: list[Indices]

    @classmethod
    def of(cls, name: str, unit: str, bins: tuple[Bin, ...], places: Iterable[Indices]) -> Binning:
        kind = np.min_scalar_type(len(bins))
        return cls(name, unit, bins, [part.astype(kind) for part in places])


@dataclass(frozen=True, eq=False)
class Tally:
    """counts: samples, or degrees of freedom of the spectrum, in each bin; squares: sum of the squared residual."""

    name: str
    unit: str
    bins: tuple[Bin, ...]
    counts: Array
    squares: Array


def tally(binning: Binning, residuals: Sequence[Array]) -> Tally:
    size = len(binning.bins)
    places, squares = np.concatenate(binning.places), np.square(np.concatenate(residuals))
    counts = np.bincount(places, minlength=size).astype(float)
    sums = np.bincount(places, squares, size).astype(float)
    return Tally(binning.name, binning.unit, binning.bins, counts, sums)


def unordered_binning(name: str, labels: Sequence[str], places: Iterable[Indices]) -> Binning:
    """Bins without limits."""
    return Binning.of(name, "", tuple(map(Bin, labels)), places)


def linear_binning(name: str, unit: str, values: list[Array], from_zero: bool = False, bins: int = 6) -> Binning:
    """About `bins` even bins from the least value, or from zero, to the greatest. They are centred on multiples of a
    round number, so that round values are not on an edge."""
    low, high = min(map(np.min, values)), max(map(np.max, values))
    step = round_up((high if from_zero else high - low) / bins)
    first = np.round(low / step)
    count = int(np.round(high / step) - first) + 1
    edges = ((first - 0.5 + np.arange(count + 1)) * step).tolist()
    edges[0] = max(edges[0], 0.0) if low >= 0 else edges[0]
    places = (np.clip(np.round(part / step) - first, 0, count - 1) for part in values)
    return Binning.of(name, unit, bins_between(edges, unit), places)


def logarithmic_binning(name: str, unit: str, values: list[Array], low: float, zero_label: str = "") -> Binning:
    """Two bins per decade, with edges at 1 and 3, from `low`; smaller values are in the first. Where `zero_label` is
    given, zeros are in a bin of that name."""
    edges = half_decades(low, max(map(np.max, values)))
    places = (np.searchsorted(edges[1:-1], part, side="right") for part in values)
    bins = bins_between(edges, unit)
    if zero_label:
        zero = len(bins)
        places = (np.where(part > 0, place, zero) for place, part in zip(places, values, strict=True))
        bins = (*bins, Bin(zero_label))
    return Binning.of(name, unit, bins, places)


def doubling_binning(name: str, values: list[Indices]) -> Binning:
    """Integers from 1: 1, 2, 3 to 4, 5 to 8, ..."""
    count = int(np.ceil(np.log2(max(map(np.max, values))))) + 1
    lasts = 2 ** np.arange(count)
    bins = tuple(
        Bin(f"{first} to {last}" if first < last else f"{last}", float(first), float(last))
        for first, last in zip([1, *(lasts[:-1] + 1).tolist()], lasts.tolist(), strict=True)
    )
    return Binning.of(name, "", bins, (np.searchsorted(lasts, part) for part in values))


def half_decades(low: float, high: float) -> list[float]:
    """0, and the powers of ten and three times those from above `low` to the first that is not below `high`."""
    if not 0 < low < high:
        return [0.0, high or 1.0]
    powers = np.arange(np.floor(np.log10(low)), np.ceil(np.log10(high)) + 1)
    steps = np.array([float(f"{digit}e{power:.0f}") for power in powers for digit in (1, 3)])
    return [0.0, *steps[(steps > low) & (steps < high)].tolist(), float(steps[steps >= high][0])]


def bins_between(edges: Sequence[float], unit: str) -> tuple[Bin, ...]:
    return tuple(Bin(f"{low:.6g} to {high:.6g} {unit}".rstrip(), low, high) for low, high in pairwise(edges))


def round_up(value: float) -> float:
    """1, 2 or 5 times a power of ten, not below the value."""
    if not value > 0:
        return 1.0
    power = 10.0 ** np.floor(np.log10(value))
    return float(power * next(digit for digit in (1, 2, 5, 10) if digit * power >= value * (1 - 1e-9)))


def power_spectrum(residual: Array) -> tuple[Array, Array]:
    """Sum of squares at each line of the spectrum, and its degrees of freedom, (lines,): their sums are the sum of
    squares and the number of the samples."""
    freedom = np.full(residual.size // 2 + 1, 2.0)
    freedom[0] = 1
    if residual.size % 2 == 0:
        freedom[-1] = 1
    return freedom * np.abs(np.fft.rfft(residual)) ** 2 / residual.size, freedom


def tally_by_frequency(residuals: Sequence[Array], sample_times: Sequence[float]) -> Tally:
    """The residual in frequency bands, two per decade; sample_times: s, of each record."""
    lowest = min(1 / (dt * part.size) for part, dt in zip(residuals, sample_times, strict=True))
    highest = max(0.5 / dt for dt in sample_times)
    edges = half_decades(max(lowest, 1e-5 * highest), highest)
    counts, squares = np.zeros(len(edges) - 1), np.zeros(len(edges) - 1)
    for part, dt in zip(residuals, sample_times, strict=True):
        energy, freedom = power_spectrum(part)
        places = np.searchsorted(edges[1:-1], np.fft.rfftfreq(part.size, dt), side="right")
        counts += np.bincount(places, freedom, counts.size)
        squares += np.bincount(places, energy, counts.size)
    return Tally("frequency", "Hz", bins_between(edges, "Hz"), counts, squares)


HARMONICS = ("odd harmonics", "even harmonics", "between the harmonics")


def tally_by_harmonics(residuals: Sequence[Array], drives: Sequence[Array]) -> Tally | None:
    """The residual at odd and even harmonics of the drive and between them, in the last complete periods of each record
    whose drives, (axes, samples), repeat; None where none does."""
    counts, squares = np.zeros(3), np.zeros(3)
    for residual, drive in zip(residuals, drives, strict=True):
        period = period_of(drive)
        cycles = residual.size // period if period >= 8 else 0
        if cycles < 2 or leaks(drive[:, -cycles * period :], cycles):
            continue
        energy, freedom = power_spectrum(residual[-cycles * period :])
        kinds = harmonic_kinds(energy.size, cycles)
        counts += np.bincount(kinds, freedom, 3)
        squares += np.bincount(kinds, energy, 3)
    return Tally("lines", "", tuple(map(Bin, HARMONICS)), counts, squares) if counts.any() else None


def harmonic_kinds(lines: int, cycles: int) -> Indices:
    """For each spectral line of so many cycles 0 at odd harmonics, 1 at even ones and at zero, 2 between: (lines,)."""
    harmonic, remainder = np.divmod(np.arange(lines), cycles)
    return np.where(remainder > 0, 2, np.where(harmonic % 2 == 1, 0, 1))


def leaks(drive: Array, cycles: int) -> bool:
    """Whether more than a hundredth of the drive's energy is between its harmonics, as where the period is not an
    integer number of samples."""
    energy = sum(power_spectrum(part - part.mean())[0] for part in drive)
    between = harmonic_kinds(energy.size, cycles) == 2  # type: ignore[union-attr]
    return bool(energy[between].sum() > 0.01 * energy.sum())  # type: ignore[index,union-attr]
