"""Effects that add to a parameter beyond its bound: with one of them the model may fit as well within the bounds."""

from __future__ import annotations

import numpy as np

from pzt_ident.diagnosis.bounds import beyond_names
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.fit import Fit, fit_at
from pzt_ident.diagnosis.possible import applicable
from pzt_ident.diagnosis.refit import refit_from
from pzt_ident.diagnosis.score import scorer_of
from pzt_ident.diagnosis.ties import is_equal
from pzt_ident.model.registry import phrase_of


def within_bounds_sentence(case: Case, fit: Fit) -> str:
    """A sentence about each effect that only adds to a parameter of mechanics beyond bounds of the job, as a payload
    does, and with which the model fits as well within them; empty where there is none."""
    effects = adding_effects(case, fit)
    if not effects:
        return ""
    bounded = on_given_bounds(case, fit)
    effects = [effect for effect in effects if is_equal(case, fit, fit_with(case, bounded, effect))]
    sentence = (
        " With {} the model fits as well within the bounds of the job: these data cannot tell one from the other."
    )
    return "".join(sentence.format(phrase_of(effect)) for effect in effects)


def adding_effects(case: Case, fit: Fit) -> list[str]:
    """The effects that the model can have and that add to parameters of the blocks of those beyond their bounds."""
    beyond = {*beyond_names(case, fit)}
    blocks = {item.block for item in fit.problem.model.entries if item.name in beyond}
    parameters = [parameter for block in blocks for parameter in block.parameters().values()]
    adding = {effect for parameter in parameters if parameter.adds_to for effect in parameter.effects}
    return [effect for effect in applicable(case, fit.effects) if effect in adding]


def on_given_bounds(case: Case, fit: Fit) -> Fit:
    """The fit with each parameter within the bounds of the job."""
    problem = case.problem(fit.effects, fit.steps, fit.measured_only)
    point = problem.unit_point(fit.values)
    return fit_at(fit.effects, problem, np.clip(point, 0, 1), fit.converged, fit.measured_only)


def fit_with(case: Case, fit: Fit, effect: str) -> Fit:
    """The model of a fit with another effect, within the bounds of the job."""
    score = scorer_of(case, fit).score(effect)
    return refit_from(case, fit, (*fit.effects, score.effect), score.guesses, fit.identify)
