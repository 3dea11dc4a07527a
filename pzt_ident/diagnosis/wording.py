"""Sentences about where the misfit is."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from pzt_ident.diagnosis.binning import Bin, Tally
from pzt_ident.diagnosis.misfit import Dominant

SPECTRAL = ("frequency", "lines")


def sentence(found: Tally, first: int, last: int, share: float, samples: float) -> str:
    """`62 % of the misfit lies within 0.1 s after a reversal, which is 9 % of the samples.`"""
    whole = "bandwidth" if found.name in SPECTRAL else "samples"
    place = where(found.name, found.unit, found.bins, first, last)
    return f"{percent(share)} of the misfit lies {place}, which is {percent(samples)} of the {whole}."


def where(name: str, unit: str, bins: Sequence[Bin], first: int, last: int) -> str:
    """The place that a run of bins is, behind `lies`."""
    label = bins[first].label
    kind, _, other = name.partition(" of ")
    limits = span(bins, first, last, unit)
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
            return after(bins, first, last)
        case "cycle":
            begun, ended = int(bins[first].lower or 1), int(bins[last].upper or 1)
            return f"in cycle {begun}" if begun == ended else f"in cycles {begun} to {ended}"
        case "position":
            return f"at responses of {limits}"
        case "drive":
            return f"where the drive of {other} is {limits}"
        case "frequency":
            return f"at frequencies of {limits}" if bins[first].lower else f"below {bins[last].upper:.6g} {unit}"
    return f"in the {label} of the drive" if label.endswith("harmonics") and "between" not in label else f"{label}"


def span(bins: Sequence[Bin], first: int, last: int, unit: str) -> str:
    lower, upper = bins[first].lower, bins[last].upper
    return f"{lower:.6g} to {upper:.6g} {unit}".rstrip() if lower is not None else bins[first].label


def after(bins: Sequence[Bin], first: int, last: int) -> str:
    lower, upper = bins[first].lower, bins[last].upper
    if not lower:
        return f"within {seconds(upper)} after a reversal or stop"
    if last == len(bins) - 1:
        return f"later than {seconds(lower)} after a reversal or stop"
    return f"{seconds(lower)} to {seconds(upper)} after a reversal or stop"


def seconds(value: float | None) -> str:
    """`0.03 s`, `300 us`"""
    value = value or 0.0
    return f"{value:.6g} s" if value >= 1e-3 else f"{1e6 * value:.6g} us"


def percent(share: float) -> str:
    value = 100 * share
    if 99.5 <= value < 100:
        return "more than 99 %"
    return f"{value:.0f} %" if value >= 1 else f"{value:.1g} %" if value >= 0.01 else "less than 0.01 %"


def account(misfit: float, dominants: Iterable[Dominant | None]) -> list[str]:
    """The sentences of the dominant parts, the sharpest first and those of the spectrum last."""
    if not misfit:
        return ["Nothing is left above the noise."]
    found = [one for one in dominants if one]
    if not found:
        return ["No record, branch, amplitude, rate or band stands out: the misfit is spread evenly."]
    ranked = sorted(found, key=lambda one: ("bandwidth" in one.sentence, -one.sharpness))
    return list(dict.fromkeys(one.sentence for one in ranked))
