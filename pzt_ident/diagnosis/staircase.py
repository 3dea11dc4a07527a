"""Which path leads from the model as given to the one with what it misses: with which blocks and bounds, and which
effect first."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pzt_ident.diagnosis.accounts import accounts, explains_fitted, keeps_within, outdoes
from pzt_ident.diagnosis.bounds import beyond_bounds, continued, widened
from pzt_ident.diagnosis.budget import WHOLE
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.climb import WIDER, Staircase
from pzt_ident.diagnosis.criteria import DECISIVE, adequate, near_noise, removed_rms
from pzt_ident.diagnosis.drive_noise import QUIET, quiet_behind, with_quiet_drives
from pzt_ident.diagnosis.drive_shape import better_as_usual, has_other, other_behind, way_of, with_other_drives
from pzt_ident.diagnosis.faults import AHEAD, fault_instead, fault_within_bounds
from pzt_ident.diagnosis.fit import Fit
from pzt_ident.diagnosis.history import BEFORE, at_rest, fits_at_rest, history_behind, with_history
from pzt_ident.diagnosis.judges import judged
from pzt_ident.diagnosis.lean import lean_or_begun, settles_for, steps_without
from pzt_ident.diagnosis.least_bounds import with_least_bounds
from pzt_ident.diagnosis.misfit import share_explained
from pzt_ident.diagnosis.paths import SETTLED, best_path, conclude, improve_within
from pzt_ident.diagnosis.refit import refit
from pzt_ident.diagnosis.scores import likeliest
from pzt_ident.diagnosis.step import Step, StepListener, explained_share
from pzt_ident.diagnosis.ties import TIE
from pzt_ident.diagnosis.undetermined import enough_without_mechanics
from pzt_ident.diagnosis.unlike import own_account, own_at_once
from pzt_ident.diagnosis.verdict import Diagnosis, diagnose
from pzt_ident.diagnosis.within_bounds import are_to_blame
from pzt_ident.model.registry import word_of

BESIDE = 4  # of the refits with one effect: those that are gone on with beyond the bounds of the job


def improve(case: Case, first: Fit, on_step: StepListener = lambda step: None) -> Staircase:
    """The staircase from the model as given to the one with all effects that are proven, judged by the records that can
    judge it."""
    if quiet := with_quiet_drives(case, first):
        return improve_otherwise(case, first, *quiet, QUIET, on_step)
    if other := with_other_drives(case, first):
        staircase = improve_otherwise(case, first, *other, way_of(case), on_step)
        if staircase.case is None or not better_as_usual(case.with_words(staircase.case.words), staircase.end):
            return staircase
        return best_path(case, [staircase, improve_as_usual(case, first, on_step)])
    return improve_as_usual(case, first, on_step)


def improve_as_usual(case: Case, first: Fit, on_step: StepListener) -> Staircase:
    """The same, with drives as they are unless the model with the best effect says otherwise."""
    good = adequate(case, first, first)
    wide = not good and needs_wider_bounds(case, first)
    if mended := None if good or (wide and is_within_wider_bounds(case, first)) else fault_instead(case, first, AHEAD):
        for step in mended.steps:
            on_step(step)
        return mended
    case.budget.begin_path()
    behind = None if good or wide or not has_other(case) else other_behind(case, first, likeliest(case, first))
    diagnosis = None if good or wide or behind else diagnose(case, first)
    if diagnosis and diagnosis.best:
        behind = other_behind(case, first, diagnosis.best.fit)
    if behind:
        return improve_otherwise(case, first, *behind, way_of(case), on_step)
    told = with_history(case, first, diagnosis) if diagnosis else None
    aged = improve_aged(case, first, *told, on_step) if told else None
    aged = None if aged and aged.last.verdict == "refused" else aged
    if aged and (aged.last.verdict in SETTLED or not case.budget.allows("records that start at rest", WHOLE)):
        return aged
    judging, fit = judged(case, first, diagnosis.fits if diagnosis else ())
    staircase = improve_judged(judging, fit, on_step, diagnosis if judging is case else None)
    if judging is not case:
        staircase.case = staircase.case or judging
    if aged is None and staircase.last.verdict not in SETTLED:
        later = history_behind(staircase.case or case, first, staircase.end)
        aged = improve_aged(case, first, *later, on_step) if later else None
    best = best_path(case, [staircase, aged]) if aged else staircase
    quiet = None if best.last.verdict in SETTLED else quiet_behind(case, first, best.case or case, best.end)
    return best_path(case, [best, improve_otherwise(case, first, *quiet, QUIET, on_step)]) if quiet else best


def with_least_history(case: Case, first: Fit, staircase: Staircase) -> Staircase:
    """The staircase whose records start from rest, where its last model fits as well then, or with an effect in the
    place of what was before."""
    end, rested = staircase.end, at_rest(staircase.case or case)
    fits = (fit for fit in fits_at_rest(rested, end) if adequate(case, first, fit))
    kept = next((fit for fit in fits if removed_rms(fit.total, end.total) < TIE * case.floor), None)
    if kept is None:
        return staircase
    steps, home = list[Step](), case
    for step in staircase.steps:
        home = at_rest(step.case) if step.case else home
        if step.change != BEFORE:
            fit = refit(home, step.fit, step.fit.effects, {}) if steps else first
            share = explained_share(case, steps[-1].fit, fit) if steps else 0.0
            steps.append(replace(step, fit=fit, explained=share, case=step.case and home))
    for effect in kept.effects[len(end.effects) :]:
        steps.append(Step(kept, effect, None, {effect: kept}, explained_share(case, steps[-1].fit, kept)))
    as_given = rested.specs is case.specs and rested.records == case.records
    staircase = replace(staircase, steps=steps, case=None if as_given else rested)
    conclude(rested, first, staircase)
    return staircase


def needs_wider_bounds(case: Case, first: Fit) -> bool:
    """Whether bounds are too narrow for the model as given."""
    beyond = beyond_bounds(case, first, first)
    return bool(beyond and are_to_blame(case, beyond[0], first, beyond[1]))


def is_within_wider_bounds(case: Case, first: Fit) -> bool:
    """Whether nothing but bounds is missing of the model as given."""
    beyond = beyond_bounds(case, first, first)
    return bool(beyond and adequate(case, first, beyond[1]))


def improve_aged(case: Case, first: Fit, aged: Case, start: Fit, on_step: StepListener) -> Staircase:
    """The staircase where the model follows what was before the records, if it must."""
    return with_least_history(case, first, improve_otherwise(case, first, aged, start, BEFORE, on_step))


def improve_otherwise(case: Case, first: Fit, other: Case, start: Fit, change: str, on_step: StepListener) -> Staircase:
    """The staircase in another case than that of the first fit. start: the fit of the model as given there. change:
    what is other."""
    on_step(Step(first))
    staircase = improve(other, start, on_step)
    share = explained_share(case, first, start)
    staircase.steps[0] = replace(staircase.steps[0], explained=share, change=change, case=other)
    staircase.steps.insert(0, Step(first))
    staircase.case = staircase.case or other
    return staircase


def improve_judged(case: Case, first: Fit, on_step: StepListener, diagnosis: Diagnosis | None = None) -> Staircase:
    """The same, judged by all records that are left to judge it; diagnosis: of the first fit, if there is one.

    Wider bounds are tried first where those of the job are too narrow, or lead to the noise beside one effect;
    mechanics that the data do not determine are left out first where no effect beside them reaches the noise, unless
    the first path with them does and the one without them does not, and any where nothing is missing without them."""
    good = adequate(case, first, first)
    enough = None if good else enough_without_mechanics(case, first)
    if enough:
        return improve_within(enough[1], steps_without(case, first, *enough), on_step)
    beyond = None if good else beyond_bounds(case, first, first)
    wide = None
    if beyond and are_to_blame(case, beyond[0], first, beyond[1]):
        wide = improve_beyond(case, first, *beyond, on_step)
        if wide.last.faults or accounts(wide, case, first):
            return wide
        may_do = keeps_within(wide, case) or near_noise(case, first, wide.end)
        if may_do and not case.budget.allows("effects within the bounds of the job"):
            return wide
    diagnosis = diagnosis or diagnose(case, first)
    behind = fit_behind(case, first, diagnosis)
    if behind:
        return improve_judged(case, behind, on_step)
    beside = None if good or beyond else bounds_beside(case, first, diagnosis)
    if beside:
        beyond = beside[0], continued(beside[0], first)
        wide = improve_beyond(case, first, *beyond, on_step) if leads(case, first, beside[1]) else None
        if wide and accounts(wide, case, first):
            return wide
    if own := own_at_once(case, first, diagnosis, on_step):
        return own
    lean, begun = lean_or_begun(case, first, diagnosis, on_step)
    if lean and (lean.last.verdict == "adequate" or settles_for(case, first, lean)):
        return lean
    given = with_least_bounds(case, improve_within(case, [Step(first)], on_step, diagnosis, begun))
    if lean and given.last.verdict != "adequate" and lean.end.total < given.end.total:
        given = lean
    if own := own_account(case, first, given, on_step):
        return own
    if given.last.verdict == "adequate" or not beyond:
        return given
    if wide is None and case.budget.allows("wider bounds"):
        wide = improve_beyond(case, first, *beyond, on_step)
    return wide if wide and outdoes(wide, given, case, first) else given


def fit_behind(case: Case, first: Fit, diagnosis: Diagnosis) -> Fit | None:
    """The model as given where the best effect led to, if it fits as well there: an effect that only adds to parameters
    of its mechanics, as a payload to a mass, may have led out of a side minimum. None where it is needed."""
    best = diagnosis.best.fit if diagnosis.best else None
    if best is None or not only_adds(best):
        return None
    fit = refit(case, best, first.effects, {})
    return fit if removed_rms(fit.total, best.total) < TIE * case.floor else None


def only_adds(fit: Fit) -> bool:
    """Whether all parameters of the last effect of a fit are added to others."""
    word, entries = word_of(fit.effects[-1]), fit.problem.model.entries
    own = [item.parameter for item in entries if word in (item.block.name, item.parameter.effect_word)]
    return bool(own) and all(parameter.adds_to for parameter in own)


def leads(case: Case, first: Fit, fit: Fit) -> bool:
    """Whether a fit beyond bounds is worth a path of its own: it is adequate, or leaves what the identification records
    do not determine."""
    return adequate(case, first, fit) or explains_fitted(case, first, fit)


def bounds_beside(case: Case, first: Fit, diagnosis: Diagnosis) -> tuple[Case, Fit] | None:
    """The case with the wider bounds that the model with one effect needs, and the fit with it there; None where there
    are none. Only where no effect passes within the bounds of the job, or the one that is best on the identification
    records leaves there less than half of what the best that passes leaves; ahead of these, where they do not lead to
    the noise and none is there within but on bounds of the job, that of the next best, in any form, which is adequate
    beyond these, and clearly lower than those on them; of the best itself where two others are to be begun with."""
    fits = [fit for candidate in diagnosis.candidates for fit in candidate.refits.values()]
    passing = [candidate.fit.identify for candidate in diagnosis.passing if candidate.fit]
    ordered = sorted(fits, key=lambda fit: fit.identify) or [first]
    best = ordered[0]
    by_far = not passing or share_explained(min(passing), best.identify, case.floor) >= DECISIVE
    found = beyond_bounds(case, first, best) if by_far else None
    there = [fit for fit in fits if adequate(case, first, fit)]
    if (found and leads(case, first, found[1])) or any(not widened(case, fit).keys() & case.specs for fit in there):
        return found
    least = min((fit.total for fit in there), default=np.inf)
    two, own = diagnosis.account, {*best.effects} - {*first.effects}
    for fit in ordered[two is None or own <= {*two.effects} : BESIDE]:
        of_the_job = widened(case, fit).keys() <= case.specs.keys()
        beyond = beyond_bounds(case, first, fit) if of_the_job and case.budget.allows("wider bounds") else None
        if beyond and leads(case, first, beyond[1]) and removed_rms(least, beyond[1].total) > TIE * case.floor:
            return beyond
    return found


def improve_beyond(case: Case, first: Fit, wide: Case, start: Fit, on_step: StepListener) -> Staircase:
    """The staircase with wider bounds, whose model follows what was before the records, if it must."""
    steps = [Step(first), Step(start, explained=explained_share(case, first, start), change=WIDER, case=wide)]
    if mended := None if adequate(wide, first, start) else fault_instead(wide, start, AHEAD):
        beyond = replace(mended, steps=[*steps, *mended.steps[1:]], case=wide)
        staircase = fault_within_bounds(case, first, mended) or beyond
        for step in staircase.steps:
            on_step(step)
        return staircase
    diagnosis = diagnose(wide, start)
    told = None if diagnosis.verdict in SETTLED else with_history(wide, start, diagnosis)
    if told is None:
        return with_least_bounds(case, improve_within(wide, steps, on_step, diagnosis))
    on_step(steps[0])
    aged = improve_aged(wide, start, *told, on_step)
    return with_least_bounds(case, replace(aged, steps=[*steps, *aged.steps[1:]], case=aged.case or wide))
