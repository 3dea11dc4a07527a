"""Axes without a response: their mechanics are those of the first measured one, unless a coupling shows them."""

from __future__ import annotations

from itertools import product

import numpy as np

from pzt_ident.diagnosis.bounds import Widened
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.criteria import DECISIVE
from pzt_ident.diagnosis.fit import Fit, fit_at
from pzt_ident.diagnosis.score import applicable, scorer_of
from pzt_ident.model.block import Coupling
from pzt_ident.model.registry import blocks

OWN = "mechanics of each axis"  # the step after which axes without a response have a resonance of their own
STIFFNESS, DAMPING = "stiffness", "damping"
REACH, TRIED = 30.0, 41  # times the stiffness of the measured axis, down and up; so many between


def with_own_mechanics(case: Case, first: Fit) -> tuple[Case, Fit] | None:
    """The case in which stiffness and damping of each axis without a response are free, and the fit as given in it,
    with these where a coupling would explain most; None where the job says what its stiffness is, and where no coupling
    would explain most of the misfit."""
    free = own_mechanics(case)
    stiffnesses = [name for name in free if name.endswith(STIFFNESS)]
    own = case.with_specs(free)
    problem, values = own.problem(first.effects, first.steps), first.values
    values |= {name: alike(first, name) for name in free}
    explained = 0.0
    for name in stiffnesses:
        tried = [resonant(values, name, factor) for factor in np.geomspace(1 / REACH, REACH, TRIED)]
        inside = [point for point in tried if free[name].bounds[0] <= point[name] <= free[name].bounds[1]]
        fits = [fit_at(first.effects, problem, problem.unit_point(point)) for point in inside]
        promised = [promise_of_coupling(own, fit) for fit in fits]
        explained = max(promised, default=0.0)
        values = inside[int(np.argmax(promised))] if explained else values
    start = fit_at(first.effects, problem, problem.unit_point(values), first.converged)
    return (own, start) if explained >= DECISIVE else None


def resonant(values: dict[str, float], name: str, factor: float) -> dict[str, float]:
    """Parameters with so many times a stiffness, at the same damping ratio."""
    damping = name.removesuffix(STIFFNESS) + DAMPING
    scaled = {damping: values[damping] * factor**0.5} if damping in values else {}
    return values | {name: values[name] * factor} | scaled


def promise_of_coupling(case: Case, fit: Fit) -> float:
    """The share of the misfit that a coupling would explain by its score."""
    scorer, words = scorer_of(case, fit), applicable(case, fit.effects)
    return max((scorer.score(word).explained for word in words if issubclass(blocks[word], Coupling)), default=0.0)


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
    return text
