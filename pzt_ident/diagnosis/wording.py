"""Sentences about where the misfit is."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from pzt_ident.diagnosis.binning import Bin, Tally
from pzt_ident.diagnosis.misfit import DominantBins

SPECTRAL = ("frequency", "lines")


def dominant_sentence(tally: Tally, first: int, last: int, share: float, samples: float) -> str:
    """`62 % of the misfit lies within 0.1 s after a reversal, which is 9 % of the samples.`"""
    total = "bandwidth" if tally.name in SPECTRAL else "samples"
    location = location_phrase(tally.name, tally.unit, tally.bins, first, last)
    return f"{percent(share)} of the misfit lies {location}, which is {percent(samples)} of the {total}."


def location_phrase(quantity: str, unit: str, bins: Sequence[Bin], first: int, last: int) -> str:
    """Where a run of bins is: `in half cycles of 90 to 110 V peak to peak`."""
    label = bins[first].label
    kind, _, other = quantity.partition(" of ")
    limits = limits_phrase(bins, first, last, unit)
    match kind:
        case "record":
            return f"in record {label}"
        case "branch":
            drive = f"the drive of {other}" if other else "the drive"
            return f"where {drive} is {label if first == last else 'moving'}"
        case "amplitude":
            return f"in half cycles of {limits} peak to peak"
        case "rate":
            return "where the drive is holding" if bins[first].lower is None else f"where the drive moves at {limits}"
        case "time since reversal":
            return time_phrase(bins, first, last)
        case "cycle":
            start, end = int(bins[first].lower or 1), int(bins[last].upper or 1)
            return f"in cycle {start}" if start == end else f"in cycles {start} to {end}"
        case "position":
            return f"at responses of {limits}"
        case "drive":
            return f"where the drive of {other} is {limits}"
        case "frequency":
            return f"at frequencies of {limits}" if bins[first].lower else f"below {bins[last].upper:.6g} {unit}"
    return f"in the {label} of the drive" if label.endswith("harmonics") and "between" not in label else f"{label}"


def limits_phrase(bins: Sequence[Bin], first: int, last: int, unit: str) -> str:
    lower, upper = bins[first].lower, bins[last].upper
    return f"{lower:.6g} to {upper:.6g} {unit}".rstrip() if lower is not None else bins[first].label


def time_phrase(bins: Sequence[Bin], first: int, last: int) -> str:
    lower, upper = bins[first].lower, bins[last].upper
    if not lower:
        return f"within {duration(upper)} after a reversal or stop"
    if last == len(bins) - 1:
        return f"later than {duration(lower)} after a reversal or stop"
    return f"{duration(lower)} to {duration(upper)} after a reversal or stop"


def duration(value: float | None) -> str:
    """`0.03 s`, `300 us`"""
    value = value or 0.0
    return f"{value:.6g} s" if value >= 1e-3 else f"{1e6 * value:.6g} us"


def percent(share: float) -> str:
    value = 100 * share
    if 99.5 <= value < 100:
        return "more than 99 %"
    return f"{value:.0f} %" if value >= 1 else f"{value:.1g} %" if value >= 0.01 else "less than 0.01 %"


def summary(misfit: float, dominants: Iterable[DominantBins | None]) -> list[str]:
    """The sentences about the dominant bins, the sharpest first and those of the spectrum last."""
    if not misfit:
        return ["Nothing is left above the noise."]
    known = [dominant for dominant in dominants if dominant]
    if not known:
        return ["No record, branch, amplitude, rate or band stands out: the misfit is spread evenly."]
    ranked = sorted(known, key=lambda dominant: ("bandwidth" in dominant.sentence, -dominant.sharpness))
    return list(dict.fromkeys(dominant.sentence for dominant in ranked))
