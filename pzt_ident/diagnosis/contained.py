"""Effects of which one holds what another one does: friction with a viscous part a lag, a lag of two poles a delay."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import permutations

from pzt_ident.diagnosis.budget import PROVING
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.criteria import adequate, removed_rms
from pzt_ident.diagnosis.exchange import clears_up, exchange_step, fits_better, fits_in_place, other_forms
from pzt_ident.diagnosis.fit import Fit
from pzt_ident.diagnosis.limit import own_bounds
from pzt_ident.diagnosis.possible import applicable
from pzt_ident.diagnosis.refit import refit, refit_beside, refit_holding
from pzt_ident.diagnosis.score import scorer_of
from pzt_ident.diagnosis.step import Step, effects_without, explained_share
from pzt_ident.diagnosis.ties import TIE, are_look_alikes, is_tied
from pzt_ident.model.registry import blocks, word_of

PART = 0.3  # of the misfit beside a plainer form: what explains less by its score was no part of an effect


def join_look_alikes(case: Case, first: Fit, now: Fit) -> list[Step]:
    """The steps that take out one of two look-alikes and put another form in the place of the other, where that alone
    does as well: a lag of two poles is a lag and a delay."""
    for one, other in permutations(now.effects[len(first.effects) :], 2):
        items = other_forms(case, now, one) if are_look_alikes(one, other) else []
        if not items or not case.budget.allows("other forms", PROVING):
            continue
        without = refit(case, now, effects_without(now, other), {})
        others = effects_without(without, one)
        holding = (
            refit_holding(case, now, (*others, item)) for item in items if word_of(other) in blocks[item].contains
        )
        for alone in (*holding, *fits_in_place(case, without, one, items)):
            if removed_rms(alone.total, now.total) < TIE * case.floor and not own_bounds(alone, alone.effects[-1]):
                taken_out = Step(without, None, other, {}, explained_share(case, now, without))
                return [taken_out, exchange_step(case, without, alone, one)]
    return []


def separate_accounts(case: Case, first: Fit, now: Fit) -> list[Step]:
    """Where an effect contains another one, as friction with a viscous part a lag, the steps to the form that does not,
    and to that other one by itself or a look-alike of it, where these remove most of what is left."""
    for effect in () if adequate(case, first, now) else now.effects[len(first.effects) :]:
        parts, plain = parts_of(case, now, effect), other_forms(case, now, effect)
        bare = [item for item in plain if not blocks[item].contains]
        if not parts or not bare or not case.budget.allows("other forms"):
            continue
        base = refit_bare(case, now, effect, bare)
        scores = [score for score in map(scorer_of(case, base).score, parts) if score.explained >= PART]
        if not scores:
            continue
        fits = [refit_beside(case, (base, now), (*base.effects, s.effect), s.guess, now.identify) for s in scores]
        best = min(fits, key=lambda fit: fit.total)
        if fits_better(case, now, best) and clears_up(case, now, best):
            part = best.effects[-1]
            rivals = {fit.effects[-1]: fit for fit in (best, *fits) if fit is best or is_tied(case, part, best, fit)}
            alone = exchange_step(case, now, base, effect)
            return [alone, Step(best, part, None, rivals, explained_share(case, base, best))]
    return []


def refit_bare(case: Case, now: Fit, effect: str, items: Sequence[str]) -> Fit:
    """The model with one of some forms in the place of an effect: with that of which the effect is an extension, else
    with that which explains most."""
    others = effects_without(now, effect)
    extended = [item for item in items if issubclass(blocks[effect], blocks[item])]
    if extended:
        return refit(case, now, (*others, extended[0]), {})
    without = refit(case, now, others, {})
    best = max(map(scorer_of(case, without).score, items), key=lambda score: score.explained)
    return refit_beside(case, (without, now), (*others, best.effect), best.guess)


def parts_of(case: Case, now: Fit, effect: str) -> list[str]:
    """What an effect contains, and its look-alikes, as far as the model can have them beside it."""
    contained = blocks[effect].contains
    words = dict.fromkeys([*contained, *(alike for word in contained for alike in blocks[word].look_alikes)])
    possible = applicable(case, now.effects)
    return [word for word in words if word in possible]
