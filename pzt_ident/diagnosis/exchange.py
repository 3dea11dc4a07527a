"""Steps that take effects back, or put other forms or effects in their place."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from functools import partial
from itertools import permutations

from pzt_ident.diagnosis.budget import PROOF, PROVING, WHOLE
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.criteria import DECISIVE, adequate, beyond_form, removed_rms, removes_enough, threshold
from pzt_ident.diagnosis.fit import Fit
from pzt_ident.diagnosis.forms import from_modes_exchanged
from pzt_ident.diagnosis.limit import is_limited, own_bounds, shapes_at_ends
from pzt_ident.diagnosis.misfit import share_explained
from pzt_ident.diagnosis.possible import applicable, fitting_forms
from pzt_ident.diagnosis.refit import AT_NOISE, refit, refit_beside
from pzt_ident.diagnosis.score import scorer_of
from pzt_ident.diagnosis.starts import restart
from pzt_ident.diagnosis.step import Step, StepListener, effects_without, explained_share
from pzt_ident.diagnosis.ties import (
    LIMIT_TIE,
    TIE,
    TWIN,
    are_look_alikes,
    at_noise,
    generalises,
    is_better,
    is_equal,
    is_tied,
    is_twin,
    nearness_of,
    rests_on_own_bounds,
    strangers,
)
from pzt_ident.diagnosis.verdict import diagnose
from pzt_ident.model.registry import blocks, form_of, word_of

COMPARABLE = 0.3  # of the share that an effect explains by its score: what explains less cannot take its place
LEAST_GAIN = 0.05  # noise floors by which one effect fits better than another: less may be simulation error


def remove_unneeded(case: Case, first: Fit, now: Fit, newest: int = 1, restarted: bool = False) -> list[Step]:
    """Steps that remove effects, other than the newest and those of the job itself, which no longer remove enough, or
    no more than the form of the others may leave, and are of no use to the validation records. restarted: whether the
    model without one is started elsewhere, too."""
    steps: list[Step] = []
    for effect in now.effects[len(first.effects) : len(now.effects) - newest]:
        without = refit(case, now, effects_without(now, effect), {})
        if restarted and case.budget.allows("other starts", PROVING):
            without = restart(case, without)
        missed = now.validate is not None and removed_rms(without.validate, now.validate) > threshold(case, first)
        needed = removes_enough(case, first, without, now) or beyond_form(case, first, without, now)
        if not missed and not needed:
            steps.append(Step(without, None, effect, {}, explained_share(case, now, without)))
            now = without
    return steps


def exchange_accounts(case: Case, first: Fit, now: Fit) -> list[Step]:
    """Steps that put other forms in the place of the effects added, or look-alikes where these were added before the
    others were known, where that fits better."""
    steps: list[Step] = []
    added = now.effects[len(first.effects) :]
    for effect in added:
        rivals = look_alikes(case, now, effect, in_every_form=not at_noise(case, now)) if len(added) > 1 else []
        items = rivals if adequate(case, first, now) else [*rivals, *other_forms(case, now, effect)]
        if items and not case.budget.allows("other forms"):
            break
        fits = [fit for fit in fits_in_place(case, now, effect, items) if not in_its_limit(now, fit)]
        best = min(fits, key=lambda fit: fit.total, default=now)
        if fits_better(case, now, best) and (best.effects[-1] in rivals or clears_up(case, now, best)):
            best = under_own_name(case, now, effect, best)
            steps += [exchange_step(case, now, best, effect), *remove_unneeded(case, first, best)]
            now = steps[-1].fit
    return steps


def forms_instead(case: Case, first: Fit, now: Fit) -> list[Step]:
    """The steps from an adequate model that take out an effect and put another form in the place of one beside it,
    where that does as well: the effect made up for the form."""
    added = now.effects[len(first.effects) :]
    for needless, effect in permutations(reversed(added), 2):
        if not other_forms(case, now, effect) or not case.budget.allows("other forms", PROVING):
            continue
        without = refit(case, now, effects_without(now, needless), {})
        fits = fits_in_place(case, without, effect, other_forms(case, without, effect))
        best = min(fits, key=lambda fit: fit.total, default=without)
        if adequate(case, first, best) and removed_rms(best.total, now.total) < TIE * case.floor:
            taken_out = Step(without, None, needless, {}, explained_share(case, now, without))
            return [taken_out, exchange_step(case, without, best, effect)]
    return []


def exchange_limits(case: Case, first: Fit, now: Fit) -> list[Step]:
    """Steps from effects of which a shape ended on a bound to the simplest form without it that fits as well, or only
    to a simpler one where its range ends there of itself: a drift that never settles is a ramp."""
    steps: list[Step] = []
    for effect in now.effects[len(first.effects) :]:
        limited = bool(own_bounds(now, effect))
        if not (limited or shapes_at_ends(now, effect)) or not case.budget.allows("other forms", PROVING):
            continue
        fits = fits_in_place(case, now, effect, other_forms(case, now, effect))
        fits = [fit for fit in fits if limited or fit.freedom < now.freedom]
        free = [fit for fit in fits if is_equal(case, now, fit) and not own_bounds(fit, fit.effects[-1])]
        if free:
            steps.append(exchange_step(case, now, min(free, key=lambda fit: (fit.freedom, fit.total)), effect))
            now = steps[-1].fit
    return steps


def in_its_limit(now: Fit, other: Fit) -> bool:
    """Whether an effect in the place of another is in a limit that is declared to be something else, or is hardly
    better and rests on a bound of its own: it may be the limit in which it is that other one."""
    hardly_better = now.total < (1 + LIMIT_TIE) * other.total and rests_on_own_bounds(now, other)
    return hardly_better or is_limited(other)


def under_own_name(case: Case, now: Fit, effect: str, best: Fit) -> Fit:
    """The fit of a look-alike in the place of an effect, or that with a form of the effect which is the same model."""
    if word_of(best.effects[-1]) == word_of(effect):
        return best
    forms = fits_in_place(case, now, effect, other_forms(case, now, effect))
    return next((fit for fit in forms if is_twin(case, effect, [fit], best)), best)


def clears_up(case: Case, now: Fit, other: Fit) -> bool:
    """Whether another form removes most of the misfit that is left: less may be its greater freedom."""
    return share_explained(now.total, other.total, case.floor) >= DECISIVE


def other_forms(case: Case, now: Fit, effect: str) -> list[str]:
    possible = fitting_forms(case, effects_without(now, effect), word_of(effect))
    return [item for item in possible if blocks[item].item() != blocks[effect].item()]


def look_alikes(
    case: Case, now: Fit, effect: str, tied: Collection[str] = (), in_every_form: bool = False
) -> list[str]:
    """The look-alikes that could be in the place of an effect, each in the first form that fits, in that which the
    effect has and in those that were tied with it, or in all that fit."""
    effects = effects_without(now, effect)
    possible = applicable(case, effects)
    forms = [fitting_forms(case, effects, word) for word in blocks[effect].look_alikes if word in possible]
    meant = [{items[0], *tied, *(item for item in items if form_of(item) == form_of(effect))} for items in forms]
    return [item for items, some in zip(forms, meant, strict=True) for item in items if in_every_form or item in some]


def fits_in_place(case: Case, now: Fit, effect: str, items: Sequence[str], as_rivals: bool = False) -> list[Fit]:
    """The model refitted with each of the items in the place of an effect, but for those that explain little of what
    that explains. as_rivals: whether one of several parameters that explains as much by its score, and is not tied, is
    started elsewhere, too: it rests in a side minimum."""
    if not items:
        return []
    without = refit(case, now, effects_without(now, effect), {})
    scorer, fits = scorer_of(case, without), list[Fit]()
    scores, own = [scorer.score(item) for item in items], scorer.score(effect).explained
    for score in scores:
        if score.explained < COMPARABLE * own:
            continue
        fit = refit_beside(case, (without, now), (*without.effects, score.effect), score.guess, now.identify)
        if word_of(score.effect) == word_of(effect):
            fit = from_modes_exchanged(case, now, fit)
        promised = as_rivals and score.explained >= own and len(score.guess) > 1
        if promised and not is_tied(case, effect, now, fit) and case.budget.allows("ties", WHOLE):
            fit = restart(case, fit)
        fits.append(fit)
    return fits


def find_rivals(case: Case, first: Fit, steps: list[Step], on_step: StepListener) -> None:
    """Set the rivals of the effects in the last model by refits beside all the other effects, with a step to one that
    leaves clearly less, to a tied one that has fewer parameters, or to the first name of a model that has two, but from
    the noise to none that leaves more. Those of a single effect are known where it is the last that was added."""
    now, last = steps[-1].fit, steps[-1]
    added = now.effects[len(first.effects) :]
    known = added == (last.added,) and last.removed is None
    for effect in () if known else added:
        if not case.budget.allows("ties", WHOLE + PROOF):
            break
        step = next(step for step in reversed(steps) if step.added == effect)
        fits = rivals_in_place(case, now, effect, step.tied, in_every_form=len(added) > 1)
        if lower := lower_rival(case, first, now, effect, fits):
            others = (*step.tied, effect)
            on_step(step := exchange_step(case, now, lower, effect))
            steps.append(step)
            effect, now = lower.effects[-1], lower
            fits = rivals_in_place(case, now, effect, others, in_every_form=len(added) > 1)
        tied = [fit for fit in fits if is_tied(case, effect, now, fit)]
        rivals = {effect: now} | {fit.effects[-1]: fit for fit in tied}
        level = AT_NOISE * case.floor
        alike = [item for item, fit in rivals.items() if now.total >= level or fit.total < level]
        taken = min(alike, key=partial(simplicity, case, now, rivals))
        forms = fits_in_place(case, now, effect, other_forms(case, now, effect) if len(tied) < len(fits) else [])
        rivals |= {fit.effects[-1]: fit for fit in fits if is_twin(case, effect, forms, fit)}
        if taken != effect:
            on_step(step := exchange_step(case, now, rivals[taken], effect))
            steps.append(step)
        step.rivals = {taken: rivals[taken]} | rivals
        now = rivals[taken]


def lower_rival(case: Case, first: Fit, now: Fit, effect: str, fits: Sequence[Fit]) -> Fit | None:
    """The lowest of the adequate fits with a look-alike in the place of an effect, if it has no more parameters, is in
    no limit and leaves clearly less: the effect was taken before the others were known."""

    def is_able(fit: Fit) -> bool:
        lower = not is_equal(case, fit, now) and fits_better(case, now, fit)
        alike = fit.freedom <= now.freedom and are_look_alikes(effect, fit.effects[-1])
        return lower and alike and adequate(case, first, fit) and not in_its_limit(now, fit)

    return min(filter(is_able, fits), key=lambda fit: fit.total, default=None)


def rivals_in_place(case: Case, now: Fit, effect: str, tied: Collection[str], in_every_form: bool) -> list[Fit]:
    """The model refitted with the look-alikes of an effect in its place, at the noise without other forms of these that
    may contain it, unless they fit better."""
    fits = fits_in_place(case, now, effect, look_alikes(case, now, effect, tied, in_every_form), as_rivals=True)
    if not in_every_form or not at_noise(case, now):
        return fits
    meant = look_alikes(case, now, effect, tied)
    return [fit for fit in fits if fit.effects[-1] in meant or not generalises(fit, now) or is_better(case, now, fit)]


def simplicity(case: Case, now: Fit, rivals: Mapping[str, Fit], item: str) -> tuple[int, bool, int, str]:
    """The order in which tied effects are taken: by parameters, then those that are the model of a fit, of two names
    of one model that which acts nearest to the reading."""
    other = abs(rivals[item].total - now.total) >= TWIN * case.floor
    return rivals[item].freedom, other, -nearness_of(item), item


def add_rivals_beside(case: Case, first: Fit, steps: Sequence[Step], doubted: Fit) -> None:
    """Add the look-alikes that are tied with an effect of the last model in a fit that has unproven effects beside it:
    if one of these is there after all, the data cannot tell them apart."""
    added = steps[-1].fit.effects[len(first.effects) :]
    for effect in added if case.budget.allows("ties", WHOLE) else ():
        step = next((step for step in reversed(steps) if step.added == effect), None)
        if step is None or effect not in doubted.effects:
            continue
        fits = fits_in_place(case, doubted, effect, look_alikes(case, doubted, effect, step.tied), as_rivals=True)
        tied = [fit for fit in fits if is_tied(case, effect, doubted, fit)]
        if any(fit.effects[-1] not in step.rivals for fit in tied):
            known = [fit for fit in fits if fit.effects[-1] in step.rivals and fit not in tied]
            step.rivals = {effect: doubted} | {fit.effects[-1]: fit for fit in (*known, *tied)}


def drop_outdone_rivals(case: Case, now: Fit, steps: Sequence[Step]) -> None:
    """Leave an effect of the last model only those rivals of another kind that fit as well in its place beside the
    effects that were added after it."""
    for step in steps:
        if step.added not in now.effects:
            continue
        others = [item for item in strangers(step.added, step.tied) if word_of(item) not in map(word_of, now.effects)]
        if not others or not case.budget.allows("ties", WHOLE):
            continue
        equal = [fit.effects[-1] for fit in fits_in_place(case, now, step.added, others) if is_equal(case, now, fit)]
        outdone = {*others} - {*equal}
        step.rivals = {item: fit for item, fit in step.rivals.items() if item not in outdone}


def exchange_any(case: Case, first: Fit, now: Fit) -> list[Step]:
    """The best exchange of an added effect for any other one, where that fits better."""
    best, removed = now, ""
    for effect in now.effects[len(first.effects) :]:
        without = refit(case, now, effects_without(now, effect), {})
        rival = diagnose(case, without, first).best
        if rival and rival.fit and rival.fit.total < best.total:
            best, removed = rival.fit, effect
    return [exchange_step(case, now, best, removed)] if fits_better(case, now, best) else []


def fits_better(case: Case, now: Fit, other: Fit) -> bool:
    """Whether another fit is clearly better in total and not worse on the validation records."""
    return (
        removed_rms(now.total, other.total) > LEAST_GAIN * case.floor and removed_rms(now.validate, other.validate) > 0
    )


def exchange_step(case: Case, now: Fit, after: Fit, effect: str) -> Step:
    """The step that puts the last effect of the fit `after` in the place of another."""
    word = after.effects[-1]
    return Step(after, word, effect, {word: after}, explained_share(case, now, after))
