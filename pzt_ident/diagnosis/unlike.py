"""Axes without a response that are unlike the others: the staircase in which they have mechanics or hysteresis of their
own."""

from __future__ import annotations

from pzt_ident.diagnosis.accounts import reaches_farther, takes_fewer
from pzt_ident.diagnosis.budget import WHOLE
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.climb import Staircase
from pzt_ident.diagnosis.criteria import adequate
from pzt_ident.diagnosis.fit import Fit
from pzt_ident.diagnosis.paths import SETTLED, improve_within
from pzt_ident.diagnosis.step import Step, StepListener
from pzt_ident.diagnosis.unmeasured import (
    OWN,
    OWN_LOOPS,
    coupled,
    is_coupling,
    own_hysteresis,
    own_mechanics,
    with_own_hysteresis,
    with_own_mechanics,
)
from pzt_ident.diagnosis.verdict import Diagnosis

UNLIKE = "axes without a response that are unlike the others"


def own_at_once(case: Case, first: Fit, diagnosis: Diagnosis, on_step: StepListener) -> Staircase | None:
    """The staircase where axes without a response have a resonance of their own, if a coupling leads to the noise with
    that alone; None elsewhere, and where the best effect is no coupling, or one that leads there as it is."""
    best = diagnosis.best.fit if diagnosis.best else None
    settled = best and (adequate(case, first, best) or not is_coupling(best.effects[-1]))
    if settled or diagnosis.verdict in SETTLED or not own_mechanics(case):
        return None
    if not case.budget.allows(UNLIKE):
        return None
    found = with_own_mechanics(case, first)
    if found is None or not any(adequate(case, first, fit) for fit in coupled(*found)):
        return None
    return improve_with_own(first, *found, OWN, on_step)


def own_account(case: Case, first: Fit, given: Staircase, on_step: StepListener) -> Staircase | None:
    """The staircase where axes without a response have a resonance, or else a hysteresis, of their own, if that is the
    better account: of one that leads to the noise, if that takes other effects beside a coupling."""
    arrived = given.last.verdict == "adequate"
    added = given.end.effects[len(first.effects) :]
    tried = added if arrived else [step.added for step in given.steps if step.added]
    beside = any(map(is_coupling, tried))
    if arrived and not (beside and len(added) > 1):
        return None
    for change, free, alternative in (
        (OWN, own_mechanics(case), with_own_mechanics),
        (OWN_LOOPS, own_hysteresis(case, first) if beside else {}, with_own_hysteresis),
    ):
        if not free or not case.budget.allows(UNLIKE, WHOLE):
            continue
        if found := alternative(case, first):
            other = improve_with_own(first, *found, change, on_step)
            if takes_fewer(other, given, case) if arrived else reaches_farther(other, given):
                return other
    return None


def improve_with_own(first: Fit, own: Case, start: Fit, change: str, on_step: StepListener) -> Staircase:
    """The staircase in the case where these axes have something of their own. start: the fit of the model as given
    there. change: what they have."""
    return improve_within(own, [Step(first), Step(start, change=change, case=own)], on_step)
