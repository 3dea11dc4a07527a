"""The verdict on a model: an effect is missing, several are tied, none is, or no effect explains the residual."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from itertools import combinations

import numpy as np

from pzt_ident.diagnosis.candidates import (
    decide_by_score,
    drop_outdone_accounts,
    promises_enough,
    refit_all,
    refit_the_rest,
    restart_unconfirmed,
    shortlist_of,
)
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.criteria import (
    DECISIVE,
    FAR,
    adequate,
    beyond_form,
    clears_an_axis,
    reaches_noise,
    removed_rms,
    removes_enough,
)
from pzt_ident.diagnosis.fit import Fit
from pzt_ident.diagnosis.forms import Candidate, choose_forms, refit_other_forms
from pzt_ident.diagnosis.limit import is_limited
from pzt_ident.diagnosis.look_alikes import restart_look_alikes, simpler_look_alikes
from pzt_ident.diagnosis.misfit import share_explained
from pzt_ident.diagnosis.reasons import (
    identification_only_sentence,
    missing_sentence,
    model_form_sentence,
    nothing_explains,
    rmse_phrase,
    with_proven,
)
from pzt_ident.diagnosis.refit import change_if_too_coarse, refit
from pzt_ident.diagnosis.score import LEAST_SCORE, scorer_of
from pzt_ident.diagnosis.scores import PROMISING, score_all
from pzt_ident.diagnosis.spectral_line import is_own_line
from pzt_ident.diagnosis.ties import (
    LIMIT_TIE,
    LOOK_ALIKE_TIE,
    TIE,
    TWIN,
    are_look_alikes,
    generalises,
    is_better,
    is_tied,
    is_twin,
    nearness_of,
    rests_on_own_bounds,
)
from pzt_ident.model.registry import blocks, word_of


@dataclass
class Diagnosis:
    """verdict and reason; before: the fit that is diagnosed; candidates, best first; tied: names of the effects that
    these data cannot distinguish, the best first; passing: candidates that remove enough, the best first; faults: those
    of the set-up that account for the misfit."""

    verdict: str
    reason: str
    before: Fit
    candidates: list[Candidate]
    tied: list[str]
    passing: list[Candidate] = field(default_factory=list)
    faults: tuple[str, ...] = ()

    @property
    def best(self) -> Candidate | None:
        return next((candidate for candidate in self.candidates if candidate.decision == "missing"), None)

    @property
    def account(self) -> Fit | None:
        """The fit in which a candidate accounts for all with a second effect."""
        return next((candidate.account for candidate in self.candidates if candidate.account), None)

    @property
    def fits(self) -> list[Fit]:
        """Those of the candidates that were refitted."""
        return [candidate.fit for candidate in self.candidates if candidate.fit]

    @property
    def rivals(self) -> dict[str, Fit]:
        """The refits with the tied effects, by effect, the best first."""
        fits = {candidate.score.effect: candidate.fit for candidate in self.candidates}
        return {word: fit for word in self.tied if (fit := fits[word])}


def diagnose(case: Case, before: Fit, first: Fit | None = None) -> Diagnosis:
    """Score every effect, refit the short list, judge; `first` as in `threshold`, by default the model itself."""
    first = first or before
    if reason := refusal(case, first, before):
        return Diagnosis("refused", reason, before, [], [])
    candidates = sorted(score_all(case, first, before, scorer_of(case, before)), key=lambda item: -item.rank)
    if adequate(case, first, before) and not any(promises_enough(case, first, before, item) for item in candidates):
        decide_by_score(case, first, before, candidates)
        return without_effect(case, first, before, candidates)
    shortlist = refit_all(case, first, before, shortlist_of(case, first, before, candidates))
    refit_other_forms(case, first, before, candidates, shortlist)
    refit_the_rest(case, first, before, candidates, shortlist)
    restart_unconfirmed(case, first, shortlist)
    choose_forms(case, first, shortlist)
    shortlist += simpler_look_alikes(case, first, before, candidates, shortlist)
    restart_look_alikes(case, first, before, shortlist)
    drop_outdone_accounts(case, first, shortlist)
    if before is first:
        shares = {word_of(item.score.effect): share_alone(case, first, item) for item in candidates}
        case.shares = {word: max(share, case.shares.get(word, share)) for word, share in shares.items()}
    candidates.sort(key=lambda item: (item.fit.total if item.fit else np.inf, -item.score.explained))
    decide_by_score(case, first, before, candidates)
    passing = [item for item in shortlist if item.fit and is_account(case, first, before, item.fit)]
    if not passing:
        return without_effect(case, first, before, candidates)
    return with_effects(case, first, before, candidates, passing)


def share_alone(case: Case, first: Fit, candidate: Candidate) -> float:
    """The share of the misfit as given that an effect explains: by its refits, else by its score."""
    if not candidate.refits:
        return candidate.score.explained_in_bounds
    return share_explained(first.total, candidate.best.total, case.floor)


def is_account(case: Case, first: Fit, before: Fit, fit: Fit) -> bool:
    """Whether an effect removes enough, or most of what one of several axes lacks, or of its own band of the
    spectrum."""
    enough = removes_enough(case, first, before, fit) or clears_an_axis(case, first, before, fit)
    return enough or is_own_line(case, before, fit, fit.effects[-1])


def with_effects(
    case: Case, first: Fit, before: Fit, candidates: list[Candidate], passing: list[Candidate]
) -> Diagnosis:
    """The diagnosis where candidates remove enough: the best of them, of tied ones the simplest, and its ties."""
    fits = {item.score.effect: item.fit for item in passing if item.fit}

    def simplicity(item: Candidate) -> tuple[int, float, int, str]:
        """Of two names of one model that which acts nearest to the reading."""
        word = item.score.effect
        return fits[word].freedom, round(fits[word].total / (TWIN * case.floor)), -nearness_of(word), word

    total = min(fit.total for fit in fits.values())
    close = [item for item in passing if removed_rms(fits[item.score.effect].total, total) < TIE * case.floor]
    lowest = min(close, key=simplicity)
    least = out_of_limit(before, needed(case, first, lowest, passing), passing)
    close = close if least is lowest else [least]
    word = least.score.effect
    alike = [
        item
        for item in passing
        if item in close
        or (is_tied(case, word, fits[word], fits[item.score.effect]) and not is_limited(fits[item.score.effect]))
    ]
    best = within_bounds(before, min(alike, key=simplicity), passing)
    tied = [item for item in alike if item is best or in_least_form(case, best, item)]
    tied += [best] if best not in tied else []
    fits, word = {item.score.effect: item.fit for item in passing if item.fit}, best.score.effect
    forms = [fit for item, fit in best.refits.items() if item != word]
    others = (item for item in passing if item not in tied and not generalises(fits[item.score.effect], fits[word]))
    tied += [item for item in others if is_twin(case, word, forms, fits[item.score.effect])]
    for item in tied:
        item.decision = "missing"
    candidates.sort(key=lambda item: (item is not best, item.fit.total if item.fit else np.inf))
    words = [word, *(item.score.effect for item in tied if item is not best)]
    verdict = "missing" if len(words) == 1 else "inconclusive"
    rest = sorted((item for item in passing if item not in tied), key=lambda item: fits[item.score.effect].total)
    reason = missing_sentence(case, first, before, fits[word], words)
    return Diagnosis(verdict, reason, before, candidates, words, [best, *rest])


def in_least_form(case: Case, best: Candidate, item: Candidate) -> bool:
    """Whether a tied candidate is no form of many more parameters than the best has, or is a look-alike that fits
    better by half of what is a tie. Where its first form is tied, too, it means that."""
    if best.fit is None or item.fit is None:
        return True
    usual = item.refits.get(item.forms[0].effect) if item.forms else None
    simpler = usual is not None and item.fit.freedom > max(usual.freedom, best.fit.freedom)
    if usual and simpler and is_tied(case, best.score.effect, best.fit, usual):
        item.take(item.forms[0].effect)
        return True
    alike = are_look_alikes(best.score.effect, item.score.effect)
    return not generalises(item.fit, best.fit) or (alike and is_better(case, best.fit, item.fit))


def needed(case: Case, first: Fit, best: Candidate, passing: list[Candidate]) -> Candidate:
    """The best, or the lowest of those of fewer parameters that, FAR from the noise, fit as well to one percent, or
    that it contains and beside which it adds no more than their form may leave: friction with a viscous part is a lag
    where nothing rubs."""

    def suffices(fit: Fit, than: Fit) -> bool:
        contained = word_of(fit.effects[-1]) in blocks[than.effects[-1]].contains
        as_well = fit.total < (1 + LOOK_ALIKE_TIE) * than.total and fit.freedom < than.freedom
        return (as_well and than.total > FAR * case.floor) or (contained and not beyond_form(case, first, fit, than))

    others = [item for item in passing if best.fit and item.fit and suffices(item.fit, best.fit)]
    return min(others, key=lambda item: item.fit.total if item.fit else np.inf, default=best)


def out_of_limit(before: Fit, best: Candidate, passing: list[Candidate]) -> Candidate:
    """The best, or, where that is in a limit which is declared to be something else, the lowest that is in none and
    removes half as much."""

    def may_stand(item: Candidate) -> bool:
        fit = item.fit
        return fit is not None and not is_limited(fit) and before.total**2 - fit.total**2 >= DECISIVE * removed

    if best.fit is None or not is_limited(best.fit):
        return best
    removed = before.total**2 - best.fit.total**2
    return min(filter(may_stand, passing), key=lambda item: item.fit.total if item.fit else np.inf, default=best)


def within_bounds(before: Fit, best: Candidate, passing: list[Candidate]) -> Candidate:
    """The best, or its look-alike that is hardly worse where the best is such a look-alike in the limit."""
    if not best.fit or not rests_on_own_bounds(before, best.fit):
        return best
    most = (1 + LIMIT_TIE) * best.fit.total
    others = [
        (item.fit.total, number)
        for number, item in enumerate(passing)
        if item.fit and item.fit.total < most and are_look_alikes(best.score.effect, item.score.effect)
        if not rests_on_own_bounds(before, item.fit)
    ]
    return passing[min(others)[1]] if others else best


def refusal(case: Case, first: Fit, fit: Fit) -> str:
    """Why the residual of a fit may not be blamed on the model; empty where it may."""
    if adequate(case, first, fit):
        return ""
    if not fit.converged:
        return "Two starts of the fit do not agree, so the remaining error may come from the search. Narrow the bounds."
    change = change_if_too_coarse(case, fit)
    if not change:
        return ""
    return (
        f"The remaining error, an RMSE of {fit.identify / case.floor:.1f} noise floors, may come from the simulation:"
        f" finer steps change the response by {change / case.floor:.1f} noise floors. Sample faster, or drive"
        " more slowly."
    )


def without_effect(case: Case, first: Fit, before: Fit, candidates: list[Candidate]) -> Diagnosis:
    """The diagnosis where no effect removes enough: the model is adequate, or its misfit is unexplained."""
    rmse = rmse_phrase(case, before)
    if adequate(case, first, before):
        reason = f"The model is adequate: it leaves {rmse}.{model_form_sentence(case, first, before)}"
        return Diagnosis("adequate", reason, before, candidates, [])
    if before.validate is not None and reaches_noise(case, first, before):
        reason = (
            f"The model leaves {rmse}: the validation records show something that the identification records do not"
            " show or do not determine. Set `use: identify` for a record of that kind."
        )
    else:
        reason = nothing_explains(case, before)
    reason += identification_only_sentence(case, first, before, candidates)
    return Diagnosis("unexplained", reason, before, candidates, [])


def unexplained(case: Case, first: Fit, found: Diagnosis) -> Diagnosis:
    """The diagnosis of a model that unproven effects were taken out of: what is left is not one of them, if it is more
    than the noise."""
    for candidate in found.candidates:
        candidate.decision = "suspect" if candidate.decision == "missing" else candidate.decision
    if adequate(case, first, found.before):
        return replace(without_effect(case, first, found.before, found.candidates), passing=found.passing)
    reason = found.reason if found.verdict == "unexplained" else nothing_explains(case, found.before)
    reason = with_proven(case, first, found.before, reason)
    return Diagnosis("unexplained", reason, found.before, found.candidates, [], found.passing)


def pair_behind(case: Case, first: Fit, before: Fit, candidates: list[Candidate]) -> Fit | None:
    """The refit with the effect that removes most of the misfit of the identification records, though it may lose the
    others for lack of a second one, and with that which promises most of what it leaves, in any form; None where none
    does, or both do not remove enough."""
    fits = [fit for item in candidates for fit in item.refits.values()]
    leading = min(fits, key=lambda fit: fit.identify, default=before)
    if share_explained(before.identify, leading.identify, case.floor) < DECISIVE:
        return None
    beside = score_all(case, first, leading, scorer_of(case, leading))
    most = max((item.score for item in beside), key=lambda score: score.explained_in_bounds, default=None)
    if most is None or most.explained_in_bounds < PROMISING:
        return None
    both = refit(case, leading, (*leading.effects, most.effect), most.guess)
    return both if removes_enough(case, first, before, both) else None


def best_pair(case: Case, first: Fit, before: Fit, candidates: list[Candidate]) -> Fit | None:
    """Of the pairs of effects of the short list, which may hide each other, the refit that is best and removes
    enough."""
    shortlist = [item for item in candidates if item.score.explained > LEAST_SCORE][:3]
    alone = min((item.fit for item in shortlist if item.fit), key=lambda fit: fit.total, default=None)
    least = (1 - DECISIVE) ** 0.5 * alone.identify if alone else np.inf  # of a pair that is worth its time
    fits = [
        refit(case, before, (*before.effects, a.score.effect, b.score.effect), a.score.guess | b.score.guess, least)
        for a, b in combinations(shortlist, 2)
    ]
    passing = [fit for fit in fits if removes_enough(case, first, before, fit)]
    return min(passing, key=lambda fit: fit.total, default=None)
