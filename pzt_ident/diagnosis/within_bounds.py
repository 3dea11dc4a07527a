"""Effects that add to a parameter beyond its bound: with one of them the model may fit as well within the bounds. Where
these are so narrow that the parameter is known, the effect is named, else the bound is."""

from __future__ import annotations

import numpy as np

from pzt_ident.data.notation import listed
from pzt_ident.diagnosis.bounds import SLIP, are_too_narrow, beyond_by, beyond_names
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.fit import Fit, fit_at
from pzt_ident.diagnosis.possible import applicable
from pzt_ident.diagnosis.refit import refit, refit_from
from pzt_ident.diagnosis.score import scorer_of
from pzt_ident.diagnosis.step import effects_without
from pzt_ident.diagnosis.ties import is_equal
from pzt_ident.model.block import Block
from pzt_ident.model.registry import phrase_of, word_of

KNOWN = 0.05  # of its upper bound: a parameter whose range in the job is no wider is known


def are_to_blame(case: Case, wide: Case, before: Fit, after: Fit) -> bool:
    """Whether bounds, beyond which a fit leaves clearly less, are too narrow, and no effect that adds to a parameter
    which is known leaves as little within them. before, after: the fits within them and beyond."""
    if not are_too_narrow(case, wide, before, after):
        return False
    effects = adding_effects(case, after) if is_known_beyond(case, after) else []
    return not any(is_equal(case, after, fit_with(case, before, effect)) for effect in effects)


def is_known_beyond(case: Case, fit: Fit) -> bool:
    """Whether all parameters beyond their bounds are known, of the blocks to whose parameters effects add."""
    given = case.problem(fit.effects, fit.steps, fit.measured_only)
    ends = zip(given.names, given.lower.tolist(), given.upper.tolist(), strict=True)
    known = {name for name, low, high in ends if high - low <= KNOWN * high}
    entries = {item.name: item.block for item in given.model.entries}
    beyond = {name for name in beyond_names(case, fit) if added_to(entries[name])}
    return bool(beyond) and beyond <= known


def added_to(block: type[Block]) -> set[str]:
    """The effects that add to parameters of a block."""
    return {effect for item in block.parameters().values() if item.adds_to for effect in item.effects}


def makes_up_for_known(case: Case, beyond: Fit, effect: str) -> bool:
    """Whether an effect adds to what is known, and a fit without it is beyond that."""
    return is_known_beyond(case, beyond) and word_of(effect) in adding_effects(case, beyond)


def beyond_known_sentence(case: Case, fit: Fit) -> str:
    """A sentence about each effect of a fit without which the model fits as well beyond the bounds of what is known;
    empty where there is none."""
    text, adding = "", {item for block in fit.problem.model.blocks for item in added_to(block)}
    for effect in fit.effects[len(case.effects) :]:
        if word_of(effect) not in adding:
            continue
        wide = beyond_by(SLIP, case, refit(case, fit, effects_without(fit, effect), {}))
        if wide and makes_up_for_known(case, wide[1], effect) and is_equal(case, fit, wide[1]):
            units = dict(zip(wide[1].problem.names, wide[1].problem.units, strict=True))
            values = [f"{name} = {value:.4g} {units[name]}" for name, (value, _) in beyond_names(case, wide[1]).items()]
            text += f" Without {phrase_of(effect)} it fits as well with {listed(values)}, beyond the bounds of the job."
    return text


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
    owners = {item.block for item in fit.problem.model.entries if item.name in beyond}
    adding = {effect for block in owners for effect in added_to(block)}
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
