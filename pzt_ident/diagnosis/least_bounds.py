"""The staircase within the bounds of the job, where wider ones were only a way to it, or where they make up for an
effect that adds to what is known."""

from __future__ import annotations

from dataclasses import replace

from pzt_ident.diagnosis.bounds import brought_back
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.climb import WIDER, Staircase
from pzt_ident.diagnosis.step import Step, explained_share
from pzt_ident.diagnosis.ties import is_equal
from pzt_ident.diagnosis.within_bounds import adding_effects, fit_with, is_known_beyond, on_given_bounds
from pzt_ident.model.registry import Choice

WITHIN = "within the bounds of the job"  # the step back from wider ones


def with_least_bounds(case: Case, staircase: Staircase) -> Staircase:
    """The staircase, within the bounds of the job where its last model is."""
    if staircase.case is None:
        return staircase
    known = [case]
    home = case_with_words(known, staircase.case.words)
    if brought_back(home, staircase.end) is None:
        return with_known(case, home, staircase)
    kept = [step for step in staircase.steps if step.change != WIDER]
    homes = [case_with_words(known, case.words_of(step.fit)) for step in kept]
    steps = [
        replace(step, fit=brought_back(at, step.fit) or step.fit, case=step.case and at)
        for step, at in zip(kept, homes, strict=True)
    ]
    return replace(staircase, steps=steps, case=None if home is case else home)


def with_known(case: Case, home: Case, staircase: Staircase) -> Staircase:
    """The staircase with the effect that adds to what is known, and with which its last model is as good within the
    bounds of the job; as it is where there is none. home: the case of the job with the blocks of that model."""
    end = staircase.end
    if staircase.last.verdict != "adequate" or not is_known_beyond(home, end):
        return staircase
    within = on_given_bounds(home, end)
    for effect in adding_effects(home, end):
        fit = fit_with(home, within, effect)
        if is_equal(home, end, fit):
            back = Step(within, explained=explained_share(home, end, within), change=WITHIN, case=home)
            added = Step(fit, effect, None, {effect: fit}, explained_share(home, within, fit))
            last, steps = replace(staircase.last, before=fit), [*staircase.steps, back, added]
            return replace(staircase, steps=steps, last=last, case=None if home is case else home)
    return staircase


def case_with_words(known: list[Case], words: tuple[str | Choice, ...]) -> Case:
    """The one of the known cases that has these blocks, or one that is then known."""
    for case in known:
        if case.words == words:
            return case
    known.append(known[0].with_words(words))
    return known[-1]
