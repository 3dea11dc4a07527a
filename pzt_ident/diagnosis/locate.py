"""Where the misfit is: its share above the noise floor by record, branch, amplitude, rate, frequency and so on."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations_with_replacement

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.noise import Floor
from pzt_ident.data.record import Record
from pzt_ident.data.units import factor
from pzt_ident.diagnosis import wording
from pzt_ident.diagnosis.binning import Bin, Binning, Tally, by_frequency, by_line, tally
from pzt_ident.diagnosis.misfit import Crossing, Dominant, Misfit, Part, View
from pzt_ident.diagnosis.views import MOVING, binnings
from pzt_ident.diagnosis.worst_intervals import worst_intervals

Array = NDArray[np.float64]

CERTAIN = 4.0
"""Standard deviations of the mean square of white noise beyond which an excess is not chance."""
FLOOR_ERROR = 0.3
"""Relative error of the squared noise floor: coloured noise looks a tenth smaller in short rests than it is."""
EXCESS, LIFT = 0.15, 1.5
"""A dominant part has so much more of the misfit than of the samples, and so many times as much."""
CAMPAIGN = ("record", "amplitude", "rate")
"""Views in which the records of a campaign differ by design."""


def locate(records: Sequence[Record], residuals: Sequence[Array], floors: Sequence[Floor]) -> list[Misfit]:
    """Where each measured axis misfits.

    residuals: of each record, (measured axes, samples), SI units, offset removed. floors: one a measured axis.
    """
    return [
        of_axis(records, [part[i, r.settle :] for part, r in zip(residuals, records, strict=True)], axis, floors[i])
        for i, axis in enumerate(records[0].measured)
    ]


def of_axis(records: Sequence[Record], residuals: list[Array], axis: int, floor: Floor) -> Misfit:
    """`residuals` are those of the scored samples, (samples,) each."""
    unit = str(records[0].response_units[axis])
    parts = [part / factor(unit) for part in residuals]
    noise, samples = floor.value / factor(unit), sum(part.size for part in parts)
    square = float(np.square(np.concatenate(parts)).mean())
    excess = square - noise**2
    missing = excess if excess > noise**2 * max(FLOOR_ERROR, CERTAIN * np.sqrt(2 / samples)) else 0.0
    sorted_by = binnings(records, axis)
    spectral = [by_frequency(parts, [r.dt for r in records]), by_line(parts, [r.drive[:, r.settle :] for r in records])]
    tallies = [*(tally(binning, parts) for binning in sorted_by), *filter(None, spectral)]
    due = {binning.name: of_records(binning, parts, noise) for binning in sorted_by if binning.name not in CAMPAIGN}
    views = tuple(view(found, noise, samples, missing > 0, due.get(found.name)) for found in tallies)
    rmse, misfit = float(np.sqrt(square)), float(np.sqrt(missing))
    return Misfit(
        records[0].axes[axis],
        unit,
        samples,
        rmse,
        noise,
        floor.source,
        misfit,
        views,
        crossing(sorted_by, views, parts, noise) if missing else None,
        worst_intervals(records, parts, noise) if missing else (),
        tuple(wording.account(misfit, [found.dominant for found in views])),
    )


def view(found: Tally, noise: float, samples: int, missing: bool, due: Array | None) -> View:
    """`due`: the shares of the misfit that the bins would have from their records alone."""
    shares = shares_of(found.squares, found.counts, noise) if missing else np.zeros(found.counts.size)
    of_samples = found.counts / found.counts.sum()
    excess = found.squares - found.counts * noise**2
    with np.errstate(invalid="ignore"):
        rmse = np.sqrt(found.squares / (found.counts.sum() if found.name in wording.SPECTRAL else found.counts))
    bins = tuple(
        Part(*own, float(shares[k]), float(of_samples[k]), finite(rmse[k]), bool(excess[k] < 0))
        for k, own in enumerate(found.bins)
    )
    covers = float(found.counts.sum() / samples)
    most = dominant(found, shares, of_samples, of_samples if due is None else due, noise) if missing else None
    return View(found.name, found.unit, covers, bins, most)


def of_records(binning: Binning, residuals: list[Array], noise: float) -> Array:
    """Shares of the misfit in the bins, were the misfit of each record spread evenly over its samples."""
    squares = np.array([np.square(part).sum() for part in residuals])
    shares = shares_of(squares, np.array([part.size for part in residuals], dtype=np.float64), noise)
    counts = np.array([np.bincount(places, minlength=len(binning.bins)) / places.size for places in binning.places])
    return shares @ counts


def shares_of(squares: Array, counts: Array, noise: float) -> Array:
    """Shares of the excess over the noise, what is below it cut to 0; they sum to 1 unless all is below."""
    excess = np.maximum(squares - counts * noise**2, 0.0)
    return excess / (excess.sum() or 1.0)


def dominant(found: Tally, shares: Array, samples: Array, due: Array, noise: float) -> Dominant | None:
    """The sharpest run of neighbouring bins, where it is sharp enough, beyond chance, and not due to its records."""
    best = None
    for first, last in runs(found):
        own = slice(first, last + 1)
        share, part, count = float(shares[own].sum()), float(samples[own].sum()), float(found.counts[own].sum())
        fair = max(part, float(due[own].sum()))
        certain = found.squares[own].sum() - noise**2 * count > CERTAIN * noise**2 * np.sqrt(2 * count)
        if certain and share - fair >= EXCESS and share >= LIFT * fair:
            sharpness = divergence(np.array([share, 1 - share]), np.array([fair, 1 - fair]))
            if best is None or sharpness > best.sharpness + 1e-9:
                best = Dominant(first, last, share, part, sharpness, wording.sentence(found, first, last, share, part))
    return best


def runs(found: Tally) -> list[tuple[int, int]]:
    """First and last of every run of neighbouring bins, no end of it empty; bins without limits have no neighbours,
    but rising and falling are moving."""
    pairs = combinations_with_replacement(np.flatnonzero(found.counts).tolist(), 2)
    return [(i, j) for i, j in pairs if i == j or joined(found.bins[i : j + 1])]


def joined(bins: Sequence[Bin]) -> bool:
    return all(own.lower is not None for own in bins) or tuple(own.label for own in bins) == MOVING


def divergence(shares: Array, samples: Array) -> float:
    """sum of share ln(share / samples), nat."""
    known = (shares > 0) & (samples > 0)
    return float((shares[known] * np.log(shares[known] / samples[known])).sum())


def crossing(sorted_by: list[Binning], views: Sequence[View], residuals: list[Array], noise: float) -> Crossing | None:
    """The two views that tell most, crossed; None where fewer than two have more than one bin in use."""
    telling = [
        (divergence(np.array([b.share for b in own.bins]), np.array([b.samples for b in own.bins])), -place)
        for place, own in enumerate(views[: len(sorted_by)])
        if sum(b.samples > 0 for b in own.bins) > 1
    ]
    if len(telling) < 2:
        return None
    first, second = sorted(-place for _, place in sorted(telling, reverse=True)[:2])
    rows, columns = sorted_by[first], sorted_by[second]
    shape = (len(rows.bins), len(columns.bins))
    places = np.concatenate([a * shape[1] + b for a, b in zip(rows.places, columns.places, strict=True)])
    squares = np.bincount(places, np.square(np.concatenate(residuals)), shape[0] * shape[1]).astype(np.float64)
    counts = np.bincount(places, minlength=squares.size).astype(np.float64)
    shares = shares_of(squares, counts, noise).reshape(shape)
    with np.errstate(invalid="ignore"):
        rmse = np.sqrt(squares / counts).reshape(shape)
    return Crossing(
        rows.name,
        columns.name,
        tuple(own.label for own in rows.bins),
        tuple(own.label for own in columns.bins),
        tuple(tuple(map(finite, row)) for row in rmse),
        tuple(tuple(map(float, row)) for row in shares),
    )


def finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
