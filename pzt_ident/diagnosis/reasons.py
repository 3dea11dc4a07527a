"""Sentences of the reason that a verdict gives."""

from __future__ import annotations

import numpy as np

from pzt_ident.data.notation import listed
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.criteria import (
    CLEAR,
    LEAST_SHARE,
    VALIDATION_FACTOR,
    adequate,
    not_in_validation,
    removed_rms,
    threshold,
)
from pzt_ident.diagnosis.fit import Fit
from pzt_ident.diagnosis.forms import Candidate
from pzt_ident.diagnosis.score import squared_misfit
from pzt_ident.diagnosis.wording import percent
from pzt_ident.model.registry import phrase_of


def nothing_explains(case: Case, fit: Fit) -> str:
    """The sentence on a misfit that is unexplained."""
    return f"No effect of the catalogue explains the remaining error, {rmse_phrase(case, fit)}."


def fault_explains(case: Case, fit: Fit) -> str:
    """The sentence on a misfit that a fault of the set-up accounts for."""
    unexplained = f"No effect of the stage explains the remaining error, {rmse_phrase(case, fit)}"
    return f"{unexplained}, but a fault of the set-up does."


def with_proven(case: Case, first: Fit, fit: Fit, reason: str) -> str:
    """The reason, with what the proven effects explain ahead of it, and that the rest which no effect explains may be
    another form of them; as it is where there are none."""
    proven, rest = fit.effects[len(first.effects) :], nothing_explains(case, fit)
    if not proven:
        return reason
    left = squared_misfit(case, fit) / squared_misfit(case, first)
    verb, them = ("explains", "it") if len(proven) == 1 else ("explain", "them")
    explained = f"{listed(map(phrase_of, proven))} {verb} {percent(1 - left)} of the initial misfit"
    if not reason.startswith(rest):
        return f"{explained}. {reason}"
    return (
        f"{explained}, and no effect of the catalogue the other {percent(left)}. That is {rmse_phrase(case, fit)}, and"
        f" may be a form of {them} that the catalogue does not have.{reason.removeprefix(rest)}"
    )


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
        f" {phrase_of(word)} would remove {share} of the misfit on the identification records, but the RMSE on the"
        f" validation records would go from {floors}."
    )


def missing_sentence(case: Case, first: Fit, before: Fit, fit: Fit, words: list[str]) -> str:
    """What the best effect, the first of the tied `words`, explains."""
    share = percent(removed_rms(before.identify, fit.identify) ** 2 / squared_misfit(case, before))
    floors = f"{before.identify / case.floor:.1f} to {fit.identify / case.floor:.1f} noise floors"
    sentence = f"it explains {share} of the misfit; the RMSE falls from {floors}."
    if not_in_validation(case, first, before, fit):
        sentence += " The validation records show nothing of it, so only the identification records support it."
    if not adequate(case, first, fit):
        sentence += " More is missing, or it stands in for something else."
    phrases = list(map(phrase_of, words))
    if len(words) == 1:
        return f"Missing: {phrases[0]}. {sentence[0].upper()}{sentence[1:]}"
    return f"{' or '.join(phrases)}: these data cannot tell them apart. Take {phrases[0]}: {sentence}"
