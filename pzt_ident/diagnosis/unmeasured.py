"""Axes without a response: their mechanics are those of the first measured one, unless a coupling shows them."""

from __future__ import annotations

from itertools import product

from pzt_ident.diagnosis.bounds import Widened
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.criteria import DECISIVE
from pzt_ident.diagnosis.fit import Fit, fit_at
from pzt_ident.diagnosis.misfit import share_explained
from pzt_ident.diagnosis.verdict import Diagnosis
from pzt_ident.model.block import Coupling
from pzt_ident.model.registry import blocks

OWN = "mechanics of each axis"  # the step after which axes without a response have a stiffness of their own
STIFFNESS = "stiffness"


def with_own_mechanics(case: Case, first: Fit, diagnosis: Diagnosis) -> tuple[Case, Fit] | None:
    """The case in which the stiffness of each axis without a response is free, and the fit as given in it; None where
    the job says something of it, and where no coupling takes up most of the misfit of the identification records."""
    free = own_stiffnesses(case)
    if not free or not any(takes_up_most(case, first, fit) for fit in coupled(diagnosis)):
        return None
    own = case.with_specs(free)
    problem = own.problem(first.effects, first.steps)
    point = problem.unit_point(first.values | {name: alike(first, name) for name in free})
    return own, fit_at(first.effects, problem, point, first.converged)


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


def coupled(diagnosis: Diagnosis) -> list[Fit]:
    """The refits with a coupling."""
    couplings = [item for item in diagnosis.candidates if issubclass(blocks[item.score.effect], Coupling)]
    return [item.fit for item in couplings if item.fit]


def takes_up_most(case: Case, first: Fit, fit: Fit) -> bool:
    """Whether a fit leaves less than half of the misfit of the identification records."""
    return share_explained(first.identify, fit.identify, case.floor) >= DECISIVE


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
