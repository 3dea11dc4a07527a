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

OWN = "mechanics of each axis"  # the step after which axes without a response have a stiffness of their own
STIFFNESS = "stiffness"
REACH, TRIED = 30.0, 41  # times that of the measured axis, down and up; so many between


def with_own_mechanics(case: Case, first: Fit) -> tuple[Case, Fit] | None:
    """The case in which the stiffness of each axis without a response is free, and the fit as given in it, with these
    where a coupling would explain most; None where the job says something of them, and where none would explain most
    of the misfit."""
    free = own_stiffnesses(case)
    if not free:
        return None
    own = case.with_specs(free)
    problem, values = own.problem(first.effects, first.steps), first.values
    values |= {name: alike(first, name) for name in free}
    explained = 0.0
    for name in free:
        tried = values[name] * np.geomspace(1 / REACH, REACH, TRIED)
        inside = tried[(tried >= free[name].bounds[0]) & (tried <= free[name].bounds[1])]
        starts = [problem.unit_point(values | {name: stiffness}) for stiffness in inside]
        promised = [promise_of_coupling(own, fit_at(first.effects, problem, start)) for start in starts]
        explained = max(promised, default=0.0)
        values[name] = float(inside[int(np.argmax(promised))]) if explained else values[name]
    start = fit_at(first.effects, problem, problem.unit_point(values), first.converged)
    return (own, start) if explained >= DECISIVE else None


def promise_of_coupling(case: Case, fit: Fit) -> float:
    """The share of the misfit that a coupling would explain by its score."""
    scorer, words = scorer_of(case, fit), applicable(case, fit.effects)
    return max((scorer.score(word).explained for word in words if issubclass(blocks[word], Coupling)), default=0.0)


def own_stiffnesses(case: Case) -> dict[str, Widened]:
    """The stiffnesses of axes without a response of which the job says nothing, with their declared bounds."""
    first, found = case.records[0], dict[str, Widened]()
    silent = [axis for number, axis in enumerate(first.axes) if number not in first.measured]
    for axis, block in product(silent, blocks.chain(case.words)):
        plain = f"{block.name}.{STIFFNESS}"
        known = any(spec.value is not None for name, spec in case.specs.items() if name.endswith(plain))
        if hasattr(block, "at_mode") and not known and f"{axis}.{plain}" not in case.specs:
            found[f"{axis}.{plain}"] = Widened(block.parameters()[STIFFNESS].bounds)
    return found


def alike(fit: Fit, name: str) -> float:
    """The stiffness of the measured axis after which an axis without a response is modelled."""
    _, _, plain = name.partition(".")
    values = {entry.name: value for entry, value in zip(fit.problem.model.entries, all_values(fit), strict=True)}
    return next(value for known, value in values.items() if known.endswith(plain))


def all_values(fit: Fit) -> list[float]:
    """All parameters of a fit, free or not."""
    return fit.problem.parameters(fit.point)[0].tolist()


def own_mechanics_sentence(case: Case, fit: Fit) -> str:
    """A sentence about each axis without a response whose stiffness a coupling shows; empty where there is none."""
    values = {name: value for name, value in fit.values.items() if name in own_stiffnesses(case)}
    return "".join(
        f" No response of {name.partition('.')[0]} is measured, and its mechanics are not those of the measured axis:"
        f" {name} is {value:.4g} N/m by what the coupling shows of it."
        for name, value in values.items()
    )
