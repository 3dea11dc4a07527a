"""Look-alikes of the best effect, refitted from where it led."""

from __future__ import annotations

from collections.abc import Sequence

from pzt_ident.diagnosis.budget import PROVING
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.criteria import adequate, removed_rms, removes_enough
from pzt_ident.diagnosis.fit import Fit
from pzt_ident.diagnosis.forms import Candidate, from_where, is_far_behind
from pzt_ident.diagnosis.refit import refit_from
from pzt_ident.diagnosis.starts import restart
from pzt_ident.diagnosis.ties import TIE, TWIN, are_look_alikes, is_equal
from pzt_ident.model.registry import word_of

STARTS = 8  # of a look-alike's own parameters


def simpler_look_alikes(
    case: Case, first: Fit, before: Fit, candidates: Sequence[Candidate], shortlist: Sequence[Candidate]
) -> list[Candidate]:
    """Where an effect leads to the noise, the look-alikes of fewer parameters that are not on the short list, refitted:
    where the base made up for what is missing, its side minimum has a score of its own. None where the base rests on
    bounds, for which a look-alike would make up."""
    best = min((item.fit for item in shortlist if item.fit), key=lambda fit: fit.total, default=before)
    if before.on_bounds or not adequate(case, first, best) or best.effects == before.effects:
        return []
    simpler = []
    for candidate in candidates:
        word, effects = candidate.forms[0].effect, (*before.effects, candidate.forms[0].effect)
        if candidate in shortlist or not are_look_alikes(word, best.effects[-1]):
            continue
        fewer = case.problem(effects, before.steps).dimensions < best.problem.dimensions
        if fewer and case.budget.allows("ties", PROVING):
            candidate.fit = refit_from(case, before, effects, candidate.forms[0].guesses, best.identify)
            candidate.score, candidate.refits = candidate.forms[0], {word: candidate.fit}
            simpler.append(candidate)
    return simpler


def restart_look_alikes(case: Case, first: Fit, before: Fit, candidates: list[Candidate]) -> None:
    """Refit the forms of the best effect and of its look-alikes that are far behind from where the best led, and
    restart look-alikes that are hardly worse on the identification records: with several parameters they may rest in a
    side minimum that shows on the validation records only."""
    passing = [item for item in candidates if item.fit and removes_enough(case, first, before, item.fit)]
    best = min(passing, key=lambda item: item.fit.total, default=None)  # type: ignore[union-attr]
    if best is None or best.fit is None:
        return
    led, effect = best.fit, best.score.effect
    for candidate in candidates:
        if candidate is best:
            follow(case, candidate, led)
        if candidate.fit is None or not are_look_alikes(candidate.score.effect, effect):
            continue
        follow(case, candidate, led)
        word, fit = candidate.score.effect, candidate.fit
        if removed_rms(fit.identify, led.identify) < 2 * TIE * case.floor and len(candidate.score.guess) > 1:
            candidate.fit = candidate.refits[word] = restart(case, fit, word_of(word), STARTS)


def follow(case: Case, candidate: Candidate, best: Fit) -> None:
    """Refit a candidate in each of its forms that is far behind another fit from where that led; it then means the
    first form if that is as good as its own, else that of fewest parameters which is the same model."""
    for score in candidate.forms:
        fit = candidate.refits.get(score.effect)
        if fit and is_far_behind(case, fit, best) and case.budget.allows("ties", PROVING):
            candidate.refits[score.effect] = from_where(case, best, fit, score.guess)
    own, usual = candidate.refits[candidate.score.effect], candidate.forms[0].effect
    same = [item for item, fit in candidate.refits.items() if abs(fit.total - own.total) < TWIN * case.floor]
    as_good = usual in candidate.refits and is_equal(case, own, candidate.refits[usual])
    candidate.take(usual if as_good else min(same, key=lambda item: candidate.refits[item].freedom))
