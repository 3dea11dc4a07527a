"""Bounds of the job that may be too narrow: a cheaper account of a misfit than an effect."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.criteria import DECISIVE, adequate, removed_rms, removes_enough
from pzt_ident.diagnosis.fit import NO_WORSE, Fit, fit_at
from pzt_ident.diagnosis.misfit import share_explained
from pzt_ident.diagnosis.refit import SCANNED, refine_steps
from pzt_ident.diagnosis.ties import TIE
from pzt_ident.diagnosis.undetermined import undetermined_mechanics
from pzt_ident.model.chain import Entry
from pzt_ident.model.registry import word_of
from pzt_ident.search.descent import descend
from pzt_ident.search.problem import Problem

Array = NDArray[np.float64]

SLIP = 0.08  # of a bound, by which a data sheet may be beside the truth
FAR_SLIP = 0.3  # by which it may be where nothing else is missing
ON_THE_WAY = 0.2  # of the misfit, of which more than 1 - (1 - SLIP / FAR_SLIP)^2 is taken up if it is a parabola
DECADES = 100.0  # times a bound on a logarithmic scale that the job does not give: a guess of where a search begins
FOLLOWING = 3  # steps
BESIDE = 0.02  # of the range of such a guess: that close to its bound a fit is as good as on it


@dataclass(frozen=True)
class Widened:
    """A parameter specification with wider bounds, in the user's units."""

    bounds: tuple[float, float]
    value: None = None


def beyond_bounds(case: Case, first: Fit, fit: Fit) -> tuple[Case, Fit] | None:
    """The case with wider bounds where a fit rests on bounds of the job, and the fit in it, if that removes enough;
    None where it does not. Bounds that are still too narrow then are taken further if that leads to the noise, which it
    cannot where the first part of the way takes up little."""
    beyond = beyond_by(SLIP, case, fit)
    enough = beyond and (removes_enough(case, first, fit, beyond[1]) or are_decisive(case, fit, beyond[1]))
    near = beyond if enough else None
    leads_on = beyond is None or share_explained(fit.identify, beyond[1].identify, case.floor) >= ON_THE_WAY
    farther = leads_on and widened(case, fit, FAR_SLIP) and (near is None or stands_in(near[0], case, near[1]))
    far = beyond_by(FAR_SLIP, case, fit) if farther else None
    return far if far and adequate(case, first, far[1]) and not stands_in(far[0], case, far[1]) else near


def beyond_by(slip: float, case: Case, fit: Fit) -> tuple[Case, Fit] | None:
    """The case with bounds that are wider by a share of them, and a fit in it; None where it rests on none."""
    specs = widened(case, fit, slip) | freed(case, fit.problem)
    if not specs:
        return None
    key = (slip, fit.effects, fit.steps, fit.measured_only, fit.point.tobytes())
    if key not in case.wider:
        wide = case.with_specs(specs)
        case.wider[key] = wide, continued(wide, fit)
    return case.wider[key]


def are_decisive(case: Case, before: Fit, after: Fit) -> bool:
    """Whether wider bounds remove most of the misfit of the identification records, or most of that of an axis on all
    records together, which may be little beside what the other axis lacks."""
    axes = zip(before.by_axis.tolist(), after.by_axis.tolist(), case.floors.tolist(), strict=True)
    shares = [share_explained(*axis) for axis in axes]
    return max(share_explained(before.identify, after.identify, case.floor), *shares) >= DECISIVE


def are_too_narrow(case: Case, wide: Case, before: Fit, after: Fit) -> bool:
    """Whether bounds, beyond which a fit leaves clearly less, are too narrow, whatever else is missing: wider ones
    remove most of the misfit, or they are bounds of the job and none of them is reached, as one would be that makes up
    for something else."""
    of_the_job = (widened(case, before) | freed(case, before.problem)).keys() <= case.specs.keys()
    return are_decisive(case, before, after) or (of_the_job and not stands_in(wide, case, after))


def continued(wide: Case, fit: Fit) -> Fit:
    """A fit gone on with in a case with wider bounds."""
    problem = wide.problem(fit.effects, fit.steps, fit.measured_only)
    start = problem.unit_point(fixed_values(fit.problem) | fit.values)
    new = [i for i, name in enumerate(problem.names) if name not in fit.values]
    point = wide.descend(problem, scanned(wide, problem, start, new))
    return refine_steps(wide, fit_at(fit.effects, problem, point, fit.converged, fit.measured_only))


def scanned(case: Case, problem: Problem, point: Array, numbers: Iterable[int]) -> Array:
    """The point with each of some parameters where it leaves least, once the others follow by few steps."""
    for i in numbers:
        points = [np.where(np.arange(point.size) == i, share, point) for share in SCANNED]
        reached = [point, *(descend(problem, each, FOLLOWING, i, case.budget.lasts) for each in points)]
        point = reached[int(np.argmin(problem.loss(np.array(reached))))]
    return point


def stands_in(wide: Case, case: Case, fit: Fit) -> bool:
    """Whether a parameter rests on its wider bound too, and the model is clearly worse with it within the narrower
    ones: then it makes up for something else."""
    given, problem = case.problem(fit.effects, fit.steps, fit.measured_only), fit.problem
    ends = zip(given.lower.tolist(), given.upper.tolist(), strict=True)
    bounds, least = dict(zip(given.names, ends, strict=True)), TIE * case.floor

    def is_wider(i: int) -> bool:
        side = int(fit.point[i] >= 0.5)
        return bounds.get(problem.names[i], (None, None))[side] != (problem.lower, problem.upper)[side][i]

    def is_needed(i: int) -> bool:
        name = problem.names[i]
        return name not in bounds or removed_rms(loss_within(fit, {name: bounds[name]}), fit.identify) > least

    return any(rests(case, fit, i) and is_wider(i) and is_needed(i) for i in range(problem.dimensions))


def loss_within(fit: Fit, bounds: Mapping[str, tuple[float, float]]) -> float:
    """The loss of a fit with some parameters, by name, on the bounds beyond which they are."""
    inside = {name: float(np.clip(fit.values[name], low, high)) for name, (low, high) in bounds.items()}
    return float(fit.problem.loss(fit.problem.unit_point(fit.values | inside))[0])


def widened(case: Case, fit: Fit, slip: float = SLIP) -> dict[str, Widened]:
    """Wider bounds, by the names in the job, of the parameters that rest on one: of those that the job gives not beyond
    those declared, of others by DECADES or, of the amounts of effects, twice as far from the null, and none of
    mechanics that the data do not determine, which may stand in for anything slow."""
    problem, specs = fit.problem, dict[str, Widened]()
    resting = [i for i in range(problem.dimensions) if rests(case, fit, i)]
    undetermined = undetermined_mechanics(fit) if resting else None
    for i in resting:
        name = problem.names[i]
        entry, given = problem.model.entries[problem.free[i]], (float(problem.lower[i]), float(problem.upper[i]))
        key = given_name(case, fit, i)
        if room := roomier(case, fit, i):
            specs[name] = room
            continue
        if entry.block.name == undetermined or not (key or is_guessed(case, entry)):
            continue
        low, high = specs[key].bounds if key in specs else given
        if key is None:
            key, least, most = name, given[0] / DECADES, given[1] * DECADES
        else:
            declared = problem.declared_bounds(int(problem.free[i]))
            least = max(declared[0], given[0] - slip * abs(given[0]))
            most = min(declared[1], given[1] + slip * abs(given[1]))
        if fit.point[i] < 0.5:
            low = min(low, least)
        else:
            high = max(high, most)
        if (low, high) != given:
            specs[key] = Widened((float(low), float(high)))
    return specs


def freed(case: Case, problem: Problem) -> dict[str, Widened]:
    """The declared bounds of the parameters of the job's own model that are fixed at a guess of the catalogue, such as
    the reach of plays, and of which the job says nothing."""
    names = zip(problem.model.names, problem.model.entries, strict=True)
    columns = {name: column for column, (name, entry) in enumerate(names) if is_fixed_at_a_guess(case, problem, entry)}
    return {name: Widened(problem.declared_bounds(column)) for name, column in columns.items()}


def beyond_guesses(case: Case, problem: Problem, values: Mapping[str, float]) -> dict[str, Widened]:
    """Bounds wider by DECADES of the parameters that the job says nothing of, and of which a known value lies beyond
    those that the catalogue guesses."""
    specs = dict[str, Widened]()
    bounds = zip(problem.names, problem.free, problem.lower.tolist(), problem.upper.tolist(), strict=True)
    for name, column, low, high in bounds:
        entry, value = problem.model.entries[column], values.get(name, low)
        said = any(word in case.specs for word in problem.model.spellings(entry))
        if not low <= value <= high and is_guessed(case, entry) and not said:
            specs[name] = Widened((low / DECADES, high) if value < low else (low, high * DECADES))
    return specs


def is_fixed_at_a_guess(case: Case, problem: Problem, entry: Entry) -> bool:
    """Whether a parameter of the job's own model has a value of the catalogue, in units of the drive."""
    own = entry.block.name in map(word_of, case.words) and entry.axis in problem.model.measured
    said = any(word in case.specs for word in problem.model.spellings(entry))
    return own and not said and bool(entry.parameter.value) and entry.parameter.unit == "drive"


def fixed_values(problem: Problem) -> dict[str, float]:
    """The fixed parameters of a model, by name, in the user's units."""
    columns = (n for n in range(len(problem.model.entries)) if n not in {*problem.free, *problem.linear_columns})
    return {problem.model.names[column]: problem.range_of(column)[0] for column in columns}


def roomier(case: Case, fit: Fit, i: int) -> Widened | None:
    """Bounds twice as far from the null where a free parameter rests, if it is an amount of which the job says nothing
    and no limit is declared, and that has not the wrong sign: the catalogue only expects how large an effect is."""
    problem, at_low = fit.problem, fit.point[i] < 0.5
    parameter, low, high = problem.model.entries[problem.free[i]].parameter, problem.lower[i], problem.upper[i]
    if parameter.null is None or parameter.limit or given_name(case, fit, i):
        return None
    below, above = parameter.null - low, high - parameter.null
    if (below if at_low else above) < max(below, above):  # as far as noise may take it
        return None
    return Widened((float(low - below * at_low), float(high + above * (not at_low))))


def rests(case: Case, fit: Fit, i: int) -> bool:
    """Whether a free parameter is on a bound, or beside one that is a guess."""
    beside = min(fit.point[i], 1 - fit.point[i]) < BESIDE
    return fit.problem.names[i] in fit.on_bounds or (
        beside and not given_name(case, fit, i) and is_guessed(case, fit.problem.model.entries[fit.problem.free[i]])
    )


def given_name(case: Case, fit: Fit, i: int) -> str | None:
    """The name under which the job says something of a free parameter; None where it says nothing."""
    entry = fit.problem.model.entries[fit.problem.free[i]]
    return next((word for word in fit.problem.model.spellings(entry) if word in case.specs), None)


def is_guessed(case: Case, entry: Entry) -> bool:
    """Whether the declared bounds of a parameter of the job's own model are a guess of its order of magnitude: it has
    a dimension."""
    own = entry.block.name in map(word_of, case.words) and not entry.parameter.effects
    return own and entry.parameter.scale == "log" and entry.parameter.unit != "1" and entry.parameter.end is None


def bounds_that_changed(case: Case, fit: Fit) -> dict[str, tuple[float, float]]:
    """The bounds of a fit that are not those of the job, by the names in the job, in the user's units, and those of
    parameters that the model of the job does not have free."""
    problem, changed = fit.problem, {}
    for name, low, high, column in zip(problem.names, problem.lower, problem.upper, problem.free, strict=True):
        spellings = (name, *problem.model.spellings(problem.model.entries[column]))
        key = next((word for word in spellings if word in case.specs), None)
        given = case.specs[key].bounds if key else problem.declared_bounds(int(column))
        entry = problem.model.entries[column]
        is_new = key is None and (entry.axis not in problem.model.measured or entry.parameter.value is not None)
        if is_new or (given and tuple(given) != (low, high)):
            changed[key or name] = (float(low), float(high))
    return changed


def brought_back(case: Case, fit: Fit) -> Fit | None:
    """The fit of a case with wider bounds in the case as given; None where it is worse within the bounds there."""
    problem = case.problem(fit.effects, fit.steps, fit.measured_only)
    values = fit.values
    ends = zip(problem.names, problem.lower, problem.upper, strict=True)
    beyond = {name: (low, high) for name, low, high in ends if not low <= values[name] <= high}
    if freed_names(case, fit) or (beyond and not loss_within(fit, beyond) <= (1 + NO_WORSE) * fit.identify):
        return None
    return fit_at(fit.effects, problem, problem.unit_point(values), fit.converged, fit.measured_only)


def narrow_bounds_sentence(case: Case, fit: Fit) -> str:
    """A sentence about each parameter that lies beyond the bounds of the job; empty where none does."""
    given, text = case.problem(fit.effects, fit.steps, fit.measured_only), ""
    beyond = beyond_names(case, fit)
    for i, name in enumerate(given.names):
        if name not in beyond:
            continue
        value, bound = beyond[name]
        unit = f" {given.units[i]}".removesuffix(" 1")
        named = any(word in case.specs for word in given.model.spellings(given.model.entries[given.free[i]]))
        whose = "in the job, which is too narrow" if named else "by default: give it bounds in the job"
        text += f" {name} is {value:.4g}{unit}, beyond its bound of {bound:.4g}{unit} {whose}."
    return text + freed_sentence(case, fit)


def beyond_names(case: Case, fit: Fit) -> dict[str, tuple[float, float]]:
    """The value of each parameter that lies beyond the bounds of the job, by name, and the bound, in the user's
    units."""
    given = case.problem(fit.effects, fit.steps, fit.measured_only)
    ends = zip(given.names, given.lower.tolist(), given.upper.tolist(), strict=True)
    values = {name: (fit.values.get(name, low), low, high) for name, low, high in ends}  # what is left out is in them
    both = {name: (value, min(max(value, low), high)) for name, (value, low, high) in values.items()}
    return {name: (value, bound) for name, (value, bound) in both.items() if f"{value:.4g}" != f"{bound:.4g}"}


def freed_names(case: Case, fit: Fit) -> list[str]:
    """The parameters that a fit has free and the catalogue fixes by a guess."""
    return [name for name in freed(case, case.problem(fit.effects, fit.steps, fit.measured_only)) if name in fit.values]


def freed_sentence(case: Case, fit: Fit) -> str:
    """A sentence about each of these; empty where there is none."""
    guesses = fixed_values(case.problem(fit.effects, fit.steps, fit.measured_only))
    units, text = dict(zip(fit.problem.names, fit.problem.units, strict=True)), ""
    for name in freed_names(case, fit):
        unit = f" {units[name]}".removesuffix(" 1")
        text += f" {name} is {fit.values[name]:.4g}{unit}, not {guesses[name]:.4g}{unit} as by default: "
        text += "give it bounds in the job."
    return text
