"""The misfit of an axis, and its shares by what it can be told apart by."""

from __future__ import annotations

from dataclasses import dataclass

from pzt_ident.diagnosis.worst_intervals import Interval


@dataclass(frozen=True)
class Part:
    """A bin: its share of the misfit and of the samples, its RMSE (None where it is empty), and whether it is below
    the noise, so that its share was cut to 0. `lower` and `upper` are its limits where it has neighbours.

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
class Dominant:
    """The run of bins, `first` to `last`, that has most of the misfit for its samples. sharpness: Kullback-Leibler
    divergence of its share from what is due to it, nat (Kulldorff's scan statistic per unit of misfit)."""

    first: int
    last: int
    share: float
    samples: float
    sharpness: float
    sentence: str


@dataclass(frozen=True)
class View:
    """The misfit sorted by one thing; `covers` is the share of the scored samples that could be sorted so."""

    name: str
    unit: str
    covers: float
    bins: tuple[Part, ...]
    dominant: Dominant | None


@dataclass(frozen=True)
class Crossing:
    """Two views crossed: RMSE (None where empty) and share of the misfit, rows by columns."""

    rows: str
    columns: str
    row_labels: tuple[str, ...]
    column_labels: tuple[str, ...]
    rmse: tuple[tuple[float | None, ...], ...]
    share: tuple[tuple[float, ...], ...]


@dataclass(frozen=True)
class Misfit:
    """What the model of one axis leaves, over the scored samples of all records, in the user's unit:
    rmse^2 = noise_floor^2 + misfit^2; the misfit is 0 where the difference may be chance or an error of the floor."""

    axis: str
    unit: str
    samples: int
    rmse: float
    noise_floor: float
    noise_source: str
    misfit: float
    views: tuple[View, ...]
    map: Crossing | None
    worst: tuple[Interval, ...]
    sentences: tuple[str, ...]
