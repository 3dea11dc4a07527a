"""The forms in which an effect may be missing: which of them are refitted, and which is meant."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from pzt_ident.diagnosis.budget import EXPLORING
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.cost import has_many_amounts
from pzt_ident.diagnosis.criteria import (
    DECISIVE,
    FAR,
    adequate,
    only_all_counts,
    reaches_noise,
    removed_rms,
    removes_enough,
)
from pzt_ident.diagnosis.fit import Fit
from pzt_ident.diagnosis.limit import is_limited
from pzt_ident.diagnosis.misfit import share_explained
from pzt_ident.diagnosis.modes import with_modes_exchanged
from pzt_ident.diagnosis.refit import AT_NOISE, refit, refit_from
from pzt_ident.diagnosis.score import LEAST_SCORE, Score, scorer_of
from pzt_ident.diagnosis.starts import first_fit
from pzt_ident.diagnosis.ties import TIE, are_look_alikes, at_noise
from pzt_ident.model.registry import blocks, word_of

FORM_GAIN = 0.02  # of the misfit, by which another form of an effect explains more than the first one
LIKELY = 0.65  # of the misfit: an effect that explains as much by its score is tried in its other forms before others
NEARLY_ALL = 0.9  # of the misfit: what explains as much may be a look-alike of what is missing, in another form
AS_LIKELY = 0.9  # of what the best score explains: what scores as much is refitted as long as others are
NOT_ALL = 0.3  # of the misfit: an effect that scores less is no account of nearly all of it


@dataclass
class Candidate:
    """An effect that may be missing, in one of its forms.

    score, fit: of that form; the fit is None off the short list. forms: the scores of all forms, the first form first;
    refits: by item, of the first form and of the one that scores best; account: the fit in which it accounts for all
    with a second effect.
    """

    score: Score
    fit: Fit | None = None
    decision: str = "not missing"
    forms: Sequence[Score] = ()
    refits: dict[str, Fit] = field(default_factory=dict)
    account: Fit | None = None

    @classmethod
    def of(cls, scores: Sequence[Score]) -> Candidate:
        """The candidate in the form that explains most, or in the first if that explains nearly as much."""
        best = max(scores, key=lambda score: score.explained)
        return cls(best if best.explained > scores[0].explained + FORM_GAIN else scores[0], forms=scores)

    @property
    def rank(self) -> float:
        """What it explains by its score; a little less in a form that contains another effect, which is simpler."""
        return self.score.explained - (FORM_GAIN if blocks[self.score.effect].contains else 0.0)

    @property
    def best(self) -> Fit:
        """The refit that fits best."""
        return min(self.refits.values(), key=lambda fit: fit.total)

    @property
    def closest(self) -> Fit:
        """The refit that is closest to the records which are fitted; others may lose by it, where it rests in a side
        minimum."""
        return min(self.refits.values(), key=lambda fit: fit.identify)

    def take(self, item: str) -> None:
        """Mean this form, which was refitted."""
        self.score, self.fit = next(score for score in self.forms if score.effect == item), self.refits[item]


def least_score(case: Case, first: Fit, before: Fit) -> float:
    """The share of the misfit that an effect must explain by its score to be refitted."""
    return NOT_ALL if only_all_counts(case, first, before) else LEAST_SCORE


def refit_likely_forms(case: Case, first: Fit, before: Fit, candidate: Candidate) -> None:
    """Refit an effect that explains most of the misfit and leaves more than the noise in its other forms, before other
    effects are refitted, if it promised most, or rests where it may be astray: those that explain most by their scores
    first, until one is adequate."""
    if candidate.score.explained < LIKELY and not (before is first and rests_anew(before, candidate.closest)):
        return
    for score in likely_forms(candidate):
        if not leaves_some(case, first, before, candidate.best):
            return
        if score.effect not in candidate.refits and case.budget.allows("other forms"):
            effects, rival = (*before.effects, score.effect), candidate.best.identify
            candidate.refits[score.effect] = refit_from(case, before, effects, score.guesses, rival)


def likely_forms(candidate: Candidate) -> list[Score]:
    """The scores of the forms that explain nearly all that the best one does, that of the most first."""
    scores = [score for score in candidate.forms if score.explained >= AS_LIKELY * candidate.score.explained]
    return sorted(scores, key=lambda score: -score.explained)


def drives_onto_bounds(case: Case, first: Fit, candidate: Candidate) -> bool:
    """Whether an effect beside the model as given explains most and leaves more than the noise of the identification
    records, and drives the model onto bounds where it did not rest without it; not one with many amounts, which takes
    the place of what the model has."""
    if has_many_amounts(blocks[candidate.score.effect]) or reaches_noise(case, first, candidate.closest):
        return False
    return leaves_some(case, first, first, candidate.closest) and rests_anew(first, candidate.closest)


def rests_on_bounds(case: Case, first: Fit, fit: Fit) -> bool:
    """Whether an effect beside the model as given explains most and leaves more than the noise, and parameters of the
    model rest on bounds without it, and none of these with it, or with it, too, far from the noise: both may be in a
    side minimum, which no second effect mends, or the latter on the way out of it."""
    held = {*first.on_bounds} & {*first.problem.names}
    far = fit.identify > FAR * case.floor
    return bool(held) and leaves_some(case, first, first, fit) and (far or not held & {*fit.on_bounds})


def refit_anew(case: Case, first: Fit, candidate: Candidate, items: Sequence[str]) -> None:
    """Fit an effect in some of its forms from random points, but for those with amounts of each record, until one is
    adequate or rests where the model did without it."""
    for item in items:
        if not (drives_onto_bounds(case, first, candidate) or rests_on_bounds(case, first, candidate.best)):
            return
        if not blocks[item].amounts() and case.budget.allows("other starts"):
            anew = first_fit(case, 0, effects=(*first.effects, item), rival=candidate.best.identify)
            candidate.refits[item] = min(anew, candidate.refits.get(item, anew), key=lambda fit: fit.total)


def leaves_some(case: Case, first: Fit, before: Fit, fit: Fit) -> bool:
    """Whether a fit explains most of the misfit, and leaves more than the noise."""
    explains_most = share_explained(before.identify, fit.identify, case.floor) >= DECISIVE
    return explains_most and not adequate(case, first, fit)


def rests_anew(before: Fit, fit: Fit) -> bool:
    """Whether a parameter of the model rests on a bound where it did not without the effect: it may be a side minimum,
    in which the effect does what a part of the model did."""
    return bool(set(fit.on_bounds) & set(before.problem.names) - set(before.on_bounds))


def from_each_other(case: Case, refits: Mapping[str, Fit], rival: float = np.inf) -> dict[str, Fit]:
    """The refits with the forms of an effect, by item: those far behind the best one are tried from where it led,
    too. Forms share parameters, and a poor guess may rest in a side minimum. rival: the RMSE of another effect; beside
    one at the noise no form is tried again where none is near that."""
    best = min(refits.values(), key=lambda fit: fit.total)
    beaten = share_explained(best.identify, rival, case.floor) >= DECISIVE
    if beaten and rival < AT_NOISE * case.floor:
        return dict(refits)
    return {
        item: from_where(case, best, fit, {}) if is_far_behind(case, fit, best) else fit for item, fit in refits.items()
    }


def is_far_behind(case: Case, fit: Fit, best: Fit) -> bool:
    """Whether another fit leaves half of what a fit leaves, or less."""
    return share_explained(fit.total, best.total, case.floor) >= DECISIVE


def from_where(case: Case, other: Fit, fit: Fit, guess: dict[str, float]) -> Fit:
    """A fit, or the same model refitted from where another one led and from a guess of its own parameters; from where
    another form led also with modes exchanged."""
    led = min(fit, refit(case, other, fit.effects, guess, other.identify), key=lambda each: each.total)
    is_form = word_of(other.effects[-1]) == word_of(fit.effects[-1])
    return from_modes_exchanged(case, other, led) if is_form else led


def from_modes_exchanged(case: Case, other: Fit, fit: Fit) -> Fit:
    """A fit, or the same model refitted from where another one led with modes exchanged."""
    led = (refit(case, start, fit.effects, {}, fit.identify) for start in with_modes_exchanged(other))
    return min([fit, *led], key=lambda each: each.total)


def share_of_others(case: Case, first: Fit, before: Fit, fits: Sequence[Fit]) -> float:
    """The share of the budget for other effects than the best of some fits."""
    return case.budget.beside if second_missing(case, first, before, fits) else EXPLORING


def second_missing(case: Case, first: Fit, before: Fit, fits: Sequence[Fit]) -> bool:
    """Whether one of the fits explains most of the misfit, and what it leaves is above the noise: time is for a second
    effect rather than for others in the place of this one, unless it is in a limit that is declared to be something
    else."""
    best = min(fits, key=lambda fit: fit.total, default=before)
    return leaves_some(case, first, before, best) and not (best is not before and is_limited(best))


def choose_forms(case: Case, first: Fit, candidates: Sequence[Candidate]) -> None:
    """Mean the form of each effect that fits best where one effect alone makes the model adequate, or where it leaves
    half as much as any effect in its first form; else the best of those that have no more parameters than the first.

    Beside other effects that are missing too, a form that fits better may only be the more flexible one.
    """
    enough = any(adequate(case, first, fit) for item in candidates for fit in item.refits.values())
    least = min((item.refits[item.forms[0].effect].total for item in candidates), default=np.inf)
    for candidate in candidates:
        usual, refits = candidate.forms[0].effect, candidate.refits
        chosen = clearly_best(case, refits, usual)
        if not enough and share_explained(least, refits[chosen].total, case.floor) < DECISIVE:
            simple = {item: fit for item, fit in refits.items() if fit.freedom <= refits[usual].freedom}
            chosen = clearly_best(case, simple, usual)
        candidate.take(chosen)


def clearly_best(case: Case, refits: Mapping[str, Fit], usual: str) -> str:
    """The item that fits best, or of those that are hardly worse the usual one, else that of fewest parameters. The
    usual one where none can be simulated."""
    least = min(fit.total for fit in refits.values())
    close = {item: fit for item, fit in refits.items() if removed_rms(fit.total, least) <= TIE * case.floor}
    if usual in close or not close:
        return usual
    return min(close, key=lambda item: (close[item].freedom, close[item].total))


def refit_other_forms(
    case: Case, first: Fit, before: Fit, candidates: Sequence[Candidate], shortlist: list[Candidate]
) -> None:
    """Refit the short list, and then what else scores, in every form where no effect explains most of the misfit, or
    beside the model as given only one with many amounts, which follows anything: one that scores low may leave little
    of it. Where an effect explains nearly all, refit it, unless it is at the noise,
    and its look-alikes in the forms that are not far from that by their scores: one may explain more in another. Where
    something helps and is not enough, half of the time for exploring is for what is missing beside it. All that is
    refitted is added to the short list."""
    fits = [fit for item in shortlist for fit in item.refits.values()]
    if unconfirmed(case, first, before, fits):
        return
    passing = [fit for fit in fits if removes_enough(case, first, before, fit)]
    best = min(passing, key=lambda fit: fit.total, default=before)
    share = share_explained(before.identify, best.identify, case.floor)
    nearly_all, enough = share >= NEARLY_ALL, adequate(case, first, best)
    until = case.budget.beside if passing and not enough else EXPLORING
    if nearly_all:
        wanted = alternatives(case, best, candidates)
        if not enough and best.identify < FAR * case.floor:
            others = [item for item in candidates if item not in wanted]
            wanted += nearly_all_in_another_form(case, before, others, until)
    else:
        least = least_score(case, first, before)
        others = [item for item in candidates if item not in shortlist and item.score.explained > least]
        follows = before is first and best is not before and has_many_amounts(blocks[best.effects[-1]]) and not enough
        wanted = [*shortlist, *others] if share < DECISIVE or follows else []
    for candidate in wanted:
        candidate.forms = scorer_of(case, before).scores(word_of(candidate.score.effect))
        possible = contending_forms(candidate) if nearly_all else candidate.forms
        missing = [score for score in possible if score.effect not in candidate.refits]
        if missing and not case.budget.allows("other forms", until):
            break
        new = {
            score.effect: refit_from(case, before, (*before.effects, score.effect), score.guesses, best.identify)
            for score in missing
        }
        if new:
            candidate.refits = from_each_other(case, {**candidate.refits, **new}, best.identify)
    shortlist += [item for item in wanted if item.refits and item not in shortlist]


def nearly_all_in_another_form(
    case: Case, before: Fit, candidates: Sequence[Candidate], share: float
) -> list[Candidate]:
    """The effects that explain nearly all by the score of one of their forms, while the share of the budget lasts."""
    found = []
    for candidate in candidates:
        if not case.budget.allows("other forms", share):
            break
        scores = scorer_of(case, before).scores(word_of(candidate.score.effect))
        if max(score.explained for score in scores) >= NEARLY_ALL:
            found.append(candidate)
    return found


def contending_forms(candidate: Candidate) -> list[Score]:
    """The forms that are not far from all of the misfit by their scores, and the first form beside them."""
    likely = [score for score in candidate.forms if score.explained >= NOT_ALL]
    return [score for score in candidate.forms if likely and (score in likely or score is candidate.forms[0])]


def unconfirmed(case: Case, first: Fit, before: Fit, fits: Sequence[Fit]) -> Fit | None:
    """Beside effects that were added before, the lowest of some fits on the identification records, where its effect,
    which has not many amounts, explains nearly all of these and the others do not confirm it; else None."""
    if before.effects == first.effects:
        return None
    few = [fit for fit in fits if not has_many_amounts(blocks[fit.effects[-1]])]
    best = min(few, key=lambda fit: fit.identify, default=before)
    nearly_all = share_explained(before.identify, best.identify, case.floor) >= NEARLY_ALL
    return best if nearly_all and not removes_enough(case, first, before, best) else None


def alternatives(case: Case, best: Fit, candidates: Sequence[Candidate]) -> list[Candidate]:
    """The effect of a fit, unless that is at the noise and in no form of more parameters than the first, and its
    look-alikes."""
    word = word_of(best.effects[-1])
    itself = next(item for item in candidates if word_of(item.score.effect) == word)
    settled = at_noise(case, best) and best.freedom <= itself.refits[itself.forms[0].effect].freedom
    return [*([] if settled else [itself]), *(item for item in candidates if are_look_alikes(word, item.score.effect))]
