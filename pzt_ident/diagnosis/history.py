"""Records that start in the middle of a motion: the model as given, with what the stage went through before them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.notation import listed
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.criteria import CLEAR, DECISIVE, LEAST_SHARE, adequate, removed_rms
from pzt_ident.diagnosis.fit import Fit, fit_at
from pzt_ident.diagnosis.forms import NEARLY_ALL, is_far_behind
from pzt_ident.diagnosis.misfit import share_explained, squared_misfit
from pzt_ident.diagnosis.possible import applicable
from pzt_ident.diagnosis.refit import refit, refit_from, start_of
from pzt_ident.diagnosis.score import scorer_of
from pzt_ident.diagnosis.scores import promises_most
from pzt_ident.diagnosis.ties import TIE
from pzt_ident.diagnosis.undetermined import has_operator
from pzt_ident.diagnosis.verdict import Diagnosis
from pzt_ident.engine.simulator import Simulator
from pzt_ident.model.block import Operator, Place
from pzt_ident.model.registry import blocks, word_of

Array = NDArray[np.float64]

HISTORY = "history"  # the word of the block
BEFORE = "what was before the records"  # the step after which a model follows it
ALIKE = ("drift",)  # a memory that fades slowly from what was before, in each record from another place, is one
TRIED = 3  # effects beside which it is looked for
PROMISING = 0.1  # of the misfit: what is removed at once, with all parameters as they are


def with_history(case: Case, first: Fit, diagnosis: Diagnosis) -> tuple[Case, Fit] | None:
    """The case whose model follows what was before the records, and the fit as given in it, where that removes most of
    the misfit or more than any effect, alone or beside one of the best of these; None elsewhere, and where an effect
    alone leads to the noise as well, of no more parameters if both do, or another one beside it, or beside the one that
    it shows behind, promises nearly all that is left; beside one that explains nearly all none that stays far above it.
    diagnosis: of the fit."""
    if has_history(first) or not has_operator(case):
        return None
    effects = sorted((item.fit for item in diagnosis.passing if item.fit), key=lambda fit: fit.total)
    rival = min((fit.identify for fit in effects), default=np.inf)
    accounted = bool(effects) and share_explained(first.total, effects[0].total, case.floor) >= NEARLY_ALL
    best = beside(case, first, DECISIVE if accounted else PROMISING, rival)
    left = best[1].total if best else first.total
    enough_alone = [fit for fit in effects if adequate(case, first, fit) and not takes_more(case, first, fit, best)]
    if any(removed_rms(fit.total, left) < TIE * case.floor for fit in enough_alone):
        return None
    share = share_explained(first.total, best[1].total, case.floor) if best else 0.0
    least = DECISIVE if best and any(removed_rms(fit.total, best[1].total) < 0 for fit in effects) else LEAST_SHARE
    if best and share >= least:
        if not adequate(case, first, best[1]) and lead_on(case, first, effects):
            return None
        given_up = best[1].identify > rival
        return (best[0], refit(best[0], best[1], first.effects, {})) if given_up else best
    for fit in [fit for fit in effects if not (accounted and is_far_behind(case, fit, effects[0]))][:TRIED]:
        behind = history_behind(case, first, fit, rival)
        if behind and not lead_on(case, first, [fit]):
            return behind
    return None


def takes_more(case: Case, first: Fit, fit: Fit, aged: tuple[Case, Fit] | None) -> bool:
    """Whether a fit with an effect has more parameters than one that follows what was before and is adequate, too."""
    return aged is not None and adequate(case, first, aged[1]) and fit.freedom > aged[1].freedom


def lead_on(case: Case, first: Fit, effects: Sequence[Fit]) -> bool:
    """Whether an effect promises nearly all that the best of some fits with another one leaves."""
    return bool(effects and promises_most(case, first, effects[0], NEARLY_ALL))


def history_behind(case: Case, first: Fit, end: Fit, rival: float = np.inf) -> tuple[Case, Fit] | None:
    """The same where what was before the records shows behind the effects of a fit, most of what these leave; else
    None. rival: as of `beside`."""
    if has_history(end) or not has_operator(case):
        return None
    best = beside(case, end, rival=min(rival, enough(case, end)))
    if best is None or share_explained(end.total, best[1].total, case.floor) < DECISIVE:
        return None
    return best[0], refit(best[0], first, first.effects, {})


def enough(case: Case, fit: Fit) -> float:
    """The RMSE of the identification records that explains most of the misfit which a fit leaves of them."""
    return float(np.sqrt(fit.identify**2 - DECISIVE * squared_misfit(fit.identify, case.floor)))


def beside(case: Case, fit: Fit, least: float = PROMISING, rival: float = np.inf) -> tuple[Case, Fit] | None:
    """The case whose model follows what was before the records, with as few reversals as do, and the refit in it; None
    where it promises less than a share of the misfit. More reversals are asked for where the last ones show. rival: an
    RMSE that a refit which stays far above it is given up for."""
    best: tuple[Case, Fit] | None = None
    for item in blocks.forms(HISTORY) if remembers_reversals(case) else [HISTORY]:
        aged = case.with_words((item, *case.words))
        if case.budget.allows(BEFORE) and promise(aged, fit) >= least:
            other = refit(aged, fit, fit.effects, {}, rival)
            if best is None or removed_rms(best[1].total, other.total) > CLEAR * case.floor:
                best = aged, other
        shown = share_explained(fit.total, best[1].total, case.floor) if best else 0.0
        if shown < LEAST_SHARE or (best and adequate(case, fit, best[1])):
            break
    return best


def remembers_reversals(case: Case) -> bool:
    """Whether the hysteresis has more than one number to remember, as plays have."""
    return any(block.place == Place.OPERATOR and not issubclass(block, Operator) for block in blocks.chain(case.words))


def at_rest(case: Case) -> Case:
    """The case whose model starts every record from rest."""
    return case.with_words([item for item in case.words if word_of(item) != HISTORY])


def fits_at_rest(rested: Case, end: Fit) -> Iterator[Fit]:
    """The last model where every record starts from rest, as it is and with each effect that leaves the same trace, if
    the model is clearly worse without it."""
    fit = refit(rested, end, end.effects, {})
    yield fit
    words = [word for word in ALIKE if word in applicable(rested, end.effects)]
    for score in (scorer_of(rested, fit).score(word) for word in words):
        other = refit_from(rested, fit, (*end.effects, score.effect), score.guesses)
        if removed_rms(fit.total, other.total) > CLEAR * rested.floor:
            yield other


def has_history(fit: Fit) -> bool:
    """Whether a model follows what was before the records."""
    return any(block.lead for block in fit.problem.model.blocks)


def promise(aged: Case, first: Fit) -> float:
    """The share of the misfit that goes with what was before the records, all parameters being as they are."""
    problem = aged.problem(first.effects, first.steps)
    fit = fit_at(first.effects, problem, start_of(problem, first, {}))
    return share_explained(first.total, fit.total, aged.floor)


def history_sentence(case: Case, fit: Fit) -> str:
    """A sentence on the records of which the start shows what was before them; empty where there are none."""
    if not has_history(fit):
        return ""
    theta = fit.problem.parameters(fit.point)
    told = [each.record.name for each in fit.problem.every_simulator if shows(case, each, theta)]
    return f" {listed(told)} did not start at rest, and the model follows what was before." if told else ""


def shows(case: Case, simulator: Simulator, theta: Array) -> bool:
    """Whether a record shows what was before it."""
    moved = simulator.simulate(simulator.amounts.complete(theta)) - simulator.simulate(theta)
    rms = np.std(moved[0, :, simulator.record.settle :], axis=1) / case.error_scales
    return bool((rms > CLEAR * case.floors).any())
