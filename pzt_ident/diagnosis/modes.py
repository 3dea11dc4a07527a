"""The modes of a model's mechanics, and the same model with a mode elsewhere."""

from __future__ import annotations

from collections import ChainMap
from collections.abc import Collection, Iterable, Iterator

import numpy as np

from pzt_ident.diagnosis.fit import EDGE, Fit, fit_at
from pzt_ident.model.block import Modes, Place
from pzt_ident.model.modes import Mode, Values, modes_of, second_modes
from pzt_ident.model.registry import word_of

COARSE = 8.0  # samples a period: of faster modes the samples may show another one
SAME = 0.01  # of a frequency: closer ones are one
MAIN = 0.8  # of the static response: a mode that carries as much is the main one


def mechanics_at_main_mode(fit: Fit, kept: Collection[str] = ()) -> Values:
    """Parameters of an oscillator, by name, at the second mode that carries most of the response: that is the main one,
    and the oscillator rests elsewhere, where it stands in for something. Empty where there is none but one with a
    parameter that is kept, and where the mechanics cannot be put there."""
    values, moved = values_of(fit), Values()
    for mode in main_modes(fit, values, kept):
        moved |= oscillator_at(fit, values, mode)
    return moved


def mechanics_without_payload(fit: Fit, kept: Collection[str] = ()) -> Values:
    """Stiffness and damping, by name, with which mechanics whose mass is fixed, or has a bound below the whole, move as
    with a payload that is not kept: m x'' + b x' + k x = k f has the same solution for all three in proportion."""
    values, moved = values_of(fit), Values()
    most = dict(zip(fit.problem.names, fit.problem.upper.tolist(), strict=True))
    for entry in fit.problem.model.entries:
        block = entry.name.removesuffix(entry.word)
        mass = f"{block}mass"
        if entry.parameter.adds_to != "mass" or entry.name in kept or mass not in values:
            continue
        whole = values[mass] + values[entry.name]
        held = most.get(mass, values[mass])
        if held < whole:
            names = (f"{block}{word}" for word in ("damping", "stiffness"))
            moved |= {name: values[name] * held / whole for name in names if name in fit.values}
    return moved


def main_modes(fit: Fit, values: Values, kept: Collection[str]) -> Iterator[Mode]:
    """The second modes that carry MAIN of the response or more, but for those with a parameter that is kept."""
    for share, mode in second_modes(fit.problem.model, values):
        if share.name in fit.values and share.name not in kept and values[share.name] > MAIN * (1 - EDGE):
            yield mode


def mechanics_at_second_mode(fit: Fit, given: Fit) -> tuple[tuple[str, ...], Values]:
    """The effects of a fit without its second modes, and the parameters that the mechanics of another fit have with
    their nearest mode there; none where there is no second mode."""
    modes = [*second_modes(fit.problem.model, values_of(fit))]
    words = {share.block.name for share, _ in modes}
    moved = [nearest_mode_at(given, mode) for _, mode in modes]
    return tuple(item for item in fit.effects if word_of(item) not in words), dict(ChainMap(*moved))


def nearest_mode_at(fit: Fit, there: Mode) -> Values:
    """The free parameters of the mechanics with the nearest of their modes at a frequency and damping; of mechanics of
    each axis, that of its axis."""
    values = values_of(fit)
    own = [mode for mode in modes_of(fit.problem.model, values) if mode.number or mode.axis == there.axis]
    if not own:
        return {}
    nearest = min(own, key=lambda mode: abs(np.log(mode.frequency / there.frequency)))
    return mode_at(fit, values, nearest._replace(frequency=there.frequency, damping=there.damping))


def with_aliases(fit: Fit) -> list[Values]:
    """The parameters of a fit with one mode of its mechanics at another frequency of which the samples look alike: it
    may rest at any of these."""
    values = values_of(fit)
    return [
        point
        for mode in modes_of(fit.problem.model, values)
        for point in moved_to(fit, values, mode, aliases(fit, mode))
    ]


def with_modes_at_second(fit: Fit, kept: Collection[str]) -> list[Values]:
    """The parameters of a fit with one mode of its mechanics where a second mode is that is not kept, or at a frequency
    of which the samples look alike: the second mode may be that one, which rests elsewhere."""
    values, found = values_of(fit), list[Values]()
    for share, second in second_modes(fit.problem.model, values):
        for mode in modes_of(fit.problem.model, values) if share.name not in kept else ():
            moved = mode._replace(damping=second.damping)
            found += moved_to(fit, values, moved, [second.frequency, *aliases(fit, second)])
    return found


def with_modes_exchanged(fit: Fit) -> list[Fit]:
    """The fits with the main mode of an axis and a second one exchanged, where bounds allow it. The response is the
    same where they are in parallel; in another form of the second mode only one of the two may be it."""
    values, found = values_of(fit), list[Fit]()
    for share, second in second_modes(fit.problem.model, values):
        block = share.name.removesuffix("share")
        for main in modes_of(fit.problem.model, values):
            moved = mode_at(fit, values, main._replace(frequency=second.frequency, damping=second.damping))
            of_second = {"share": 1 - values[share.name], "frequency": main.frequency, "damping": main.damping}
            point = fit.values | moved | {f"{block}{word}": value for word, value in of_second.items()}
            if main.axis == second.axis and moved and is_within(fit, point):
                found.append(fit_at(fit.effects, fit.problem, fit.problem.unit_point(point), True, fit.measured_only))
    return found


def aliases(fit: Fit, mode: Mode) -> list[float]:
    """Other frequencies of which the samples look like one that has few samples a period in all records: f, r - f,
    r + f, 2 r - f for a rate r."""
    rate = max(1 / record.dt for record in fit.problem.records)
    least = abs(mode.frequency - round(mode.frequency / rate) * rate)
    alike = (least, rate - least, rate + least, 2 * rate - least) if COARSE * mode.frequency > rate else ()
    return [f for f in alike if f > 0 and abs(f - mode.frequency) > SAME * mode.frequency]


def moved_to(fit: Fit, values: Values, mode: Mode, frequencies: Iterable[float]) -> list[Values]:
    """The parameters of a fit with a mode at each of some frequencies, of those that its bounds allow."""
    moved = (mode_at(fit, values, mode._replace(frequency=frequency)) for frequency in frequencies)
    return [fit.values | point for point in moved if point and is_within(fit, point)]


def mode_at(fit: Fit, values: Values, mode: Mode) -> Values:
    """The parameters that a mode of the mechanics has."""
    if not mode.number:
        return oscillator_at(fit, values, mode)
    words = {f"frequency{mode.number}": mode.frequency, f"damping{mode.number}": mode.damping}
    entries = [entry for entry in fit.problem.model.entries if issubclass(entry.block, Modes)]
    return {entry.name: words[entry.word] for entry in entries if entry.word in words and entry.name in fit.values}


def oscillator_at(fit: Fit, values: Values, mode: Mode) -> Values:
    """The free parameters of the oscillator of an axis that has a mode."""
    moved, free = Values(), {*fit.problem.names}
    for entry in fit.problem.model.entries:
        if entry.axis == mode.axis and entry.block.place == Place.MECHANICS and hasattr(entry.block, "at_mode"):
            stiffness = stiffness_at(fit, values, entry.name.removesuffix(entry.word), mode.frequency)
            there = entry.block.at_mode(mode.frequency, mode.damping, stiffness)
            moved |= {entry.name: there[entry.word]} if entry.word in there and entry.name in free else {}
    return moved


def stiffness_at(fit: Fit, values: Values, block: str, frequency: float) -> float:
    """The stiffness with which a mass has a natural frequency, within its bounds; that of the block where it is no free
    parameter."""
    problem, name = fit.problem, f"{block}stiffness"
    if name not in problem.names:
        return values[name]
    place = problem.names.index(name)
    wanted = values[f"{block}mass"] * (2 * np.pi * frequency) ** 2
    return float(np.clip(wanted, problem.lower[place], problem.upper[place]))


def is_within(fit: Fit, point: Values) -> bool:
    """Whether parameters are within their bounds."""
    ends = zip(fit.problem.names, fit.problem.lower, fit.problem.upper, strict=True)
    return all(low <= point[name] <= high for name, low, high in ends if name in point)


def values_of(fit: Fit) -> Values:
    """All parameters of a fit by name, SI units."""
    return dict(zip(fit.problem.model.names, fit.problem.parameters(fit.point)[0].tolist(), strict=True))
