"""Effects that the records which are fitted show and the others do not confirm, behind other forms of what is there."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from pzt_ident.diagnosis.budget import PROVING
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.criteria import adequate, removes_enough
from pzt_ident.diagnosis.exchange import exchange_step, fits_in_place, look_alikes, other_forms
from pzt_ident.diagnosis.fit import Fit
from pzt_ident.diagnosis.forms import AS_LIKELY, NEARLY_ALL, unconfirmed
from pzt_ident.diagnosis.misfit import share_explained
from pzt_ident.diagnosis.possible import applicable, fitting_forms
from pzt_ident.diagnosis.refit import refit, refit_from
from pzt_ident.diagnosis.score import scorer_of
from pzt_ident.diagnosis.step import Step, effects_without, explained_share
from pzt_ident.model.registry import word_of

FAR_ABOVE = 2.0  # noise floors that validation records are left with where a model predicts less than it fits


def exchange_behind(case: Case, first: Fit, now: Fit, fits: Sequence[Fit]) -> list[Step]:
    """The steps to another form or a look-alike of an added effect and to one beside it, which the validation records
    confirm: what hardly shows in the identification records may have been taken in the wrong form. Asked for where they
    do not confirm what explains nearly all of the latter: one of some fits of one effect more each, or the last effect
    that was added, of which other forms may do then."""
    found, last = unconfirmed(case, first, now, fits), now.effects[-1] if now.effects != first.effects else ""
    if found:
        before, items = now, [found.effects[-1]]
    elif last and predicts_less(case, now):
        before = refit(case, now, effects_without(now, last), {})
        items = fitting_forms(case, before.effects, word_of(last))
    else:
        return []
    taken_out = [] if found else [Step(before, None, last, {}, explained_share(case, now, before))]
    for effect in before.effects[len(first.effects) :]:
        other = both = now
        for pair in accounts_behind(case, before, effect, items):
            other, both = min((other, both), pair, key=lambda fits: fits[1].total)
            if adequate(case, first, both):
                break
        if removes_enough(case, first, now, both):
            item, share = both.effects[-1], explained_share(case, other, both)
            return [*taken_out, exchange_step(case, before, other, effect), Step(both, item, None, {item: both}, share)]
    return []


def accounts_behind(case: Case, before: Fit, effect: str, items: Sequence[str]) -> Iterator[tuple[Fit, Fit]]:
    """The model with other forms and look-alikes in the place of an effect, each with one of some items beside it that
    explain nearly as much as the best of them by their scores."""
    instead = [*look_alikes(case, before, effect, in_every_form=True), *other_forms(case, before, effect)]
    for other in fits_in_place(case, before, effect, instead) if case.budget.allows("other forms", PROVING) else ():
        scores = [scorer_of(case, other).score(item) for item in possible_beside(case, other, items)]
        least = AS_LIKELY * max((score.explained for score in scores), default=0.0)
        for score in (score for score in scores if score.explained >= least):
            if case.budget.allows("other forms", PROVING):
                yield other, refit_from(case, other, (*other.effects, score.effect), score.guesses)


def possible_beside(case: Case, fit: Fit, items: Sequence[str]) -> list[str]:
    """Those of some items that a model can have beside its effects: one that took a place is not added again."""
    words = applicable(case, fit.effects)
    return [
        item for item in items if word_of(item) in words and item in fitting_forms(case, fit.effects, word_of(item))
    ]


def predicts_less(case: Case, fit: Fit) -> bool:
    """Whether a fit leaves far more of the validation records than of the identification records."""
    left = fit.validate or 0.0
    return left > FAR_ABOVE * case.floor and share_explained(left, fit.identify, case.floor) >= NEARLY_ALL
