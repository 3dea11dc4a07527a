"""When an effect removes enough of the misfit, and when a model is adequate."""

from __future__ import annotations

import numpy as np

from pzt_ident.diagnosis import misfit
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.fit import Fit
from pzt_ident.diagnosis.score import squared_misfit

CLEAR = 0.6  # noise floors: an effect removes at least this much, root mean square
WORSE = 0.25  # noise floors, root mean square: what the parameters of an effect that is there do not make worse
LEAST_SHARE = 0.15  # and at least this much of the misfit
DECISIVE = 0.5  # of the misfit: removing less is not yet the account of a model that stays above the noise
NEAR = 1.5  # noise floors, up to which an error may be that of the floor itself
VALIDATION_FACTOR = 3.0  # times the tolerance that the validation records of an adequate model may be above the noise
MODEL_FORM = 0.03  # of the initial misfit: less may as well be the form of the effects added as another effect
FORM_OF_OTHERS = 0.15  # of the initial RMS misfit: what the form of the other effects may leave
NEARLY_ALL = 0.95  # of a misfit, and NOT_LITTLE noise floors: no form leaves what another effect explains so well
NOT_LITTLE = 0.9
SHOWN = 0.3  # noise floors: the least that the records which are fitted show of what the others confirm
MOST_OF_OTHERS = 1.5  # noise floors: the most that it may leave, however large the initial misfit
FAR = 5.0  # noise floors: what leaves more lacks another effect or rests elsewhere, whatever the noise says
MOST_FORM = 2.0  # noise floors: what a model leaves above this is not adequate, whatever there was before


def removed_rms(before: float | None, after: float | None) -> float:
    """What an effect removes of an RMSE, root mean square; negative where the RMSE grew, infinite without records."""
    if before is None or after is None:
        return np.inf
    return float(np.sign(before - after) * np.sqrt(abs(before**2 - after**2)))


def threshold(case: Case, first: Fit) -> float:
    """The least that an effect must remove, root mean square, in units of the loss. `first` is the model before
    anything was added."""
    return max(CLEAR * case.floor, MODEL_FORM * squared_misfit(case, first) ** 0.5)


def tolerance(case: Case, first: Fit) -> float:
    """How far an adequate model may be above the noise, root mean square."""
    return min(threshold(case, first), MOST_FORM * case.floor)


def beyond_form(case: Case, first: Fit, without: Fit, now: Fit) -> bool:
    """Whether an effect beside others takes up more than the form of these may leave, on the identification and on the
    validation records. The latter need not show it where they are at the noise with it and without, or would be if the
    noise floor were half as much again, and show it by most of their rest as well. The former need not show as much
    where the model with it is at the noise of both: what predicts records that nothing was fitted to is not bent to
    them. And what leaves next to nothing of a rest of either kind is no part of a form."""
    removed = removed_rms(without.identify, now.identify)
    if takes_all(case, without, now) or predicts(case, first, without, now):
        return True
    shown = removed > form_of_others(case, first.identify)
    near = max(without.validate or 0.0, now.validate or 0.0, now.identify) <= NEAR * case.floor
    if first.validate is None or near or not_in_validation(case, first, without, now):
        return shown
    predicted = removed > CLEAR * case.floor and adequate(case, first, now)
    unseen = removed_rms(without.validate, now.validate)
    share = misfit.share_explained(without.validate or 0.0, now.validate or 0.0, case.floor)
    most = unseen > CLEAR * case.floor and share >= DECISIVE
    return (shown and most) or ((shown or predicted) and unseen > form_of_others(case, first.validate))


def takes_all(case: Case, without: Fit, now: Fit) -> bool:
    """Whether an effect takes up nearly all of what is left without it, and not little, of records of both kinds."""
    pairs = [(without.identify, now.identify), (without.validate or 0.0, now.validate or 0.0)]
    return all(
        removed_rms(before, after) > NOT_LITTLE * case.floor
        and misfit.share_explained(before, after, case.floor) >= NEARLY_ALL
        for before, after in pairs
    )


def predicts(case: Case, first: Fit, without: Fit, now: Fit) -> bool:
    """Whether an effect leads to the noise and takes up nearly all of what is left without it of the validation
    records, to which nothing is fitted, however little the identification records show of it."""
    unseen = misfit.share_explained(without.validate or 0.0, now.validate or 0.0, case.floor)
    shown = removed_rms(without.identify, now.identify) > SHOWN * case.floor
    much = now.validate is not None and removed_rms(without.validate, now.validate) > threshold(case, first)
    return shown and much and unseen >= NEARLY_ALL and adequate(case, first, now)


def only_all_counts(case: Case, first: Fit, fit: Fit) -> bool:
    """Whether what a fit leaves of the identification records may all be the form of its effects: another one is proven
    only if it takes up nearly all of it, or leads to the noise of both kinds of records."""
    return removed_rms(fit.identify, case.floor) <= form_of_others(case, first.identify)


def form_of_others(case: Case, given: float) -> float:
    """What the form of other effects may leave of the RMSE of the model as given, root mean square."""
    return min(FORM_OF_OTHERS * misfit.squared_misfit(given, case.floor) ** 0.5, MOST_OF_OTHERS * case.floor)


def is_enough(case: Case, first: Fit, before: Fit, share: float) -> bool:
    """Whether a share of the misfit on the identification records is as much as an effect must remove."""
    squared = squared_misfit(case, before)
    removes_all = share >= NEARLY_ALL and squared > (NOT_LITTLE * case.floor) ** 2
    return removes_all or share * squared > threshold(case, first) ** 2


def removes_enough(case: Case, first: Fit, before: Fit, after: Fit) -> bool:
    """Whether an effect removes enough on the identification records and on the validation records; where the latter
    do not show it, it must bring both down to the noise. What takes all of a rest, or predicts it, is enough, however
    far the model as given was from the noise."""
    if takes_all(case, before, after) or predicts(case, first, before, after):
        return True
    removed, least = removed_rms(before.identify, after.identify), threshold(case, first)
    in_validation = removed_rms(before.validate, after.validate) > least / 2 or not_in_validation(
        case, first, before, after
    )
    return removed > least and removed**2 > LEAST_SHARE * squared_misfit(case, before) and in_validation


def clears_an_axis(case: Case, first: Fit, before: Fit, after: Fit) -> bool:
    """Whether an effect removes most of the misfit of an axis, on the identification and on the validation records,
    which may be little beside what another axis lacks."""
    least = np.maximum(CLEAR * case.floors, MODEL_FORM * np.sqrt(np.maximum(first.by_use**2 - case.floors**2, 0)))
    removed = before.by_use**2 - after.by_use**2
    most = removed >= DECISIVE * (before.by_use**2 - case.floors**2)
    return bool((most & (removed > least**2)).all(axis=0).any())


def not_in_validation(case: Case, first: Fit, before: Fit, after: Fit) -> bool:
    """Whether an effect explains all of the misfit, and the validation records are at the noise with it and without,
    and no worse with it: what follows a few wrong readings of the others is."""
    noise = np.hypot(case.floor, tolerance(case, first))
    at_noise = all(error is not None and error <= noise for error in (before.validate, after.validate, after.identify))
    return at_noise and removed_rms(before.validate, after.validate) > -WORSE * case.floor


def adequate(case: Case, first: Fit, fit: Fit) -> bool:
    """Whether a fit is at the noise of the identification records and close to that of the validation records."""
    most = np.hypot(case.floor, VALIDATION_FACTOR * tolerance(case, first))
    return reaches_noise(case, first, fit) and bool(fit.validate is None or fit.validate <= most)


def near_noise(case: Case, first: Fit, fit: Fit) -> bool:
    """Whether a fit is adequate, or would be if the noise floor were half as much again."""
    return adequate(case, first, fit) or max(fit.identify, fit.validate or 0.0) <= NEAR * case.floor


def reaches_noise(case: Case, first: Fit, fit: Fit) -> bool:
    """Whether a fit is at the noise of the identification records."""
    return bool(fit.identify <= np.hypot(case.floor, tolerance(case, first)))
