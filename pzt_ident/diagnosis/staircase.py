"""Add what is missing, effect by effect, and remove again what turns out not to be needed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from pzt_ident.diagnosis.candidates import Candidate, is_tied
from pzt_ident.diagnosis.criteria import adequate, removed_rms, removes_enough, threshold
from pzt_ident.diagnosis.misfit import share_explained
from pzt_ident.diagnosis.proof import DECISIVE, Suspect, unproven
from pzt_ident.diagnosis.refit import Case, Fit, refit, restart
from pzt_ident.diagnosis.score import Scorer, applicable
from pzt_ident.diagnosis.verdict import Diagnosis, best_pair, diagnose, unexplained
from pzt_ident.model.registry import blocks

MOST_STEPS = 8
PATIENCE = 3  # effects that take up less than half of the misfit, after which no other is tried
FIRST_EFFECTS = 2  # effects that are tried as the first to be added
LEAST_GAIN = 0.05  # noise floors by which one effect fits better than another: less may be simulation error
HOPELESS = 5.0  # noise floors: where the first path ends above that, another order of the same effects does not help


@dataclass
class Step:
    """A step of the staircase: the fit after it, the effect it added or removed, the look-alikes that these data cannot
    distinguish from it with their fits (itself first), and the shares of the misfit it removed and was expected to."""

    fit: Fit
    added: str | None = None
    removed: str | None = None
    rivals: dict[str, Fit] = field(default_factory=dict)
    explained: float = 0.0
    expected: float | None = None

    @property
    def tied(self) -> tuple[str, ...]:
        return tuple(self.rivals)


StepListener = Callable[[Step], None]


@dataclass
class Staircase:
    """The steps, the model as given first; the diagnosis of the last model; the effects that were added and taken out
    again, because they are not proven."""

    steps: list[Step]
    last: Diagnosis
    suspects: list[Suspect] = field(default_factory=list)


def improve(case: Case, first: Fit, on_step: StepListener = lambda step: None) -> Staircase:
    """The staircase from the model as given to the one with all effects that are proven.

    Where the best first effect leads to no adequate model, the next best one is tried: the first may have stood in for
    something else.
    """
    diagnosis = diagnose(case, first)
    paths: list[Staircase] = []
    candidates: list[Candidate | None] = [*first_candidates(case, first, diagnosis)]
    for candidate in candidates or [None]:
        path = climb(case, first, diagnosis, candidate, on_step)
        paths.append(path)
        if path.last.verdict in ("adequate", "refused") or path.steps[-1].fit.identify / case.floor > HOPELESS:
            break
    best = min(paths, key=lambda path: (path.last.verdict != "adequate", path.steps[-1].fit.total))
    take_back_unproven(case, first, best, on_step)
    find_rivals(case, first, best.steps)
    return best


def first_candidates(case: Case, first: Fit, diagnosis: Diagnosis) -> list[Candidate]:
    """The best candidate, and the next best one, for which another form of any effect counts too."""
    if not diagnosis.passing:
        return []
    best, *others = diagnosis.passing
    every = [
        replace(item, score=score, fit=item.refits[score.effect])
        for item in diagnosis.candidates
        for score in item.forms
        if score.effect in item.refits and item.fit is not item.refits[score.effect]
    ]
    others += [item for item in every if item.fit and removes_enough(case, first, first, item.fit)]
    return [best, *sorted(others, key=lambda item: item.fit.total if item.fit else np.inf)[: FIRST_EFFECTS - 1]]


def take_back_unproven(case: Case, first: Fit, staircase: Staircase, on_step: StepListener) -> None:
    """Steps that take the unproven effects out again. What is left then is unexplained, but for other forms."""
    staircase.suspects = unproven(case, first, staircase.steps[-1].fit)
    for suspect in staircase.suspects:
        now = staircase.steps[-1].fit
        step = Step(suspect.without, None, suspect.effect, {}, explained_share(case, now, suspect.without))
        on_step(step)
        staircase.steps.append(step)
    if staircase.suspects:
        staircase.last = diagnose(case, staircase.steps[-1].fit, first)
    if staircase.last.verdict not in ("adequate", "refused"):
        staircase.last = unexplained(case, first, staircase.last)


def climb(
    case: Case, first: Fit, diagnosis: Diagnosis, candidate: Candidate | None, on_step: StepListener
) -> Staircase:
    """One path: the candidate is added first, then always the best one."""
    steps = [Step(first)]
    on_step(steps[0])
    while len(steps) <= MOST_STEPS and not stuck(steps):
        new = next_steps(case, first, steps, diagnosis, candidate)
        if not new:
            break
        restart_if_inadequate(case, first, (*steps, *new)[-2].fit, new[-1])
        new += remove_unneeded(case, first, new[-1].fit)
        new += exchange_accounts(case, first, new[-1].fit)
        if frozenset(new[-1].fit.effects) in {frozenset(step.fit.effects) for step in steps}:
            break
        for step in new:
            on_step(step)
        steps += new
        diagnosis = diagnose(case, steps[-1].fit, first)
        candidate = diagnosis.best
    return Staircase(steps, diagnosis)


def stuck(steps: list[Step]) -> bool:
    """Whether one effect after the other took up a part of the misfit, and none most of it."""
    latest = [step.explained for step in steps if step.added][-PATIENCE:]
    return len(latest) == PATIENCE and max(latest) < DECISIVE


def restart_if_inadequate(case: Case, first: Fit, before: Fit, step: Step) -> None:
    """Where a step does not reach the noise, restart its fit before anything else is blamed."""
    if not adequate(case, first, step.fit):
        step.fit = restart(step.fit)
        step.explained = explained_share(case, before, step.fit)


def next_steps(
    case: Case, first: Fit, steps: list[Step], diagnosis: Diagnosis, candidate: Candidate | None
) -> list[Step]:
    """The candidate; without one a pair of effects, else an effect whose fit is restarted, else, once in a path, an
    effect in the place of another. Empty where the path ends."""
    now = steps[-1].fit
    if candidate is not None and candidate.fit is not None:
        word, fit = candidate.score.effect, candidate.fit
        rivals = rivals_of(diagnosis) if candidate is diagnosis.best else {word: fit}
        return [Step(fit, word, None, rivals, explained_share(case, now, fit), candidate.score.explained)]
    if diagnosis.verdict in ("adequate", "refused"):
        return []
    exchanged = any(step.added and step.removed for step in steps)
    return (
        add_pair(case, first, now, diagnosis)
        or add_restarted(case, first, now, diagnosis)
        or ([] if exchanged else exchange_any(case, first, now))
    )


def rivals_of(diagnosis: Diagnosis) -> dict[str, Fit]:
    """The refits with the tied effects, by effect, the best first."""
    fits = {candidate.score.effect: candidate.fit for candidate in diagnosis.candidates}
    return {word: fit for word in diagnosis.tied if (fit := fits[word])}


def add_pair(case: Case, first: Fit, now: Fit, diagnosis: Diagnosis) -> list[Step]:
    """Two effects that hide each other, as two steps, the one that fits better alone first."""
    both = best_pair(case, first, now, diagnosis.candidates)
    if both is None:
        return []
    values = {name: value for name, value in both.values.items() if name not in now.problem.names}
    alone = [refit(case, now, (*now.effects, word), values) for word in both.effects[-2:]]
    single = min(alone, key=lambda fit: fit.total)
    word = single.effects[-1]
    other = next(effect for effect in both.effects[-2:] if effect != word)
    return [
        Step(single, word, None, {word: single}, explained_share(case, now, single)),
        Step(both, other, None, {other: both}, explained_share(case, single, both)),
    ]


def add_restarted(case: Case, first: Fit, now: Fit, diagnosis: Diagnosis) -> list[Step]:
    """An effect of the short list that fits once its own or another block, such as the hysteresis, starts elsewhere."""
    if now.identify > HOPELESS * case.floor:
        return []
    refitted = [(candidate.score, restart(candidate.fit)) for candidate in diagnosis.candidates if candidate.fit]
    passing = [(score, fit) for score, fit in refitted if removes_enough(case, first, now, fit)]
    if not passing:
        return []
    score, fit = min(passing, key=lambda score_and_fit: score_and_fit[1].total)
    word = score.effect
    return [Step(fit, word, None, {word: fit}, explained_share(case, now, fit), score.explained)]


def explained_share(case: Case, before: Fit, after: Fit) -> float:
    """Share of the misfit on the identification records that a step removes."""
    return share_explained(before.identify, after.identify, case.floor)


def remove_unneeded(case: Case, first: Fit, now: Fit) -> list[Step]:
    """Steps that remove effects, other than the newest and those of the job itself, which no longer remove enough and
    are of no use to the validation records."""
    steps: list[Step] = []
    for effect in now.effects[len(first.effects) : -1]:
        without = refit(case, now, effects_without(now, effect), {})
        missed = now.validate is not None and removed_rms(without.validate, now.validate) > threshold(case, first)
        if not missed and not removes_enough(case, first, without, now):
            steps.append(Step(without, None, effect, {}, explained_share(case, now, without)))
            now = without
    return steps


def exchange_accounts(case: Case, first: Fit, now: Fit) -> list[Step]:
    """Steps that put other forms in the place of the effects added, or look-alikes where these were added before the
    others were known, where that fits better."""
    steps: list[Step] = []
    added = now.effects[len(first.effects) :]
    for effect in added:
        rivals = look_alikes(case, now, effect) if len(added) > 1 else []
        items = rivals if adequate(case, first, now) else [*rivals, *other_forms(effect)]
        best = min(fits_in_place(case, now, effect, items), key=lambda fit: fit.total, default=now)
        if fits_better(case, now, best) and (best.effects[-1] in rivals or clears_up(case, now, best)):
            steps += [exchange_step(case, now, best, effect), *remove_unneeded(case, first, best)]
            now = steps[-1].fit
    return steps


def clears_up(case: Case, now: Fit, other: Fit) -> bool:
    """Whether another form removes most of the misfit that is left: less may be its greater freedom."""
    return explained_share(case, now, other) >= DECISIVE


def other_forms(effect: str) -> list[str]:
    return [item for item in blocks.forms(effect) if blocks[item].item() != blocks[effect].item()]


def look_alikes(case: Case, now: Fit, effect: str) -> list[str]:
    """The look-alikes that could be in the place of an effect."""
    possible = applicable(case, effects_without(now, effect))
    return [word for word in blocks[effect].look_alikes if word in possible]


def fits_in_place(case: Case, now: Fit, effect: str, items: Sequence[str]) -> list[Fit]:
    """The model refitted with each of the items in the place of an effect."""
    if not items:
        return []
    without = refit(case, now, effects_without(now, effect), {})
    scorer = Scorer(case, without)
    return [refit(case, without, (*without.effects, item), scorer.score(item).guess) for item in items]


def find_rivals(case: Case, first: Fit, steps: list[Step]) -> None:
    """Set the rivals of the effects in the last model by refits beside all the other effects."""
    now = steps[-1].fit
    added = now.effects[len(first.effects) :]
    for effect in added if len(added) > 1 else ():
        step = next(step for step in reversed(steps) if step.added == effect)
        fits = fits_in_place(case, now, effect, look_alikes(case, now, effect))
        tied = [fit for fit in fits if is_tied(case, effect, now, fit)]
        step.rivals = {effect: now} | {fit.effects[-1]: fit for fit in tied}


def exchange_any(case: Case, first: Fit, now: Fit) -> list[Step]:
    """The best exchange of an added effect for any other one, where that fits better."""
    best, removed = now, ""
    for effect in now.effects[len(first.effects) :]:
        without = refit(case, now, effects_without(now, effect), {})
        rival = diagnose(case, without, first).best
        if rival and rival.fit and rival.fit.total < best.total:
            best, removed = rival.fit, effect
    return [exchange_step(case, now, best, removed)] if fits_better(case, now, best) else []


def effects_without(fit: Fit, effect: str) -> tuple[str, ...]:
    return tuple(word for word in fit.effects if word != effect)


def fits_better(case: Case, now: Fit, other: Fit) -> bool:
    """Whether another fit is clearly better in total and not worse on the validation records."""
    return (
        removed_rms(now.total, other.total) > LEAST_GAIN * case.floor and removed_rms(now.validate, other.validate) > 0
    )


def exchange_step(case: Case, now: Fit, after: Fit, effect: str) -> Step:
    """The step that puts the last effect of the fit `after` in the place of another."""
    word = after.effects[-1]
    return Step(after, word, effect, {word: after}, explained_share(case, now, after))
