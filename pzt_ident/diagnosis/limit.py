"""What an effect is that ended in a limit, where another name fits it: on its bounds, at a harmonic of the drive, or of
another size in each record."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from pzt_ident.diagnosis.bounds import Widened, continued, roomier
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.fit import EDGE, NO_WORSE, Fit
from pzt_ident.diagnosis.spectral_line import harmonic_of_the_drive, has_few_periods, is_of_the_counts
from pzt_ident.diagnosis.unequal import differs_in_size
from pzt_ident.model.chain import Entry
from pzt_ident.model.parameter import SMALL
from pzt_ident.model.registry import blocks, word_of


def own_bounds(fit: Fit, effect: str) -> tuple[str, ...]:
    """The shapes of an effect, its parameters without a null, that ended on a bound or next to nothing on every axis
    and are felt there, and its amounts if they all did: what one axis shows is that of the effect."""
    own, amounts = own_entries(fit, effect), amounts_of(fit, effect)
    limits = {*fit.on_bounds, *small_shapes(fit)}
    shown = {entry.word for name, entry in own.items() if name not in amounts and name not in limits}
    shapes = [name for name, entry in own.items() if name not in amounts and entry.word not in shown]
    shapes = [name for name in shapes if is_felt(fit, name)]
    return (*shapes, *(sorted(amounts) if amounts <= {*fit.on_bounds} else ()))


def shapes_at_ends(fit: Fit, effect: str) -> list[str]:
    """The shapes of an effect that are on a bound, be it one at which their range ends of itself."""
    there = {name for name, edge in zip(fit.problem.names, fit.at_edges, strict=True) if edge}
    return [name for name in own_entries(fit, effect).keys() - amounts_of(fit, effect) if name in there]


def amounts_of(fit: Fit, effect: str) -> set[str]:
    """The free amounts of an effect, its parameters with a null."""
    return {name for name, entry in own_entries(fit, effect).items() if entry.parameter.null is not None}


def small_shapes(fit: Fit) -> list[str]:
    """The shapes that are next to nothing beside the amount by which they are judged."""
    values, entries = fit.values, entries_of(fit)
    amounts = {
        name: f"{name.removesuffix(entry.word)}{entry.parameter.small_to}"
        for name, entry in entries.items()
        if entry.parameter.small_to
    }
    return [name for name, amount in amounts.items() if values[name] <= SMALL * values.get(amount, 0.0)]


def settle_beyond(case: Case, fit: Fit, on_bounds: Collection[str]) -> bool:
    """Whether what ended on bounds are amounts which settle where these are twice as far from the null: an effect that
    is a little larger than the catalogue expects stands for nothing else."""
    rooms = {name: roomier(case, fit, fit.problem.names.index(name)) for name in on_bounds}
    specs = {name: room for name, room in rooms.items() if room}
    return specs.keys() == rooms.keys() and not {*on_bounds} & {*continued(case.with_specs(specs), fit).on_bounds}


def is_felt(fit: Fit, name: str) -> bool:
    """Whether the model is worse with a parameter in the middle of its range: that of a Stribeck velocity without
    stiction is not."""
    moved = np.where(np.array(fit.problem.names) == name, 0.5, fit.point)
    return not float(fit.problem.loss(moved)[0]) <= (1 + NO_WORSE) * fit.identify


def limit_of(fit: Fit, on_bounds: Collection[str]) -> str:
    """What an effect is whose shapes ended on these lower bounds, or whose amounts did on any, as it is declared; empty
    where nothing else."""
    entries, places = entries_of(fit), dict(zip(fit.problem.names, fit.point, strict=True))
    parameters = {name: entries[name].parameter for name in on_bounds}
    declared = [item.limit for name, item in parameters.items() if item.null is not None or places[name] < 0.5]
    return next(filter(None, declared), "")


def is_limited(fit: Fit) -> bool:
    """Whether the last effect of a fit is in a limit that is declared to be something else."""
    last = fit.effects[-1]
    on_bounds = own_bounds(fit, last)
    bounded = limit_of(fit, on_bounds) or excess_of(fit, last, on_bounds)
    return bool(bounded or harmonic_of(fit, last) or size_of(fit, last))


def excess_of(fit: Fit, effect: str, on_bounds: Collection[str]) -> str:
    """What an effect is of which a shape ended on a bound and an amount beyond what the catalogue expects; empty for
    any other."""
    amounts = amounts_of(fit, effect)
    return (
        "beyond the size that any such effect is expected to have"
        if {*on_bounds} - amounts and exceeded(fit, amounts)
        else ""
    )


def exceeded(fit: Fit, names: Collection[str]) -> list[str]:
    """Those of some free parameters of which a job says nothing that lie beyond the bounds which the catalogue
    declares."""
    return [name for name in names if is_beyond_declared(fit, fit.problem.names.index(name))]


def is_beyond_declared(fit: Fit, i: int) -> bool:
    """Whether a free parameter lies beyond the bounds that the catalogue declares, and the job gives it no others."""
    problem = fit.problem
    column, value = int(problem.free[i]), fit.values[problem.names[i]]
    words = problem.model.spellings(problem.model.entries[column])
    given = (problem.specs[word] for word in words if word in problem.specs)
    low, high = problem.declared_bounds(column)
    beside = EDGE * (high - low)
    return not low - beside <= value <= high + beside and all(isinstance(spec, Widened) for spec in given)


def harmonic_of(fit: Fit, effect: str) -> str:
    """What an effect is that is a line of the spectrum at a low harmonic of all drives, or at one over the counts of
    the sensor; empty for any other."""
    if order := harmonic_of_the_drive(fit, effect):
        return f"harmonic {order} of the drive, as a nonlinearity of the stage makes it"
    return "as short as the counts of the sensor, which are such a line" if is_of_the_counts(fit, effect) else ""


def curve_of(fit: Fit, effect: str) -> str:
    """What an effect is in a model that is not adequate, if it is a line of few periods in the stroke; empty for any
    other."""
    return "of few periods in the stroke, as what any bend leaves is" if has_few_periods(fit, effect) else ""


def size_of(fit: Fit, effect: str) -> str:
    """What an effect is whose size is another one in each record, though it is the device's; empty for any other."""
    return "of another size in each record, as the device is not" if differs_in_size(fit, effect) else ""


def own_entries(fit: Fit, effect: str) -> dict[str, Entry]:
    """The free parameters of an effect of a fit, by name."""
    word = word_of(effect)
    return {
        name: entry
        for name, entry in entries_of(fit).items()
        if word in (entry.block.name, entry.parameter.effect_word)
    }


def entries_of(fit: Fit) -> dict[str, Entry]:
    """The free parameters of a fit, by name."""
    problem = fit.problem
    return {name: problem.model.entries[column] for name, column in zip(problem.names, problem.free, strict=True)}


def differs_by_record(effect: str) -> bool:
    """Whether each record has its own amount of an effect."""
    return any(parameter.per_record for parameter in blocks[effect].parameters().values())
