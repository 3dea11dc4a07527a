"""The verdict on a model: an effect is missing, several are tied, none is, or no effect explains the residual."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from itertools import combinations

import numpy as np

from pzt_ident.diagnosis.refit import Case, Fit, refit, restart, step_errors
from pzt_ident.diagnosis.score import Score, Scorer, applicable, squared_misfit
from pzt_ident.diagnosis.wording import percent
from pzt_ident.model.registry import blocks

SHORTLIST = 5  # effects that are refitted
LEAST_SCORE = 0.02  # of the misfit: an effect that scores less is not refitted
CLEAR = 0.6  # noise floors: an effect removes at least this much, root mean square
LEAST_SHARE = 0.15  # and at least this much of the misfit
TIE = 0.2  # noise floors between two refits: less does not distinguish them; of look-alikes twice that
LOOK_ALIKE_TIE = 0.01  # of the total RMSE: less does not distinguish refits of look-alikes far above the noise
VALIDATION_FACTOR = 3.0  # times the threshold that the validation records of an adequate model may be above the noise
MODEL_FORM = 0.03  # of the initial misfit: less may as well be the form of the effects added as another effect
STEP_FAULT = 0.6  # of the misfit: where halving the simulation step changes more, the step is to blame
LOOK_ALIKE_STARTS = 8  # starts of a look-alike's own parameters
VISIBLE = 0.3  # noise floors that the strongest plausible effect would leave


@dataclass
class Candidate:
    """An effect that may be missing, with its refit where it was on the short list."""

    score: Score
    fit: Fit | None = None
    decision: str = "not missing"


@dataclass
class Diagnosis:
    """verdict and reason; before: the fit that is diagnosed; candidates, best first; tied: names of the effects that
    these data cannot distinguish, the best first; passing: candidates that remove enough, the best first."""

    verdict: str
    reason: str
    before: Fit
    candidates: list[Candidate]
    tied: list[str]
    passing: list[Candidate] = field(default_factory=list)

    @property
    def best(self) -> Candidate | None:
        return next((candidate for candidate in self.candidates if candidate.decision == "missing"), None)


def removed_rms(before: float | None, after: float | None) -> float:
    """What an effect removes of an RMSE, root mean square; negative where the RMSE grew, infinite without records."""
    if before is None or after is None:
        return np.inf
    return float(np.sign(before - after) * np.sqrt(abs(before**2 - after**2)))


def threshold(case: Case, first: Fit) -> float:
    """The least that an effect must remove, root mean square, in units of the loss; a model no further above the noise
    is adequate. `first` is the model before anything was added."""
    return max(CLEAR * case.floor, MODEL_FORM * squared_misfit(case, first) ** 0.5)


def removes_enough(case: Case, first: Fit, before: Fit, after: Fit) -> bool:
    """Whether an effect removes enough on the identification records and on the validation records; where the latter
    do not show it, it must bring both down to the noise."""
    removed, least = removed_rms(before.identify, after.identify), threshold(case, first)
    in_validation = removed_rms(before.validate, after.validate) > least / 2 or not_in_validation(
        case, first, before, after
    )
    return removed > least and removed**2 > LEAST_SHARE * squared_misfit(case, before) and in_validation


def not_in_validation(case: Case, first: Fit, before: Fit, after: Fit) -> bool:
    """Whether an effect explains all of the misfit, and the validation records are at the noise with it and without."""
    noise = np.hypot(case.floor, threshold(case, first))
    return all(error is not None and error <= noise for error in (before.validate, after.validate, after.identify))


def adequate(case: Case, first: Fit, fit: Fit) -> bool:
    """Whether a fit is at the noise of the identification records and close to that of the validation records."""
    most = np.hypot(case.floor, VALIDATION_FACTOR * threshold(case, first))
    return reaches_noise(case, first, fit) and bool(fit.validate is None or fit.validate <= most)


def reaches_noise(case: Case, first: Fit, fit: Fit) -> bool:
    """Whether a fit is at the noise of the identification records."""
    return bool(fit.identify <= np.hypot(case.floor, threshold(case, first)))


def diagnose(case: Case, before: Fit, first: Fit | None = None) -> Diagnosis:
    """Score every effect, refit the short list, judge; `first` as in `threshold`, by default the model itself."""
    first = first or before
    if reason := refusal(case, first, before):
        return Diagnosis("refused", reason, before, [], [])
    scorer = Scorer(case, before)
    candidates = sorted(map(Candidate, score_all(case, before, scorer)), key=lambda item: -item.score.explained)
    if adequate(case, first, before) and not any(_promises_enough(case, first, before, item) for item in candidates):
        decide_by_score(case, first, before, candidates)
        return without_effect(case, first, before, candidates)
    shortlist = [item for item in candidates if item.score.explained > LEAST_SCORE][:SHORTLIST]
    refit_all(case, before, shortlist)
    restart_look_alikes(case, first, before, shortlist)
    candidates.sort(key=lambda item: (item.fit.total if item.fit else np.inf, -item.score.explained))
    decide_by_score(case, first, before, candidates)
    passing = [item for item in shortlist if item.fit and removes_enough(case, first, before, item.fit)]
    if not passing:
        return without_effect(case, first, before, candidates)
    return with_effects(case, first, before, candidates, passing)


def with_effects(
    case: Case, first: Fit, before: Fit, candidates: list[Candidate], passing: list[Candidate]
) -> Diagnosis:
    """The diagnosis where candidates remove enough: the best of them, of tied ones the simplest, and its ties."""
    fits = {item.score.effect: item.fit for item in passing if item.fit}
    total = min(fit.total for fit in fits.values())
    close = [item for item in passing if removed_rms(fits[item.score.effect].total, total) < TIE * case.floor]
    best = min(close, key=lambda item: (fits[item.score.effect].problem.dimensions, fits[item.score.effect].total))
    word = best.score.effect
    tied = [item for item in passing if item in close or is_tied(case, word, fits[word], fits[item.score.effect])]
    for item in tied:
        item.decision = "missing"
    candidates.sort(key=lambda item: (item is not best, item.fit.total if item.fit else np.inf))
    words = [word, *(item.score.effect for item in tied if item is not best)]
    verdict = "missing" if len(words) == 1 else "inconclusive"
    others = sorted((item for item in passing if item not in tied), key=lambda item: fits[item.score.effect].total)
    reason = missing_sentence(case, first, before, fits[word], words)
    return Diagnosis(verdict, reason, before, candidates, words, [best, *others])


def refusal(case: Case, first: Fit, fit: Fit) -> str:
    """Why the residual of a fit may not be blamed on the model; empty where it may."""
    if adequate(case, first, fit):
        return ""
    if not fit.converged:
        return "Two starts of the fit do not agree, so the remaining error may come from the search. Narrow the bounds."
    change = float(np.sqrt(np.mean(np.square(step_errors(case, fit)))))
    if change <= STEP_FAULT * squared_misfit(case, fit) ** 0.5:
        return ""
    return (
        f"The remaining error, an RMSE of {fit.identify / case.floor:.1f} noise floors, may come from the simulation:"
        f" halving its step changes the response by {change / case.floor:.1f} noise floors. Sample faster, or drive"
        " more slowly."
    )


def score_all(case: Case, before: Fit, scorer: Scorer) -> list[Score]:
    """The scores of every effect that can be added to the model."""
    words, scores = applicable(case, before.effects), list[Score]()
    with ThreadPoolExecutor(2) as pool:
        for score in pool.map(scorer.score, words):
            scores.append(score)
            facts = {"effect": score.effect, "explained": score.explained}
            case.on_event({"event": "scored", **facts, "done": len(scores), "of": len(words)})
    return scores


def are_look_alikes(one: str, other: str) -> bool:
    """Whether one of two effects counts the other among its look-alikes."""
    return one in blocks[other].look_alikes or other in blocks[one].look_alikes


def is_tied(case: Case, effect: str, fit: Fit, rival: Fit) -> bool:
    """Whether a fit with a look-alike in the place of an effect is hardly worse."""
    close = removed_rms(rival.total, fit.total) < 2 * TIE * case.floor
    return (close or rival.total < (1 + LOOK_ALIKE_TIE) * fit.total) and are_look_alikes(effect, rival.effects[-1])


def _promises_enough(case: Case, first: Fit, before: Fit, candidate: Candidate) -> bool:
    """Whether an effect would remove enough by its score."""
    return candidate.score.explained * squared_misfit(case, before) > threshold(case, first) ** 2


def refit_all(case: Case, before: Fit, candidates: list[Candidate]) -> None:
    """Put the model refitted with each effect into its candidate."""

    def refitted(candidate: Candidate) -> Fit:
        return refit(case, before, (*before.effects, candidate.score.effect), candidate.score.guess)

    with ThreadPoolExecutor(2) as pool:
        for candidate, fit in zip(candidates, pool.map(refitted, candidates), strict=True):
            candidate.fit = fit


def restart_look_alikes(case: Case, first: Fit, before: Fit, candidates: list[Candidate]) -> None:
    """Restart the fits of look-alikes of the best that are hardly worse on the identification records: with several
    parameters they may rest in a side minimum that shows on the validation records only."""
    passing = [item for item in candidates if item.fit and removes_enough(case, first, before, item.fit)]
    best = min(passing, key=lambda item: item.fit.total, default=None)  # type: ignore[union-attr]
    if best is None or best.fit is None:
        return
    for candidate in candidates:
        word, fit = candidate.score.effect, candidate.fit
        close = fit and removed_rms(fit.identify, best.fit.identify) < 2 * TIE * case.floor
        if fit and close and are_look_alikes(word, best.score.effect) and len(candidate.score.guess) > 1:
            candidate.fit = restart(fit, word, LOOK_ALIKE_STARTS)


def decide_by_score(case: Case, first: Fit, before: Fit, candidates: list[Candidate]) -> None:
    """Mark the candidates that these data cannot show, and those whose score is too small for a refit."""
    for candidate in candidates:
        score = candidate.score
        if score.power < VISIBLE:
            candidate.decision = "cannot be seen"
        elif (
            candidate.fit is None
            and score.explained > LEAST_SCORE
            and not _promises_enough(case, first, before, candidate)
        ):
            candidate.decision = "too small"


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
        reason = f"No effect of the catalogue explains the remaining error, {rmse}."
    reason += identification_only_sentence(case, first, before, candidates)
    return Diagnosis("unexplained", reason, before, candidates, [])


def rmse_phrase(case: Case, fit: Fit) -> str:
    """`an RMSE of 1.02 noise floors on the identification records and 1.05 noise floors on the validation records`."""
    identify = f"an RMSE of {fit.identify / case.floor:.2f} noise floors"
    if fit.validate is None:
        return identify
    validate = f"{fit.validate / case.floor:.2f} noise floors"
    return f"{identify} on the identification records and {validate} on the validation records"


def model_form_sentence(case: Case, first: Fit, fit: Fit) -> str:
    """A sentence about an error above the noise that is too small a part of the initial misfit to be blamed on another
    effect; empty where there is none."""
    if max(fit.identify, fit.validate or 0.0) <= np.hypot(1, VALIDATION_FACTOR * CLEAR) * case.floor:
        return ""
    share = percent(squared_misfit(case, fit) / squared_misfit(case, first))
    return (
        f" That is above the noise, but {share} of the initial misfit: the form of the effects added explains it as"
        " well as another effect would."
    )


def identification_only_sentence(case: Case, first: Fit, before: Fit, candidates: list[Candidate]) -> str:
    """A sentence about an effect that would explain the identification records only; empty where there is none."""
    refitted = [(item.score.effect, item.fit) for item in candidates if item.fit and item.fit.validate is not None]
    word, fit = min(refitted, key=lambda word_and_fit: word_and_fit[1].identify, default=("", None))
    if fit is None or before.validate is None or fit.validate is None:
        return ""
    removed, least = removed_rms(before.identify, fit.identify), threshold(case, first)
    misfit = squared_misfit(case, before)
    in_validation = removed_rms(before.validate, fit.validate) > least / 2
    if removed**2 <= LEAST_SHARE * misfit or removed <= least or in_validation:
        return ""
    share = percent(removed**2 / misfit)
    floors = f"{before.validate / case.floor:.2f} to {fit.validate / case.floor:.2f} noise floors"
    return (
        f" {word} would remove {share} of the misfit on the identification records, but the RMSE on the validation"
        f" records would go from {floors}."
    )


def missing_sentence(case: Case, first: Fit, before: Fit, fit: Fit, words: list[str]) -> str:
    """What the best effect, the first of the tied `words`, explains."""
    share = percent(removed_rms(before.identify, fit.identify) ** 2 / squared_misfit(case, before))
    floors = f"{before.identify / case.floor:.1f} to {fit.identify / case.floor:.1f} noise floors"
    sentence = f"it explains {share} of the misfit; the RMSE falls from {floors}."
    if not_in_validation(case, first, before, fit):
        sentence += " The validation records show nothing of it, so only the identification records support it."
    if not adequate(case, first, fit):
        sentence += " More is missing, or it stands in for something else: `pzt-ident improve` follows it up."
    if len(words) == 1:
        return f"Missing: {words[0]}. {sentence[0].upper()}{sentence[1:]}"
    return f"{' or '.join(words)}: these data cannot tell them apart. Take {words[0]}: {sentence}"


def best_pair(case: Case, first: Fit, before: Fit, candidates: list[Candidate]) -> Fit | None:
    """Of the pairs of effects of the short list, which may hide each other, the refit that is best and removes
    enough."""
    shortlist = [item for item in candidates if item.score.explained > LEAST_SCORE][:3]
    fits = [
        refit(case, before, (*before.effects, a.score.effect, b.score.effect), a.score.guess | b.score.guess)
        for a, b in combinations(shortlist, 2)
    ]
    passing = [fit for fit in fits if removes_enough(case, first, before, fit)]
    return min(passing, key=lambda fit: fit.total, default=None)
