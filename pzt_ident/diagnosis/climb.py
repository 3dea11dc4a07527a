"""One path to a model with what it misses: effects are added, and removed again where nothing needs them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from pzt_ident.diagnosis.behind import exchange_behind
from pzt_ident.diagnosis.bounds import beyond_bounds, stands_in
from pzt_ident.diagnosis.budget import PROVING
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.contained import join_look_alikes, separate_accounts
from pzt_ident.diagnosis.criteria import DECISIVE, FAR, adequate, clears_an_axis, removed_rms, removes_enough
from pzt_ident.diagnosis.exchange import exchange_accounts, exchange_any, forms_instead, remove_unneeded
from pzt_ident.diagnosis.fit import Fit
from pzt_ident.diagnosis.forms import Candidate, unconfirmed
from pzt_ident.diagnosis.merging import merge_effects
from pzt_ident.diagnosis.misfit import share_explained
from pzt_ident.diagnosis.possible import fitting_forms
from pzt_ident.diagnosis.refit import refit, refit_from
from pzt_ident.diagnosis.score import Score, scorer_of
from pzt_ident.diagnosis.scores import promises_most
from pzt_ident.diagnosis.starts import at_a_glance, best_alias, first_fit, restart
from pzt_ident.diagnosis.step import Doubt, Step, StepListener, explained_share
from pzt_ident.diagnosis.ties import TIE
from pzt_ident.diagnosis.unmeasured import mechanics_of_each_axis
from pzt_ident.diagnosis.verdict import Diagnosis, best_pair, diagnose, pair_behind
from pzt_ident.diagnosis.within_bounds import are_to_blame
from pzt_ident.model.registry import blocks, word_of

MOST_STEPS = 8
PATIENCE = 3  # effects that take up less than half of the misfit, after which no other is tried
MOST_ANEW = 6  # effects that are fitted from random points
WIDER = "wider bounds"  # the step that widens those of the job


@dataclass
class Staircase:
    """The steps, the model as given first; the diagnosis of the last model, or of one before it; the effects that were
    added and taken out again, because they are not proven, the mechanics that the last model does without, and faults
    of the set-up; the case of the last model, which may have wider bounds or other blocks."""

    steps: list[Step]
    last: Diagnosis
    suspects: list[Doubt] = field(default_factory=list)
    case: Case | None = None

    @property
    def end(self) -> Fit:
        """The fit of the last model."""
        return self.steps[-1].fit


def climb(
    case: Case,
    base: Sequence[Step],
    diagnosis: Diagnosis,
    candidate: Candidate | None,
    on_step: StepListener,
    known: Sequence[Fit] = (),
) -> Staircase | None:
    """One path: the candidate is added first, then always the best one, within wider bounds where these are a cheaper
    account. Where another effect promises most of what a step leaves, that is tried first, and the step is settled only
    if the promise is not kept; where it is, another form may do in its place. The last model is not diagnosed where no
    time is left for another. known: the fits of other paths; None where it joins one of them."""
    steps, first, hurried = list[Step](), base[-1].fit, False

    def take(new: Sequence[Step]) -> None:
        for step in new:
            on_step(step)
            steps.append(step)

    case.budget.begin_path()
    take(base)
    while (
        len(steps) - len(base) < MOST_STEPS and not stuck(steps) and (candidate or case.budget.allows("more effects"))
    ):
        new = next_steps(case, first, steps, diagnosis, candidate, known)
        if not new:
            break
        hurried = complete(case, first, steps, new, hurried)
        if {*new[-1].fit.effects} in [{*step.fit.effects} for step in steps]:
            break
        if joins(case, new[-1].fit, known):
            return None
        take(new)
        for find in (wider_bounds, mechanics_of_each_axis):
            if changed := find(case, first, steps[-1].fit):
                case = changed[-1].case or case
                take(changed)
        if not adequate(case, first, steps[-1].fit) and not case.budget.allows("more effects", PROVING):
            break
        diagnosis = diagnose(case, steps[-1].fit, first)
        if hurried and diagnosis.best is None and not unconfirmed(case, first, steps[-1].fit, diagnosis.fits):
            take(settle(case, first, steps[-2].fit, steps[-1]))
            diagnosis = diagnose(case, steps[-1].fit, first)
        candidate = diagnosis.best
    return Staircase(steps, diagnosis, case=next((step.case for step in reversed(steps) if step.case), None))


def complete(case: Case, first: Fit, steps: Sequence[Step], new: list[Step], unsettled: bool) -> bool:
    """Add to new steps what settles them; whether that is put off, since another effect promises most of the rest.
    unsettled: whether it was put off before them."""
    before, last = (*steps, *new)[-2].fit, new[-1]
    if not adequate(case, first, last.fit):
        fit_anew(case, before, last, best_alias(case, last.fit))
        promised = promises_most(case, first, last.fit)
        if promised and keeps_promise(case, last.fit, promised):
            return True
    new += settle(case, first, before, last)
    if unsettled and adequate(case, first, new[-1].fit):
        new += forms_instead(case, first, new[-1].fit)
    new += merge_effects(case, first, new[-1].fit)
    return False


def keeps_promise(case: Case, fit: Fit, effect: str) -> bool:
    """Whether an effect, in its first form, takes up most of what a fit leaves, as its score says."""
    guesses = scorer_of(case, fit).score(effect).guesses
    return explained_share(case, fit, refit_from(case, fit, (*fit.effects, effect), guesses)) >= DECISIVE


def joins(case: Case, fit: Fit, known: Sequence[Fit]) -> bool:
    """Whether a fit is of the effects of a known one, and not clearly lower."""
    same = (other for other in known if {*other.effects} == {*fit.effects})
    return any(removed_rms(other.total, fit.total) < TIE * case.floor for other in same)


def wider_bounds(case: Case, first: Fit, fit: Fit) -> list[Step]:
    """The step to wider bounds, where those that a fit rests on are too narrow and the wider ones hold its estimates:
    an effect would only stand in for what they keep out."""
    beyond = None if adequate(case, first, fit) else beyond_bounds(case, first, fit)
    if beyond is None:
        return []
    wide, after = beyond
    if stands_in(wide, case, after) or not are_to_blame(case, wide, fit, after):
        return []
    return [Step(after, explained=explained_share(case, fit, after), change=WIDER, case=wide)]


def stuck(steps: list[Step]) -> bool:
    """Whether one effect after the other took up a part of the misfit, and none most of it."""
    latest = [step.explained for step in steps if step.added][-PATIENCE:]
    return len(latest) == PATIENCE and max(latest) < DECISIVE


def settle(case: Case, first: Fit, before: Fit, step: Step) -> list[Step]:
    """The steps behind one that part what it holds, remove what is not needed any more and exchange what fits better in
    another form. Where these do not reach the noise, the last fit is restarted before anything else is blamed; it is
    kept where the restart leads hardly lower, since what was scored beside it holds then."""
    steps = [step, *separate_accounts(case, first, step.fit)]
    steps += tidied(case, first, steps[-1].fit)
    last = steps[-1]
    if not adequate(case, first, last.fit) and case.budget.allows("other starts"):
        restarted = restart(case, last.fit)
        if removed_rms(last.fit.total, restarted.total) > TIE * case.floor:
            fit_anew(case, (before, *(each.fit for each in steps))[-2], last, restarted)
            steps += tidied(case, first, restarted)
    return steps[1:]


def tidied(case: Case, first: Fit, fit: Fit) -> list[Step]:
    """The steps that remove what a fit does not need, exchange what fits better in another form, and join what one
    form holds."""
    steps = list[Step]()
    for find in (remove_unneeded, exchange_accounts, join_look_alikes):
        steps += find(case, first, steps[-1].fit if steps else fit)
    return steps


def fit_anew(case: Case, before: Fit, step: Step, fit: Fit) -> None:
    """Give a step another fit of the same model."""
    step.fit, step.explained = fit, explained_share(case, before, fit)


def next_steps(
    case: Case,
    first: Fit,
    steps: list[Step],
    diagnosis: Diagnosis,
    candidate: Candidate | None,
    known: Sequence[Fit] = (),
) -> list[Step]:
    """Two effects that account for all, or the first where bounds are too narrow for it; else the candidate, or what
    leads farther where no effect helps a fit that rests astray, but not to a known one; without a candidate a pair of
    effects, else an effect whose fit is restarted, else, once in a path, an effect in the place of another. Ahead of
    these an effect behind another form of what was added before. Empty where the path ends."""
    now = steps[-1].fit
    if diagnosis.account and diagnosis.before is now and candidate is diagnosis.best:
        both = steps_to(case, now, diagnosis.account)
        return both[:1] if wider_bounds(case, first, both[0].fit) else both
    if behind := exchange_behind(case, first, now, diagnosis.fits):
        return behind
    if candidate is not None and candidate.fit is not None:
        word, fit = candidate.score.effect, candidate.fit
        for others in other_ways(case, first, now, diagnosis) if is_astray(case, first, now, fit) else ():
            if not others or joins(case, others[-1].fit, known) or others[-1].fit.total >= fit.total:
                continue
            if explained_share(case, now, others[-1].fit) >= DECISIVE:
                return others
        rivals = diagnosis.rivals if candidate is diagnosis.best else {word: fit}
        return [Step(fit, word, None, rivals, explained_share(case, now, fit), candidate.score.explained)]
    if diagnosis.verdict in ("adequate", "refused"):
        return []
    if not case.budget.allows("pairs and exchanges of effects"):
        return []
    exchanged = any(step.added and step.removed for step in steps)
    return (
        add_pair(case, first, now, diagnosis)
        or add_restarted(case, first, now, diagnosis)
        or ([] if exchanged else exchange_any(case, first, now))
    )


def is_astray(case: Case, first: Fit, now: Fit, best: Fit) -> bool:
    """Whether the model as given is far from the noise, and the best effect takes up less than half of its misfit, and
    of that of each axis: the fit may rest where no effect helps it."""
    far = max(now.identify, now.validate or 0.0) > FAR * case.floor
    part = share_explained(now.total, best.total, case.floor) < DECISIVE
    return far and now.effects == first.effects and part and not clears_an_axis(case, first, now, best)


def other_ways(case: Case, first: Fit, now: Fit, diagnosis: Diagnosis) -> Iterator[list[Step]]:
    """Two effects of which each explains about half, then one whose fit starts elsewhere."""
    if case.budget.allows("pairs and exchanges of effects"):
        yield add_pair(case, first, now, diagnosis)
    yield add_restarted(case, first, now, diagnosis)


def add_pair(case: Case, first: Fit, now: Fit, diagnosis: Diagnosis) -> list[Step]:
    """The steps to two effects that hide each other."""
    pairs = (find(case, first, now, diagnosis.candidates) for find in (pair_behind, best_pair))
    both = next(filter(None, pairs), None)
    return steps_to(case, now, both) if both else []


def steps_to(case: Case, now: Fit, both: Fit) -> list[Step]:
    """The steps to a fit with two more effects, the one that fits better alone first."""
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
    far, alone = now.identify > FAR * case.floor, now.effects == first.effects
    restarted = started_anew(case, now, diagnosis) if far else restarted_by_block(case, diagnosis, every_block=alone)
    passing = [(score, fit) for score, fit in restarted if removes_enough(case, first, now, fit)]
    if not passing:
        return []
    score, fit = min(passing, key=lambda score_and_fit: score_and_fit[1].total)
    word = score.effect
    return [Step(fit, word, None, {word: fit}, explained_share(case, now, fit), score.explained)]


def restarted_by_block(case: Case, diagnosis: Diagnosis, every_block: bool) -> Iterator[tuple[Score, Fit]]:
    """The short list, each with single blocks restarted, or only its own where the others were when an effect was
    added."""
    for candidate in diagnosis.candidates:
        if candidate.fit and case.budget.allows("other starts"):
            block = "" if every_block else word_of(candidate.score.effect)
            yield candidate.score, restart(case, candidate.fit, block)


def started_anew(case: Case, now: Fit, diagnosis: Diagnosis) -> Iterator[tuple[Score, Fit]]:
    """The short list in each form that was refitted, with all blocks from random points, but for what has amounts of
    each record: no random point has its frequency. Beside a fit that rests on bounds, where scores say little, every
    effect in every form, those first that are lowest at a glance."""
    scores = {
        item: replace(candidate.score, effect=item)
        for candidate in diagnosis.candidates
        for item in (
            fitting_forms(case, now.effects, word_of(candidate.score.effect)) if now.on_bounds else candidate.refits
        )
        if not blocks[item].amounts()
    }
    items, least = [*scores], np.inf
    if now.on_bounds:
        glanced = (item for item in scores if case.budget.allows("other starts"))
        losses = {item: at_a_glance(case, (*now.effects, item)) for item in glanced}
        items = sorted(losses, key=losses.__getitem__)[:MOST_ANEW]
    for item in items:
        if case.budget.allows("other starts"):
            anew = first_fit(case, 0, effects=(*now.effects, item), rival=least)
            least = min(least, anew.identify)
            yield scores[item], anew
