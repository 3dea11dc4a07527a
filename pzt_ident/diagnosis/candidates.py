"""The effects that may be missing, refitted where they score."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from pzt_ident.diagnosis.budget import EXPLORING, PROVING
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.cost import has_many_amounts
from pzt_ident.diagnosis.criteria import (
    DECISIVE,
    adequate,
    is_enough,
    near_noise,
    reaches_noise,
)
from pzt_ident.diagnosis.fit import Fit
from pzt_ident.diagnosis.forms import (
    AS_LIKELY,
    NOT_ALL,
    Candidate,
    drives_onto_bounds,
    from_each_other,
    least_score,
    likely_forms,
    refit_anew,
    refit_likely_forms,
    rests_on_bounds,
    share_of_others,
)
from pzt_ident.diagnosis.misfit import share_explained
from pzt_ident.diagnosis.refit import refit_from
from pzt_ident.diagnosis.score import LEAST_SCORE, Score, scorer_of
from pzt_ident.diagnosis.scores import PROMISING, promises_most, score_all
from pzt_ident.diagnosis.starts import restart
from pzt_ident.diagnosis.threads import side_by_side
from pzt_ident.diagnosis.ties import are_look_alikes
from pzt_ident.model.registry import blocks

SHORTLIST = 6  # effects that are refitted
SECONDS = 3  # effects that are tried as the second of two that account for all
CLOSE = 2.0  # noise floors up to which two may account for all
AS_CLOSE = 1.1  # times what the closest to the records which are fitted leaves: the simplest of these is meant
VISIBLE = 0.3  # noise floors that the strongest plausible effect would leave


def shortlist_of(case: Case, first: Fit, before: Fit, candidates: Sequence[Candidate]) -> list[Candidate]:
    """The effects to be refitted, of all that were scored: see `short_list`."""
    least = least_score(case, first, before)
    ranked = sorted(candidates, key=lambda item: -item.rank)
    return short_list([item for item in ranked if item.score.explained > least])


def short_list(promising: list[Candidate]) -> list[Candidate]:
    """The effects to be refitted, of those that score, the best first: as many as that, by `simpler_first`, behind the
    first of them the disturbances, and behind these every other disturbance."""
    listed, others = simpler_first(promising[:SHORTLIST]), promising[SHORTLIST:]
    listed[1:] = sorted(listed[1:], key=is_disturbance, reverse=True)
    return listed + [item for item in others if is_disturbance(item)]


def simpler_first(candidates: list[Candidate]) -> list[Candidate]:
    """The candidates in the order in which they are refitted: ahead of one with many amounts, or some of each record,
    that explains most by its score the best of the others, if that explains nearly as much, or most too. Many amounts
    follow anything a little better, and take long."""
    other = next((item for item in candidates if not _follows_anything(item.score.effect)), None)
    if other is None or other.score.explained < min(AS_LIKELY * candidates[0].score.explained, PROMISING):
        return candidates
    return [other, *(item for item in candidates if item is not other)]


def is_disturbance(candidate: Candidate) -> bool:
    """Whether an effect has amounts of each record, which are solved for: a refit takes little time, and tells more
    than a score of what it does in a form that is not linear."""
    return bool(blocks[candidate.score.effect].amounts())


def _follows_anything(effect: str) -> bool:
    """Whether an effect has amounts enough to take up much of whatever is left."""
    return has_many_amounts(blocks[effect]) or bool(blocks[effect].amounts())


def refit_all(case: Case, first: Fit, before: Fit, candidates: Sequence[Candidate]) -> list[Candidate]:
    """Refit the model with each effect of a short list, in its first form and in the one that scores best; gives the
    refitted ones, all that the budget suffices for, but at least the best one beside the model as given. Those that
    stay far above what the best score leads to are given up; where that is adequate, or is with a second effect, none
    is refitted that is far from it. As long as no effect explains most, a disturbance is refitted in all of its forms;
    after that, only if it is one of the first SHORTLIST, and in those two."""
    refits = Refits(case, first, before, candidates)
    made = [*refits.of(candidates[:1])]
    if made and before is first:
        made[0].account = account_beside(case, first, made[0].best)
    made += refits.of(candidates[1:])
    if before is first and made:
        refit_astray(case, first, made)
    return made


def account_beside(case: Case, first: Fit, fit: Fit) -> Fit | None:
    """The model of two effects that accounts for all, of one that explains most of the records which are fitted and one
    that promises most of the rest: the first near the noise, or else the best; None where there is none."""
    if adequate(case, first, fit) or share_explained(first.identify, fit.identify, case.floor) < DECISIVE:
        return None
    fits = list[Fit]()
    for score in seconds_beside(case, first, fit):
        fits.append(refit_from(case, fit, (*fit.effects, score.effect), score.guesses))
        if near_noise(case, first, fits[-1]):
            return fits[-1]
    able = [both for both in fits if may_account(case, first, fit, both)]
    return min(able, key=lambda both: both.total, default=None)


def may_account(case: Case, first: Fit, alone: Fit, both: Fit) -> bool:
    """Whether two effects may be the way to all that is missing, which bounds of the job, the form of one or what only
    other records show still keep them from: they are at the noise of the records that are fitted, or not far from that
    of all, and the second explains most of what the first leaves."""
    close = max(both.identify, both.validate or 0.0) <= CLOSE * case.floor
    most_of_rest = share_explained(alone.identify, both.identify, case.floor) >= DECISIVE
    return reaches_noise(case, first, both) or (close and most_of_rest)


def seconds_beside(case: Case, first: Fit, fit: Fit) -> list[Score]:
    """The scores of the effects that promise most of what a fit leaves, and are no look-alikes of its own: some of the
    best, those last that follow anything."""
    scores = [item.score for item in score_all(case, first, fit, scorer_of(case, fit), in_every_form=False)]
    able = [
        score
        for score in scores
        if score.explained_in_bounds >= DECISIVE and not are_look_alikes(fit.effects[-1], score.effect)
    ]
    return sorted(able, key=lambda score: (_follows_anything(score.effect), -score.explained_in_bounds))[:SECONDS]


def drop_outdone_accounts(case: Case, first: Fit, candidates: Sequence[Candidate]) -> None:
    """Drop what two effects account for together where one does alone, or leaves no more."""
    fits = [fit for candidate in candidates for fit in candidate.refits.values()]
    least = 0.0 if any(adequate(case, first, fit) for fit in fits) else min((fit.total for fit in fits), default=np.inf)
    for candidate in candidates:
        if candidate.account and candidate.account.total >= least:
            candidate.account = None


class Refits:
    """The refits of a short list, one after the other: which of them are worth it depends on those before."""

    def __init__(self, case: Case, first: Fit, before: Fit, candidates: Sequence[Candidate]) -> None:
        self.case, self.first, self.before, self.candidates = case, first, before, candidates
        self.fits: list[Fit] = []
        self.rival, self.in_every_form = np.inf, set[str]()

    def of(self, candidates: Sequence[Candidate]) -> Iterator[Candidate]:
        """Some of the candidates, refitted, as far as they are allowed; none is given up for another one of them."""
        for candidate in side_by_side(self._refitted, filter(self._is_allowed, candidates)):
            if candidate is self.candidates[0]:
                refit_likely_forms(self.case, self.first, self.before, candidate)
            self.fits.extend(candidate.refits.values())
            yield candidate
        self.rival = min((fit.identify for fit in self.fits), default=np.inf)

    def _is_allowed(self, candidate: Candidate) -> bool:
        if is_disturbance(candidate) and not any(explains_most(self.case, self.before, fit) for fit in self.fits):
            self.in_every_form.add(candidate.score.effect)
        elif candidate in self.candidates[SHORTLIST:]:
            return False
        if self.before is self.first and candidate is self.candidates[0]:
            return True
        share = self._share_allowed(candidate)
        return self._may_stand(candidate) and self.case.budget.allows("the refits of all candidates", share)

    def _may_stand(self, candidate: Candidate) -> bool:
        best = self.candidates[0]
        enough = [adequate(self.case, self.first, fit) for fit in self.fits]
        if not any(enough) and not is_near(self.case, self.first, best.account):
            return True
        alike = are_look_alikes(best.score.effect, candidate.score.effect)
        return alike or candidate.score.explained >= NOT_ALL

    def _share_allowed(self, candidate: Candidate) -> float:
        best, score = self.candidates[0].score, candidate.score
        if candidate is self.candidates[0] and score.explained >= DECISIVE:
            return PROVING
        as_likely = score.explained >= AS_LIKELY * best.explained
        return EXPLORING if as_likely else share_of_others(self.case, self.first, self.before, self.fits)

    def _refitted(self, candidate: Candidate) -> Candidate:
        some = candidate.forms[0], candidate.score
        scores = candidate.forms if candidate.score.effect in self.in_every_form else some
        candidate.refits = refit_forms(self.case, self.before, scores, self.rival)
        return candidate


def is_near(case: Case, first: Fit, account: Fit | None) -> bool:
    """Whether there is a fit that accounts for all, and it is near the noise."""
    return account is not None and near_noise(case, first, account)


def refit_forms(case: Case, before: Fit, scores: Sequence[Score], rival: float) -> dict[str, Fit]:
    """The refits with an effect in the forms of some scores, by item. rival: as of `from_each_other`."""
    guesses = {score.effect: score.guesses for score in scores}
    fits = {item: refit_from(case, before, (*before.effects, item), some, rival) for item, some in guesses.items()}
    return from_each_other(case, fits, rival)


def refit_astray(case: Case, first: Fit, candidates: Sequence[Candidate]) -> None:
    """Refit the candidate that scores best from random points, and in its likely forms the simplest of those that are
    closest to the records which are fitted, where they drive the model onto bounds, or off those that it rested on; not
    where an effect of no more parameters is adequate."""
    best, least = candidates[0], min(candidate.closest.identify for candidate in candidates)
    close = [candidate for candidate in candidates if candidate.closest.identify <= AS_CLOSE * least]
    closest = min(close, key=lambda candidate: (candidate.closest.freedom, candidate.closest.identify))
    fits = [fit for candidate in candidates for fit in candidate.refits.values() if adequate(case, first, fit)]
    if any(fit.freedom <= best.best.freedom for fit in fits):
        return
    refit_from_random_points(case, first, best)
    moved = drives_onto_bounds(case, first, closest) or rests_on_bounds(case, first, closest.closest)
    if closest is not best and moved:
        refit_likely_forms(case, first, first, closest)
        refit_from_random_points(case, first, closest)


def refit_from_random_points(case: Case, first: Fit, candidate: Candidate) -> None:
    """Refit a candidate from random points where it and the model as given rest on bounds far from the noise, or where
    it drives the model onto bounds, unless another effect promises most of what it leaves; of the former no memory,
    which may be that of the model as given."""
    resting = rests_on_bounds(case, first, candidate.best)
    if not resting and not drives_onto_bounds(case, first, candidate):
        return
    promised = promises_most(case, first, candidate.best)
    if promised and not (resting and _follows_anything(promised)):
        return
    items = [candidate.best.effects[-1]] if resting else [score.effect for score in likely_forms(candidate)]
    refit_anew(case, first, candidate, items)


def explains_most(case: Case, before: Fit, fit: Fit) -> bool:
    """Whether a fit explains most of the misfit of the identification and of the validation records."""
    pairs = (before.identify, fit.identify), (before.validate, fit.validate)
    return all(share_explained(one, other, case.floor) >= DECISIVE for one, other in pairs if one and other)


def refit_the_rest(
    case: Case, first: Fit, before: Fit, candidates: Sequence[Candidate], shortlist: list[Candidate]
) -> None:
    """Beside the model as given, where no effect explains most of the misfit, or accounts for it with a second one,
    refit every other one in its first form, whatever it scores: what moves a model far, as a delay by a period of its
    mode, shows little along its slope. All that is refitted is added to the short list."""
    fits = [fit for candidate in shortlist for fit in candidate.refits.values()]
    accounted = any(is_near(case, first, item.account) for item in shortlist)
    if before is not first or adequate(case, first, first) or accounted:
        return
    if any(explains_most(case, before, fit) for fit in fits):
        return
    rival = min((fit.identify for fit in fits), default=np.inf)
    for candidate in candidates:
        score = candidate.forms[0]
        if candidate in shortlist or not score.guesses:
            continue
        if not case.budget.allows("the refits of all candidates"):
            return
        candidate.refits = {
            score.effect: refit_from(case, before, (*before.effects, score.effect), score.guesses, rival)
        }
        shortlist.append(candidate)


def restart_unconfirmed(case: Case, first: Fit, candidates: Sequence[Candidate]) -> None:
    """Where none is adequate, restart the best refit of each effect that reaches the noise of the identification
    records and not that of the others: what the former do not determine, as a mode that they do not make ring, may rest
    in a side minimum."""
    refits = [fit for candidate in candidates for fit in candidate.refits.values()]
    if any(adequate(case, first, fit) for fit in refits):
        return
    for candidate in filter(lambda candidate: candidate.refits, candidates):
        item, fit = min(candidate.refits.items(), key=lambda pair: pair[1].identify)
        if reaches_noise(case, first, fit) and case.budget.allows("other starts"):
            candidate.refits[item] = restart(case, fit)


def promises_enough(case: Case, first: Fit, before: Fit, candidate: Candidate) -> bool:
    """Whether an effect would remove enough by its score."""
    return is_enough(case, first, before, candidate.score.explained)


def decide_by_score(case: Case, first: Fit, before: Fit, candidates: list[Candidate]) -> None:
    """Mark the candidates that these data cannot show, and those whose score is too small for a refit."""
    for candidate in candidates:
        score = candidate.score
        if score.power < VISIBLE:
            candidate.decision = "cannot be seen"
        elif (
            candidate.fit is None
            and score.explained > LEAST_SCORE
            and not promises_enough(case, first, before, candidate)
        ):
            candidate.decision = "too small"
