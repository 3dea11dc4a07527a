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
from pzt_ident.diagnosis.binning import Bin, Binning, Tally, tally, tally_by_frequency, tally_by_harmonics
from pzt_ident.diagnosis.misfit import BinMisfit, CrossTable, DominantBins, Misfit, View
from pzt_ident.diagnosis.views import MOVING, binnings
from pzt_ident.diagnosis.worst_intervals import worst_intervals

Array = NDArray[np.float64]

CERTAIN = 4.0
"""Standard deviations of the mean square of white noise beyond which an excess is not chance."""
FLOOR_ERROR = 0.3
"""Relative error of the squared noise floor: coloured noise looks a tenth smaller in short rests than it is."""
EXCESS, LIFT = 0.15, 1.5
"""The share of the misfit in dominant bins less the share expected of them, and their ratio, are at least this."""
CAMPAIGN = ("record", "amplitude", "rate")
"""Views in which the records of a campaign differ by design."""


def locate(records: Sequence[Record], residuals: Sequence[Array], floors: Sequence[Floor]) -> list[Misfit]:
    """The misfit of each measured axis and where it is.

    residuals: of each record, (measured axes, samples), SI units, offset removed. floors: one per measured axis.
    """
    return [
        misfit_of(records, [part[i, r.settle :] for part, r in zip(residuals, records, strict=True)], axis, floors[i])
        for i, axis in enumerate(records[0].measured)
    ]


def misfit_of(records: Sequence[Record], residuals: list[Array], axis: int, floor: Floor) -> Misfit:
    """The misfit of one axis; residuals: of the scored samples, (samples,) each, SI units."""
    unit = str(records[0].response_units[axis])
    parts = [part / factor(unit) for part in residuals]
    noise, samples = floor.value / factor(unit), sum(part.size for part in parts)
    square = float(np.square(np.concatenate(parts)).mean())
    excess = square - noise**2
    squared_misfit = excess if excess > noise**2 * max(FLOOR_ERROR, CERTAIN * np.sqrt(2 / samples)) else 0.0
    sortings = binnings(records, axis)
    views = tuple(views_of(records, sortings, parts, noise, squared_misfit > 0))
    rmse, misfit = float(np.sqrt(square)), float(np.sqrt(squared_misfit))
    return Misfit(
        axis=records[0].axes[axis],
        unit=unit,
        samples=samples,
        rmse=rmse,
        noise_floor=noise,
        noise_source=floor.source,
        misfit=misfit,
        views=views,
        map=cross_table(sortings, views, parts, noise) if squared_misfit else None,
        worst=worst_intervals(records, parts, noise) if squared_misfit else (),
        sentences=tuple(wording.summary(misfit, [view.dominant for view in views])),
    )


def views_of(
    records: Sequence[Record], sortings: list[Binning], residuals: list[Array], noise: float, has_misfit: bool
) -> list[View]:
    """The misfit by each binning, in the order of the binnings, and then by the spectrum."""
    drives = [record.drive[:, record.settle :] for record in records]
    by_frequency = tally_by_frequency(residuals, [record.dt for record in records])
    by_harmonics = tally_by_harmonics(residuals, drives)
    tallies = [*(tally(binning, residuals) for binning in sortings), by_frequency]
    tallies += [by_harmonics] if by_harmonics else []
    expected = {
        binning.name: shares_by_record(binning, residuals, noise)
        for binning in sortings
        if binning.name not in CAMPAIGN
    }
    samples = sum(part.size for part in residuals)
    return [view_of(counted, noise, samples, has_misfit, expected.get(counted.name)) for counted in tallies]


def view_of(tally: Tally, noise: float, samples: int, has_misfit: bool, expected: Array | None) -> View:
    """expected: the shares of the misfit, (bins,), that the bins would have from their records alone, by default those
    of the samples."""
    shares = misfit_shares(tally.squares, tally.counts, noise) if has_misfit else np.zeros(tally.counts.size)
    sample_shares = tally.counts / tally.counts.sum()
    excess = tally.squares - tally.counts * noise**2
    with np.errstate(invalid="ignore"):
        rmse = np.sqrt(tally.squares / (tally.counts.sum() if tally.name in wording.SPECTRAL else tally.counts))
    bins = tuple(
        BinMisfit(*limits, float(shares[k]), float(sample_shares[k]), finite_or_none(rmse[k]), bool(excess[k] < 0))
        for k, limits in enumerate(tally.bins)
    )
    covers = float(tally.counts.sum() / samples)
    expected = sample_shares if expected is None else expected
    dominant = dominant_bins(tally, shares, sample_shares, expected, noise) if has_misfit else None
    return View(tally.name, tally.unit, covers, bins, dominant)


def shares_by_record(binning: Binning, residuals: list[Array], noise: float) -> Array:
    """Shares of the misfit in the bins, were the misfit of each record spread evenly over its samples: (bins,)."""
    squares = np.array([np.square(part).sum() for part in residuals])
    shares = misfit_shares(squares, np.array([part.size for part in residuals], dtype=np.float64), noise)
    counts = np.array([np.bincount(places, minlength=len(binning.bins)) / places.size for places in binning.places])
    return shares @ counts


def misfit_shares(squares: Array, counts: Array, noise: float) -> Array:
    """Shares of the excess over the noise, 0 for bins below the noise; they sum to 1 unless all bins are below it."""
    excess = np.maximum(squares - counts * noise**2, 0.0)
    return excess / (excess.sum() or 1.0)


def dominant_bins(tally: Tally, shares: Array, samples: Array, expected: Array, noise: float) -> DominantBins | None:
    """The sharpest run of neighbouring bins, where its excess is large enough, beyond chance, and not due to its
    records alone. shares, samples, expected: shares of the bins, (bins,)."""
    best = None
    for first, last in runs(tally):
        run = slice(first, last + 1)
        share, part, count = float(shares[run].sum()), float(samples[run].sum()), float(tally.counts[run].sum())
        usual = max(part, float(expected[run].sum()))
        certain = tally.squares[run].sum() - noise**2 * count > CERTAIN * noise**2 * np.sqrt(2 * count)
        if certain and share - usual >= EXCESS and share >= LIFT * usual:
            sharpness = divergence(np.array([share, 1 - share]), np.array([usual, 1 - usual]))
            if best is None or sharpness > best.sharpness + 1e-9:
                sentence = wording.dominant_sentence(tally, first, last, share, part)
                best = DominantBins(first, last, share, part, sharpness, sentence)
    return best


def runs(tally: Tally) -> list[tuple[int, int]]:
    """First and last index of every run of neighbouring bins with no empty bin at its ends."""
    pairs = combinations_with_replacement(np.flatnonzero(tally.counts).tolist(), 2)
    return [(i, j) for i, j in pairs if i == j or are_neighbours(tally.bins[i : j + 1])]


def are_neighbours(bins: Sequence[Bin]) -> bool:
    """Whether all bins have limits, or are the rising and the falling branch."""
    return all(item.lower is not None for item in bins) or tuple(item.label for item in bins) == MOVING


def divergence(shares: Array, samples: Array) -> float:
    """Kullback-Leibler divergence: sum of share ln(share / samples), nat."""
    known = (shares > 0) & (samples > 0)
    return float((shares[known] * np.log(shares[known] / samples[known])).sum())


def cross_table(
    sortings: list[Binning], views: Sequence[View], residuals: list[Array], noise: float
) -> CrossTable | None:
    """The misfit by the two binnings in which its shares differ most from those of the samples; None where fewer than
    two have more than one bin in use."""
    divergences = [
        (divergence(np.array([b.share for b in view.bins]), np.array([b.samples for b in view.bins])), -number)
        for number, view in enumerate(views[: len(sortings)])
        if sum(b.samples > 0 for b in view.bins) > 1
    ]
    if len(divergences) < 2:
        return None
    first, second = sorted(-number for _, number in sorted(divergences, reverse=True)[:2])
    rows, columns = sortings[first], sortings[second]
    shape = (len(rows.bins), len(columns.bins))
    places = np.concatenate(
        [a.astype(np.intp) * shape[1] + b for a, b in zip(rows.places, columns.places, strict=True)]
    )
    squares = np.bincount(places, np.square(np.concatenate(residuals)), shape[0] * shape[1]).astype(np.float64)
    counts = np.bincount(places, minlength=squares.size).astype(np.float64)
    shares = misfit_shares(squares, counts, noise).reshape(shape)
    with np.errstate(invalid="ignore"):
        rmse = np.sqrt(squares / counts).reshape(shape)
    return CrossTable(
        rows=rows.name,
        columns=columns.name,
        row_labels=tuple(row.label for row in rows.bins),
        column_labels=tuple(column.label for column in columns.bins),
        rmse=tuple(tuple(map(finite_or_none, row)) for row in rmse),
        share=tuple(tuple(map(float, row)) for row in shares),
    )


def finite_or_none(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
