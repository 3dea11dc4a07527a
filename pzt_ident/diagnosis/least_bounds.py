"""The staircase within the bounds of the job, where wider ones were only a way to it."""

from __future__ import annotations

from dataclasses import replace

from pzt_ident.diagnosis.bounds import brought_back
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.climb import WIDER, Staircase
from pzt_ident.model.registry import Choice


def with_least_bounds(case: Case, staircase: Staircase) -> Staircase:
    """The staircase, within the bounds of the job where its last model is."""
    if staircase.case is None:
        return staircase
    known = [case]
    home = case_with_words(known, staircase.case.words)
    if brought_back(home, staircase.end) is None:
        return staircase
    kept = [step for step in staircase.steps if step.change != WIDER]
    homes = [case_with_words(known, case.words_of(step.fit)) for step in kept]
    steps = [
        replace(step, fit=brought_back(at, step.fit) or step.fit, case=step.case and at)
        for step, at in zip(kept, homes, strict=True)
    ]
    return replace(staircase, steps=steps, case=None if home is case else home)


def case_with_words(known: list[Case], words: tuple[str | Choice, ...]) -> Case:
    """The one of the known cases that has these blocks, or one that is then known."""
    for case in known:
        if case.words == words:
            return case
    known.append(known[0].with_words(words))
    return known[-1]
