"""Which of two accounts of a misfit, each of them a staircase, is the better one."""

from __future__ import annotations

from pzt_ident.diagnosis.bounds import stands_in
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.climb import Staircase
from pzt_ident.diagnosis.criteria import DECISIVE, NEARLY_ALL, near_noise, reaches_noise, removed_rms
from pzt_ident.diagnosis.fit import Fit
from pzt_ident.diagnosis.misfit import share_explained
from pzt_ident.diagnosis.ties import TIE


def outdoes(wide: Staircase, given: Staircase, case: Case, first: Fit) -> bool:
    """Whether wider bounds are the better account than those of the job, which do not lead to the noise: they do, even
    if one of them is reached, or lead farther."""
    arrived = wide.last.verdict == "adequate"
    return arrived or accounts(wide, case, first) or clearly_better(wide, given, case) or is_cheaper(wide, given, case)


def accounts(wide: Staircase, case: Case, first: Fit) -> bool:
    """Whether wider bounds lead near the noise, to a model in which none of them is reached."""
    return (near_noise(case, first, wide.end) or explains_fitted(case, first, wide.end)) and keeps_within(wide, case)


def explains_fitted(case: Case, first: Fit, fit: Fit) -> bool:
    """Whether a fit is at the noise of the identification records, and explains nearly all of the misfit of all: what
    is left of the others these do not determine."""
    return reaches_noise(case, first, fit) and share_explained(first.total, fit.total, case.floor) >= NEARLY_ALL


def clearly_better(wide: Staircase, given: Staircase, case: Case) -> bool:
    """Whether wider bounds, none of which is reached, remove most of what the staircase as given leaves."""
    share = share_explained(given.end.total, wide.end.total, case.floor)
    return share >= DECISIVE and keeps_within(wide, case)


def is_cheaper(wide: Staircase, given: Staircase, case: Case) -> bool:
    """Whether wider bounds, none of which is reached, lead as far with fewer effects."""
    return takes_fewer(wide, given, case) and keeps_within(wide, case)


def takes_fewer(other: Staircase, given: Staircase, case: Case) -> bool:
    """Whether another account leads as far with fewer effects."""
    as_far = removed_rms(other.end.total, given.end.total) < TIE * case.floor
    return as_far and len(other.end.effects) < len(given.end.effects)


def reaches_farther(other: Staircase, given: Staircase) -> bool:
    """Whether another account leads to the noise, or farther."""
    return other.last.verdict == "adequate" or other.end.total < given.end.total


def keeps_within(wide: Staircase, case: Case) -> bool:
    """Whether the last model reaches none of the wider bounds."""
    return wide.case is None or not stands_in(wide.case, case, wide.end)
