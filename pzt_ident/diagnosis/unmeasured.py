"""Axes without a response: their mechanics are those of the first measured one, unless a coupling shows them."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import chain, product

import numpy as np

from pzt_ident.data.notation import listed
from pzt_ident.diagnosis.bounds import Widened
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.criteria import DECISIVE, NEAR, adequate
from pzt_ident.diagnosis.exchange import exchange_step, fits_in_place
from pzt_ident.diagnosis.fit import Fit, fit_at
from pzt_ident.diagnosis.misfit import share_explained
from pzt_ident.diagnosis.possible import applicable
from pzt_ident.diagnosis.refit import refit_from
from pzt_ident.diagnosis.score import scorer_of
from pzt_ident.diagnosis.step import Step, effects_without, explained_share
from pzt_ident.model.block import Coupling, Place
from pzt_ident.model.registry import blocks

OWN = "mechanics of each axis"  # the step after which axes without a response have a resonance of their own
OWN_LOOPS = "hysteresis of each axis"  # after which they have a hysteresis of their own, but for its gain
STIFFNESS, DAMPING = "stiffness", "damping"
REACH, TRIED = 30.0, 41  # times the stiffness of the measured axis, down and up; so many between


def with_own_mechanics(case: Case, first: Fit) -> tuple[Case, Fit] | None:
    """The case in which stiffness and damping of each axis without a response are free, and the fit as given in it,
    with these where a coupling would explain most; None where the job says what its stiffness is, and where no coupling
    would explain most of the misfit. It is found once."""
    key = first.effects, first.steps, first.point.tobytes()
    if key not in case.unlike:
        case.unlike[key] = found_mechanics(case, first)
    return case.unlike[key]


def found_mechanics(case: Case, first: Fit) -> tuple[Case, Fit] | None:
    """The same, sought."""
    free = own_mechanics(case)
    stiffnesses = [name for name in free if name.endswith(STIFFNESS)]
    own = case.with_specs(free)
    problem, values = own.problem(first.effects, first.steps), first.values
    values |= {name: alike(first, name) for name in free}
    explained = 0.0
    for name in stiffnesses:
        inside = resonances(values, name, free[name])
        fits = [fit_at(first.effects, problem, problem.unit_point(point)) for point in inside]
        promised = [promise_of_coupling(own, fit) for fit in fits]
        explained = max(promised, default=0.0)
        values = inside[int(np.argmax(promised))] if explained else values
    start = fit_at(first.effects, problem, problem.unit_point(values), first.converged)
    return (own, start) if explained >= DECISIVE else None


def coupled(case: Case, fit: Fit) -> Iterator[Fit]:
    """A fit with each coupling that a model can have, in its first form."""
    scorer = scorer_of(case, fit)
    for word in filter(is_coupling, applicable(case, fit.effects)):
        score = scorer.score(word)
        yield refit_from(case, fit, (*fit.effects, score.effect), score.guesses)


def is_coupling(effect: str) -> bool:
    """Whether an effect is one of another axis."""
    return issubclass(blocks[effect], Coupling)


def freed_mechanics(case: Case, fit: Fit) -> tuple[Case, Fit] | None:
    """The case in which stiffness and damping of each axis without a response are free, and a fit with a coupling gone
    on with in it, where that removes most of what it leaves; else None. Beside other effects a coupling may show what
    it does not show alone."""
    free = own_mechanics(case) if any(map(is_coupling, fit.effects)) else {}
    if not free:
        return None
    own = case.with_specs(free)
    problem = own.problem(fit.effects, fit.steps, fit.measured_only)
    values = fit.values | {name: alike(fit, name) for name in free}
    for name in (name for name in free if name.endswith(STIFFNESS)):
        inside = [values, *resonances(values, name, free[name])]
        losses = problem.loss(np.array([problem.unit_point(point) for point in inside]))
        values = inside[int(np.argmin(losses))]
    point = own.descend(problem, problem.unit_point(values))
    freed = fit_at(fit.effects, problem, point, fit.converged, fit.measured_only)
    return (own, freed) if share_explained(fit.total, freed.total, case.floor) >= DECISIVE else None


def mechanics_of_each_axis(case: Case, first: Fit, fit: Fit) -> list[Step]:
    """The steps to mechanics of their own of axes without a response, where that is most of what a coupling leaves, or
    of what another coupling leaves in its place."""
    if adequate(case, first, fit):
        return []
    for coupling in chain([fit], in_other_couplings(case, fit)):
        if freed := freed_mechanics(case, coupling):
            own, after = freed
            there = Step(after, explained=explained_share(case, coupling, after), change=OWN, case=own)
            gone = [effect for effect in fit.effects if effect not in coupling.effects]
            return [*(exchange_step(case, fit, coupling, effect) for effect in gone), there]
    return []


def in_other_couplings(case: Case, fit: Fit) -> Iterator[Fit]:
    """A fit near the noise of its records with another coupling in the place of one: which of them it is shows in the
    resonance of an axis, which such a fit may give to the others."""
    near = fit.identify <= NEAR * case.floor and bool(own_mechanics(case))
    for effect in filter(is_coupling, fit.effects if near else ()):
        others = applicable(case, effects_without(fit, effect))
        yield from fits_in_place(case, fit, effect, [word for word in others if is_coupling(word)])


def resonances(values: dict[str, float], name: str, free: Widened) -> list[dict[str, float]]:
    """Parameters with other stiffnesses within bounds, lower and higher ones."""
    tried = [resonant(values, name, factor) for factor in np.geomspace(1 / REACH, REACH, TRIED)]
    return [point for point in tried if free.bounds[0] <= point[name] <= free.bounds[1]]


def resonant(values: dict[str, float], name: str, factor: float) -> dict[str, float]:
    """Parameters with so many times a stiffness, at the same damping ratio."""
    damping = name.removesuffix(STIFFNESS) + DAMPING
    scaled = {damping: values[damping] * factor**0.5} if damping in values else {}
    return values | {name: values[name] * factor} | scaled


def promise_of_coupling(case: Case, fit: Fit) -> float:
    """The share of the misfit that a coupling would explain by its score."""
    scorer, words = scorer_of(case, fit), applicable(case, fit.effects)
    return max((scorer.score(word).explained for word in words if is_coupling(word)), default=0.0)


def own_mechanics(case: Case) -> dict[str, Widened]:
    """Stiffness and damping of axes without a response for which the job names no stiffness, with their declared
    bounds."""
    first, found = case.records[0], dict[str, Widened]()
    silent = [axis for number, axis in enumerate(first.axes) if number not in first.measured]
    for axis, block in product(silent, blocks.chain(case.words)):
        words = (STIFFNESS, DAMPING) if hasattr(block, "at_mode") else ()
        names = {f"{axis}.{block.name}.{word}": Widened(block.parameters()[word].bounds) for word in words}
        if f"{axis}.{block.name}.{STIFFNESS}" not in case.specs:
            found |= {name: bounds for name, bounds in names.items() if name not in case.specs}
    return found


def own_hysteresis(case: Case, first: Fit) -> dict[str, Widened]:
    """The shapes of the hysteresis of axes without a response, with the bounds that they have on the measured one."""
    ends = zip(first.problem.lower.tolist(), first.problem.upper.tolist(), strict=True)
    bounds = dict(zip(first.problem.names, ends, strict=True))
    return {name: Widened(bounds[like]) for name, like in loops_alike(case, first).items()}


def with_own_hysteresis(case: Case, first: Fit) -> tuple[Case, Fit]:
    """The case in which axes without a response have a hysteresis of their own, and the fit as given in it."""
    own = case.with_specs(own_hysteresis(case, first))
    problem, values = own.problem(first.effects, first.steps), first.values
    values |= {name: values[like] for name, like in loops_alike(case, first).items()}
    return own, fit_at(first.effects, problem, problem.unit_point(values), first.converged)


def loops_alike(case: Case, first: Fit) -> dict[str, str]:
    """The parameters of the hysteresis of axes without a response, and those of the first measured one which they have
    until a coupling shows them: what is free there, but for gains, which are the coupling's, and what each branch has.
    Only of axes with the same unit of the drive, and of which the job says nothing."""
    record, problem, found = case.records[0], first.problem, dict[str, str]()
    main = record.measured[0]
    silent = [
        axis
        for number, axis in enumerate(record.axes)
        if number not in record.measured and record.drive_units[number] == record.drive_units[main]
    ]
    for like, column in zip(problem.names, problem.free, strict=True):
        entry = problem.model.entries[column]
        shape = entry.parameter.unit != "response/drive" and entry.parameter.count is None
        if entry.block.place == Place.OPERATOR and entry.axis == main and shape:
            names = (f"{axis}.{entry.block.name}.{entry.word}" for axis in silent)
            found |= {name: like for name in names if name not in case.specs}
    return found


def alike(fit: Fit, name: str) -> float:
    """The parameter of the measured axis after which an axis without a response is modelled."""
    _, _, plain = name.partition(".")
    values = {entry.name: value for entry, value in zip(fit.problem.model.entries, all_values(fit), strict=True)}
    return next(value for known, value in values.items() if known.endswith(plain))


def all_values(fit: Fit) -> list[float]:
    """All parameters of a fit, free or not."""
    return fit.problem.parameters(fit.point)[0].tolist()


def own_mechanics_sentence(case: Case, fit: Fit) -> str:
    """A sentence about each axis without a response whose resonance a coupling shows; empty where there is none."""
    units, text = dict(zip(fit.problem.names, fit.problem.units, strict=True)), ""
    for name, value in fit.values.items():
        if name.endswith(STIFFNESS) and name in own_mechanics(case):
            text += (
                f" No response of {name.partition('.')[0]} is measured, and it does not resonate where the measured"
                f" axis does: {name} is {value:.4g} {units[name]} by what the coupling shows of it."
            )
    return text + own_hysteresis_sentence(case, fit)


def own_hysteresis_sentence(case: Case, fit: Fit) -> str:
    """A sentence about each axis without a response whose hysteresis a coupling shows; empty where there is none."""
    record, text = case.records[0], ""
    for number, axis in enumerate(record.axes):
        own = [name for name in fit.problem.names if name.startswith(f"{axis}.") and name not in case.specs]
        loops = [name for name in own if name in loops_alike(case, fit)]
        if number not in record.measured and loops:
            text += (
                f" No response of {axis} is measured, and its hysteresis is not that of the measured axis:"
                f" {listed(loops)} {'are' if len(loops) > 1 else 'is'} its own by what the coupling shows."
            )
    return text
