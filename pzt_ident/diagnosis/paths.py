"""The best of the paths from a model to one with what it misses, within the blocks and bounds of a case."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from pzt_ident.diagnosis.accounts import explains_fitted
from pzt_ident.diagnosis.bounds import FAR_SLIP, SLIP, beyond_guesses, continued, freed, stands_in, widened
from pzt_ident.diagnosis.budget import PROVING, WHOLE
from pzt_ident.diagnosis.candidates import SHORTLIST, is_disturbance, refit_forms, shortlist_of
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.climb import WIDER, Staircase, climb
from pzt_ident.diagnosis.criteria import FAR, adequate, near_noise, removed_rms, removes_enough
from pzt_ident.diagnosis.damped import exchange_damped
from pzt_ident.diagnosis.exchange import (
    add_rivals_beside,
    drop_outdone_rivals,
    exchange_limits,
    find_rivals,
    remove_unneeded,
)
from pzt_ident.diagnosis.fit import Fit
from pzt_ident.diagnosis.forms import Candidate
from pzt_ident.diagnosis.proof import unproven
from pzt_ident.diagnosis.refit import refit, values_in
from pzt_ident.diagnosis.second_mode import exchange_main_mode, exchange_second_mode
from pzt_ident.diagnosis.step import Step, StepListener, effects_without, explained_share
from pzt_ident.diagnosis.suspect import Suspect
from pzt_ident.diagnosis.ties import TIE
from pzt_ident.diagnosis.verdict import Diagnosis, diagnose, unexplained
from pzt_ident.diagnosis.within_bounds import makes_up_for_known
from pzt_ident.model.registry import word_of

PATHS = 2  # of a model, which differ by the effect that is added first
FIRST_EFFECTS = 4  # effects that are tried as that one, for paths that do not join
FEW = 2  # effects: what more can do without is told from other starts, too: they may stand in for one
SETTLED = "adequate", "refused"
PROVEN = "back to what is proven"  # the step that goes back to an earlier one


class Begun(NamedTuple):
    """The path of the best first effect, and the diagnosis of the model that it is added to."""

    diagnosis: Diagnosis
    path: Staircase


def begin(case: Case, base: Sequence[Step], on_step: StepListener, diagnosis: Diagnosis | None = None) -> Begun:
    """The first path of a case, see `improve_within`, as far as it climbs."""
    diagnosis = diagnosis or diagnose(case, base[-1].fit)
    candidate = next(iter(first_candidates(case, base[-1].fit, diagnosis)), None)
    path = climb(case, base, diagnosis, candidate, on_step)
    assert path is not None  # there is none that it could join
    return Begun(diagnosis, path)


def improve_within(
    case: Case,
    base: Sequence[Step],
    on_step: StepListener,
    diagnosis: Diagnosis | None = None,
    begun: Begun | None = None,
) -> Staircase:
    """The staircase of a case, with its blocks and bounds. base: the steps to the model that effects are added to, the
    model as given first. diagnosis: of the last of them, where there is one; begun: the first path, likewise.

    Where the best first effect leads to no adequate model, another one is tried: the first may have stood in for
    something else. Both are then compared without the effects that they do not prove, unless the better one is adequate
    without these, too.
    """
    first = base[-1].fit
    diagnosis, path = begun or begin(case, base, on_step, diagnosis)
    paths, told = [path], None if begun else path
    for candidate in first_candidates(case, first, diagnosis)[1:]:
        last = paths[-1]
        far = last.end.identify / case.floor > FAR
        if last.last.verdict in SETTLED or far or len(paths) == PATHS or is_one_that_explains_all(case, first, last):
            break
        if not case.budget.allows("another effect first"):
            break
        known = [step.fit for other in paths for step in other.steps[len(base) :]]
        told = climb(case, base, diagnosis, candidate, on_step, known)
        paths += [told] if told else []
    if alone := alone_instead(case, first, diagnosis, paths[-1]):
        told = climb(case, base, diagnosis, alone, on_step)
        paths += [told] if told else []
    case.budget.begin_proof()
    climbed = {id(path): len(path.steps) for path in paths}
    doubts = finish_all(case, first, paths)
    best = best_path(case, [path for path, _ in doubts])
    for step in best.steps[climbed[id(best)] if best is told else 0 :]:  # another path than the last is told anew
        on_step(step)
    find_rivals(best.case or case, first, best.steps, on_step)
    for doubted in [fit for path, fit in doubts if path is best and fit]:
        add_rivals_beside(best.case or case, first, best.steps, doubted)
    conclude(best.case or case, first, best, diagnosis)
    return best


def alone_instead(case: Case, first: Fit, diagnosis: Diagnosis, path: Staircase) -> Candidate | None:
    """Of the effects that are to be refitted and were not, since two account for all, the best that does so alone."""
    if not is_adequate(path) or len(path.end.effects) < len(first.effects) + 2:
        return None
    waiting = [item for item in shortlist_of(case, first, first, diagnosis.candidates) if not item.refits]
    for item in waiting:
        if case.budget.allows("the refits of all candidates"):
            item.refits = refit_forms(case, first, (item.forms[0], item.score), path.end.identify)
    able = [item for item in waiting if item.refits and adequate(case, first, item.best)]
    best = min(able, key=lambda item: item.best.total, default=None)
    if best:
        best.take(best.best.effects[-1])
    return best


def is_one_that_explains_all(case: Case, first: Fit, path: Staircase) -> bool:
    """Whether a path has one effect, which explains all that the identification records tell."""
    return len(path.end.effects) == len(first.effects) + 1 and explains_fitted(case, first, path.end)


def finish_all(case: Case, first: Fit, paths: Sequence[Staircase]) -> list[tuple[Staircase, Fit | None]]:
    """Paths that are finished, the best first, up to one that is adequate then, with what `finish` returns of each."""
    finished, left = list[tuple[Staircase, Fit | None]](), [*paths]
    while left and not any(is_adequate(path) for path, _ in finished):
        path = best_path(case, left)
        left = [other for other in left if other is not path]
        finished.append((path, finish(path.case or case, first, path)))
    return finished


def finish(case: Case, first: Fit, path: Staircase) -> Fit | None:
    """Take back what a path can do without, or does not prove; see `take_back`. Its verdict is no longer that it is
    adequate where it is not without these. Mechanics that do not ring give way to a lag."""
    path.steps += exchange_main_mode(case, first, path.end)
    path.steps += exchange_second_mode(case, first, path.end)
    path.steps += exchange_limits(case, first, path.end)
    if wider := exchange_for_bounds(case, first, path.end):
        path.steps += wider
        path.case = case = wider[0].case or case
    doubted = take_back(case, first, path)
    if path.last.verdict == "adequate" and not adequate(case, first, path.end):
        path.last = replace(path.last, verdict="unexplained")
    if damped := exchange_damped(case, first, path.end):
        path.steps += damped[0]
        path.suspects = [*path.suspects, damped[1]]
        path.case = damped[0][0].case
    return doubted


def exchange_for_bounds(case: Case, first: Fit, now: Fit) -> list[Step]:
    """The steps to wider bounds and from the effect that made up for them, where a model near the noise, with the
    effect or without it, rests on bounds of the job, has a value that the catalogue guesses, or stands for one beyond
    its guess, and fits as well beyond these without one of its effects."""
    added = now.effects[len(first.effects) :]
    if not added or not near_noise(case, first, now):
        return []
    for effect in reversed(added):
        for wide, beyond in without_in_wider_bounds(case, now, effect):
            as_low = removed_rms(beyond.total, now.total) < TIE * case.floor
            if as_low and not stands_in(wide, case, beyond) and not makes_up_for_known(case, beyond, effect):
                both = continued(wide, now)
                return [
                    Step(both, explained=explained_share(case, now, both), change=WIDER, case=wide),
                    Step(beyond, None, effect, {}, explained_share(case, both, beyond)),
                ]
    return []


def without_in_wider_bounds(case: Case, now: Fit, effect: str) -> Iterator[tuple[Case, Fit]]:
    """The case with wider bounds of what a model rests on with an effect or without it, and the fit without it there;
    with bounds that are far wider after those that are reached."""
    if not case.budget.allows("wider bounds", WHOLE):
        return
    without = refit(case, now, effects_without(now, effect), {})
    guesses = beyond_guesses(case, without.problem, values_in(without.problem, now))
    for slip in (SLIP, FAR_SLIP):
        specs = widened(case, without, slip) | widened(case, now, slip) | freed(case, now.problem) | guesses
        if not specs:
            return
        wide = case.with_specs(specs)
        fits = refit(wide, now, without.effects, {}), continued(wide, without)
        beyond = min(fits, key=lambda fit: fit.total)
        yield wide, beyond
        if not stands_in(wide, case, beyond):
            return


def is_adequate(path: Staircase) -> bool:
    """Whether a path led to an adequate model."""
    return path.last.verdict == "adequate"


def best_path(case: Case, paths: Sequence[Staircase]) -> Staircase:
    """The adequate path, else the lowest one; of those that end as low, that with the fewest parameters."""
    settled = [*filter(is_adequate, paths)] or paths
    least = min(path.end.total for path in settled)
    close = [path for path in settled if removed_rms(path.end.total, least) < TIE * case.floor]
    return min(close, key=lambda path: (path.end.freedom, path.end.total))


def first_candidates(case: Case, first: Fit, diagnosis: Diagnosis) -> list[Candidate]:
    """The best candidate, and the next best ones, for which another form of any effect counts too; a disturbance that
    scored too little for the short list is none of these."""
    if not diagnosis.passing:
        return []
    scored = sorted(diagnosis.candidates, key=lambda item: -item.rank)
    unlisted = [item.score.effect for item in scored[SHORTLIST:] if is_disturbance(item)]
    best, *others = diagnosis.passing
    others = [item for item in others if item.score.effect not in unlisted]
    every = [
        replace(item, score=score, fit=item.refits[score.effect])
        for item in diagnosis.candidates
        if item.score.effect not in unlisted
        for score in item.forms
        if score.effect in item.refits and item.fit is not item.refits[score.effect]
    ]
    others += [item for item in every if item.fit and removes_enough(case, first, first, item.fit)]
    return [best, *sorted(others, key=lambda item: item.fit.total if item.fit else np.inf)[: FIRST_EFFECTS - 1]]


def take_back(case: Case, first: Fit, staircase: Staircase) -> Fit | None:
    """Steps that take effects out again: those that the last model can do without, which may only have led the fit out
    of a side minimum, such as that to which the bounds of the job had led it or in which several stand in for one, and
    the unproven ones; or back to what is proven of an earlier model, where that is better than what is then left.
    Returns the fit with the unproven ones, None where there are none."""
    now, wider = staircase.end, any(step.change == WIDER for step in staircase.steps)
    many = len(now.effects) - len(first.effects) > FEW
    steps = remove_unneeded(case, first, now, newest=0, restarted=wider or many) if near_noise(case, first, now) else []
    now = steps[-1].fit if steps else now
    if not near_noise(case, first, now):
        drop_outdone_rivals(case, now, staircase.steps)
    suspects = unproven_of(case, first, now, staircase.steps)
    doubted, end = (now, suspects[-1].without) if suspects else (None, now)
    proven, doubted = proven_before(case, first, end, staircase.steps) or (None, doubted)
    kept = {*map(word_of, (proven or end).effects)}
    staircase.suspects = [item for item in suspects if word_of(item.effect) not in kept]
    if proven:
        steps.append(Step(proven, explained=explained_share(case, now, proven), change=PROVEN))
    for suspect in suspects if proven is None else []:
        share = explained_share(case, now, suspect.without)
        steps.append(Step(suspect.without, None, suspect.effect, {}, share))
        now = suspect.without
    staircase.steps += steps
    return doubted


def unproven_of(case: Case, first: Fit, fit: Fit, steps: Sequence[Step]) -> list[Suspect]:
    """The effects of a fit that are to be taken out again. steps: all of the staircase, of which those ahead of the
    last change of blocks or bounds have fits of another case."""
    rivals = {step.added: step.tied for step in steps if step.added}
    return unproven(case, first, fit, rivals, [first, *(step.fit for step in steps[last_change(steps) :])])


def last_change(steps: Sequence[Step]) -> int:
    """The number of the step to the blocks and bounds of the last one."""
    return max(number for number, step in enumerate(steps) if number == 0 or step.case)


def proven_before(case: Case, first: Fit, end: Fit, steps: Sequence[Step]) -> tuple[Fit, Fit | None] | None:
    """What is proven of the fits of the case short of the last one: the lowest that leaves clearly less than the model
    at the end, and the fit with the unproven ones, None where there are none; None where there is no lower one."""
    best, doubted = end, None
    for number in sorted(range(last_change(steps) + 1, len(steps) - 1), key=lambda number: steps[number].fit.total):
        fit = steps[number].fit
        if removed_rms(best.total, fit.total) <= TIE * case.floor:
            break
        if not case.budget.allows("proof of fewer effects", PROVING):
            break
        suspects = unproven_of(case, first, fit, steps[: number + 1])
        left = suspects[-1].without if suspects else fit
        if removed_rms(best.total, left.total) > TIE * case.floor:
            best, doubted = left, fit if suspects else None
    return None if best is end else (best, doubted)


def conclude(case: Case, first: Fit, staircase: Staircase, given: Diagnosis | None = None) -> None:
    """Diagnose the last model where that is another one than the path led to; what no effect explains then is
    unexplained. given: the diagnosis of the model as given, which holds where the path is back there."""
    end = staircase.end
    if staircase.last.before is not end:
        back = given and leads_back(case, given.before, end)
        staircase.last = replace(given, before=end) if given and back else diagnose(case, end, first)
    if staircase.last.verdict not in SETTLED:
        staircase.last = unexplained(case, first, staircase.last)


def leads_back(case: Case, given: Fit, end: Fit) -> bool:
    """Whether a path ends at the model as given, and leaves what that left."""
    return end.effects == given.effects and removed_rms(given.total, end.total) < TIE * case.floor
