"""Add what is missing, effect by effect, and take back what turns out not to be needed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from pzt_ident.diagnosis.refit import Case, Fit, elsewhere, refit
from pzt_ident.diagnosis.score import Scorer, applicable, misfit
from pzt_ident.diagnosis.verdict import Candidate, Diagnosis, adequate, alike, diagnose, drop, earns, least, pair
from pzt_ident.model.registry import blocks

MOST = 8  # steps
BEAM = 2  # first picks that are followed
SURE = 0.05  # noise floors by which one effect fits better than another in its place: less may be the simulation's
HOPELESS = 5.0  # noise floors: where the first way leaves more, another order of the same effects does not help


@dataclass
class Step:
    """One stair: the fit after it, what it added or removed, and its look-alikes in these data with their fits."""

    fit: Fit
    added: str | None = None
    removed: str | None = None
    rivals: dict[str, Fit] = field(default_factory=dict)
    explained: float = 0.0
    expected: float | None = None  # share of the misfit that the score promised

    @property
    def tied(self) -> tuple[str, ...]:
        """What these data cannot tell from the effect that was added, itself first."""
        return tuple(self.rivals)


Tell = Callable[[Step], None]


def improve(case: Case, first: Fit, tell: Tell = lambda step: None) -> tuple[list[Step], Diagnosis]:
    """The staircase, the model as given first, and the diagnosis of its last model.

    Where the best first pick leads to no adequate model, the next best ones are tried: it may have been a proxy.
    """
    found = diagnose(case, first)
    picks: list[Candidate | None] = [*found.passing[:BEAM]] or [None]
    ways: list[tuple[list[Step], Diagnosis]] = []
    for pick in picks:
        ways.append(climb(case, first, found, pick, tell))
        left = ways[-1][0][-1].fit.identify / case.floor
        if ways[-1][1].verdict in ("adequate", "refused") or left > HOPELESS:
            break
    best = min(ways, key=lambda way: (way[1].verdict != "adequate", way[0][-1].fit.total))
    classed(case, first, best[0])
    return best


def climb(case: Case, first: Fit, found: Diagnosis, pick: Candidate | None, tell: Tell) -> tuple[list[Step], Diagnosis]:
    """One way up: the first pick, then always the best."""
    steps = [Step(first)]
    tell(steps[0])
    while len(steps) <= MOST:
        new = onward(case, first, steps, found, pick)
        if not new:
            break
        reconsider(case, first, (*steps, *new)[-2].fit, new[-1])
        new += unneeded(case, first, new[-1].fit)
        new += swapped(case, first, new[-1].fit)
        seen = {frozenset(step.fit.effects) for step in steps}
        if frozenset(new[-1].fit.effects) in seen:
            break
        for step in new:
            tell(step)
        steps += new
        found = diagnose(case, steps[-1].fit, first)
        pick = found.best
    return steps, found


def reconsider(case: Case, first: Fit, before: Fit, step: Step) -> None:
    """Where a stair does not reach the noise, take its fit on from elsewhere before anything else is blamed."""
    if not adequate(case, first, step.fit):
        step.fit = elsewhere(step.fit)
        step.explained = explained(case, before, step.fit)


def onward(case: Case, first: Fit, steps: list[Step], found: Diagnosis, pick: Candidate | None) -> list[Step]:
    """The next stair: what was picked, else two effects at once, else one with other values of a block beside it, else,
    once a way, one in the place of another."""
    now = steps[-1].fit
    if pick is not None and pick.fit is not None:
        rivals = rivals_of(found) if pick is found.best else {pick.score.effect: pick.fit}
        return [Step(pick.fit, pick.score.effect, None, rivals, explained(case, now, pick.fit), pick.score.explained)]
    if found.verdict in ("adequate", "refused"):
        return []
    before = any(step.added and step.removed for step in steps)
    return (
        both(case, first, now, found)
        or again(case, first, now, found)
        or ([] if before else exchanged(case, first, now))
    )


def rivals_of(found: Diagnosis) -> dict[str, Fit]:
    """The refits that these data cannot tell apart, the best first."""
    fits = {item.score.effect: item.fit for item in found.candidates}
    return {word: fit for word in found.tied if (fit := fits[word])}


def both(case: Case, first: Fit, now: Fit, found: Diagnosis) -> list[Step]:
    """Two effects that hide each other, as two stairs."""
    fit = pair(case, first, now, found.candidates)
    if fit is None:
        return []
    values = {name: value for name, value in fit.values.items() if name not in now.problem.names}
    halves = [refit(case, now, (*now.effects, word), values) for word in fit.effects[-2:]]
    half = min(halves, key=lambda half: half.total)
    one, two = half.effects[-1], next(word for word in fit.effects[-2:] if word != half.effects[-1])
    return [
        Step(half, one, None, {one: half}, explained(case, now, half)),
        Step(fit, two, None, {two: fit}, explained(case, half, fit)),
    ]


def again(case: Case, first: Fit, now: Fit, found: Diagnosis) -> list[Step]:
    """An effect of the short list with which another block, such as the hysteresis, must move far to fit."""
    if now.identify > HOPELESS * case.floor:
        return []
    tries = [(item, elsewhere(item.fit)) for item in found.candidates if item.fit]
    good = [(item, fit) for item, fit in tries if earns(case, first, now, fit)]
    if not good:
        return []
    item, fit = min(good, key=lambda found: found[1].total)
    word = item.score.effect
    return [Step(fit, word, None, {word: fit}, explained(case, now, fit), item.score.explained)]


def explained(case: Case, before: Fit, after: Fit) -> float:
    """Share of the misfit above the noise that a stair removes."""
    gone = drop(before.identify, after.identify)
    return gone * abs(gone) / misfit(case, before)


def unneeded(case: Case, first: Fit, now: Fit) -> list[Step]:
    """Take back effects, other than the newest and those of the job itself, that no longer earn their place and that
    the records to validate do not miss."""
    found: list[Step] = []
    for effect in now.effects[len(first.effects) : -1]:
        without = refit(case, now, others(now, effect), {})
        missed = now.validate is not None and drop(without.validate, now.validate) > least(case, first)
        if not missed and not earns(case, first, without, now):
            found.append(Step(without, None, effect, {}, explained(case, now, without)))
            now = without
    return found


def swapped(case: Case, first: Fit, now: Fit) -> list[Step]:
    """Put look-alikes in the place of effects that were picked before the others were known, where that leaves less."""
    found: list[Step] = []
    own = now.effects[len(first.effects) :]
    for effect in own if len(own) > 1 else ():
        best = min(look_alikes(case, now, effect), key=lambda fit: fit.total, default=now)
        if better(case, now, best):
            found += [exchange(case, now, best, effect), *unneeded(case, first, best)]
            now = found[-1].fit
    return found


def look_alikes(case: Case, now: Fit, effect: str) -> list[Fit]:
    """The model with each look-alike in the place of an effect."""
    without = refit(case, now, others(now, effect), {})
    possible, scorer = applicable(case, without.effects), Scorer(case, without)
    words = [word for word in blocks[effect].look_alikes if word in possible]
    return [refit(case, without, (*without.effects, word), scorer.score(word).guess) for word in words]


def classed(case: Case, first: Fit, steps: list[Step]) -> None:
    """Tell each stair what these data cannot tell from its effect, now that all the others are known."""
    now = steps[-1].fit
    own = now.effects[len(first.effects) :]
    for effect in own if len(own) > 1 else ():
        step = next(step for step in reversed(steps) if step.added == effect)
        close = {fit.effects[-1]: fit for fit in look_alikes(case, now, effect) if alike(case, effect, now, fit)}
        step.rivals = {effect: now} | close


def exchanged(case: Case, first: Fit, now: Fit) -> list[Step]:
    """Any effect in the place of one that was added, the best of all, where that leaves less."""
    best, out = now, ""
    for effect in now.effects[len(first.effects) :]:
        without = refit(case, now, others(now, effect), {})
        rival = diagnose(case, without, first).best
        if rival and rival.fit and rival.fit.total < best.total:
            best, out = rival.fit, effect
    return [exchange(case, now, best, out)] if better(case, now, best) else []


def others(fit: Fit, effect: str) -> tuple[str, ...]:
    return tuple(word for word in fit.effects if word != effect)


def better(case: Case, now: Fit, best: Fit) -> bool:
    return drop(now.total, best.total) > SURE * case.floor and drop(now.validate, best.validate) > 0


def exchange(case: Case, now: Fit, best: Fit, effect: str) -> Step:
    word = best.effects[-1]
    return Step(best, word, effect, {word: best}, explained(case, now, best))
