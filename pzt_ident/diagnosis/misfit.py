"""The misfit of an axis, and its shares by record, branch, amplitude and so on."""

from __future__ import annotations

from dataclasses import dataclass

from pzt_ident.diagnosis.worst_intervals import Interval

LEAST = 0.3  # noise floors


@dataclass(frozen=True)
class BinMisfit:
    """A bin: its share of the misfit and of the samples, its RMSE (None where it is empty), and whether it is below
    the noise, where the share is 0. `lower` and `upper` are its limits where it has neighbours.

    Of the spectrum `samples` is the share of the bandwidth and `rmse` the part of the RMSE that lies in the band.
    """

    label: str
    lower: float | None
    upper: float | None
    share: float
    samples: float
    rmse: float | None
    below_noise: bool


@dataclass(frozen=True)
class DominantBins:
    """The run of bins, `first` to `last`, with the most misfit for its samples. sharpness: Kullback-Leibler divergence
    of its share of the misfit from the share expected of it, nat (Kulldorff's scan statistic per unit of misfit)."""

    first: int
    last: int
    share: float
    samples: float
    sharpness: float
    sentence: str


@dataclass(frozen=True)
class View:
    """The misfit by one quantity; `covers` is the share of the scored samples for which it is defined."""

    name: str
    unit: str
    covers: float
    bins: tuple[BinMisfit, ...]
    dominant: DominantBins | None


@dataclass(frozen=True)
class CrossTable:
    """The misfit by two quantities: RMSE (None where empty) and share of the misfit, rows by columns."""

    rows: str
    columns: str
    row_labels: tuple[str, ...]
    column_labels: tuple[str, ...]
    rmse: tuple[tuple[float | None, ...], ...]
    share: tuple[tuple[float, ...], ...]


@dataclass(frozen=True)
class Misfit:
    """The residual of one axis over the scored samples of all records, in the user's unit:
    rmse^2 = noise_floor^2 + misfit^2; the misfit is 0 where the difference may be chance or an error of the floor."""

    axis: str
    unit: str
    samples: int
    rmse: float
    noise_floor: float
    noise_source: str
    misfit: float
    views: tuple[View, ...]
    map: CrossTable | None
    worst: tuple[Interval, ...]
    sentences: tuple[str, ...]


def squared_misfit(rmse: float, floor: float) -> float:
    """Mean square above the noise floor, and at least that of 0.3 noise floors, which is the least that can be
    distinguished from noise."""
    return max(rmse**2 - floor**2, (LEAST * floor) ** 2)


def share_explained(before: float, after: float, floor: float) -> float:
    """Share of the misfit that is gone where the RMSE falls from `before` to `after`: 1 at the noise floor and below,
    negative where the error grew, 0 where there was none."""
    squared = squared_misfit(before, floor)
    return min((before**2 - after**2) / squared, 1.0) if squared > 0 else 0.0
