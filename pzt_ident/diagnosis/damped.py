"""Mechanics that do not ring in the last model: they stand in for a lag."""

from __future__ import annotations

from collections.abc import Iterator

from pzt_ident.diagnosis.budget import WHOLE
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.contained import join_look_alikes
from pzt_ident.diagnosis.criteria import adequate
from pzt_ident.diagnosis.fit import Fit
from pzt_ident.diagnosis.forms import NEARLY_ALL
from pzt_ident.diagnosis.possible import applicable
from pzt_ident.diagnosis.refit import refit_from
from pzt_ident.diagnosis.score import scorer_of
from pzt_ident.diagnosis.step import Step, explained_share
from pzt_ident.diagnosis.ties import is_equal, is_tied
from pzt_ident.diagnosis.undetermined import (
    MODE,
    Undetermined,
    clearly_worse_without,
    mode_that_is_silent,
    word_of_mechanics,
)
from pzt_ident.model.registry import blocks

DAMPER = "viscous_damping"  # the effect whose trace they leave


def exchange_damped(case: Case, first: Fit, end: Fit) -> tuple[list[Step], Undetermined] | None:
    """The steps from an adequate model to the one without mechanics that do not ring, and to the effect in their place
    that leads to the noise as well and fits hardly worse, of several that with the fewest parameters, joined with one
    that was there where a form is both; and these mechanics, as a suspect. None where there is no such effect."""
    mode = mode_that_is_silent(end) if adequate(case, first, end) else None
    if mode is None or not case.budget.allows("effects like a damper", WHOLE):
        return None
    alternative = clearly_worse_without(case, end, word_of_mechanics(end))
    if alternative is None:
        return None
    word, lean, start = alternative
    every = fits_like_a_damper(lean, start)
    fits = [fit for fit in every if adequate(case, first, fit) and is_equal(case, end, fit)]
    if not fits:
        return None
    best = min(fits, key=lambda fit: (fit.freedom, fit.total))
    effect, share = best.effects[-1], explained_share(case, start, best)
    rivals = {fit.effects[-1]: fit for fit in fits if is_tied(case, effect, best, fit)}
    steps = [
        Step(start, explained=explained_share(case, end, start), change=f"without {word}", case=lean),
        Step(best, effect, None, {effect: best} | rivals, share),
    ]
    steps += join_look_alikes(lean, first, best)
    return steps, Undetermined(word, explained_share(case, start, end), best.total / case.floor, mode)


def fits_like_a_damper(case: Case, start: Fit) -> Iterator[Fit]:
    """The refits with the effects that leave the trace of a damper, in each form that explains nearly all by its
    score; not with another mode, which the mechanics are."""
    words = [word for word in applicable(case, start.effects) if word in blocks[DAMPER].look_alikes and word != MODE]
    for word in words:
        scores = [score for score in scorer_of(case, start).scores(word) if score.explained >= NEARLY_ALL]
        yield from (refit_from(case, start, (*start.effects, score.effect), score.guesses) for score in scores)
