"""Steps from a second mode that is one of the mechanics."""

from __future__ import annotations

import numpy as np

from pzt_ident.diagnosis.budget import WHOLE
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.criteria import removed_rms
from pzt_ident.diagnosis.exchange import exchange_step
from pzt_ident.diagnosis.fit import Fit, fit_at
from pzt_ident.diagnosis.modes import mechanics_at_main_mode, with_modes_at_second
from pzt_ident.diagnosis.refit import refine_steps, refit, start_of
from pzt_ident.diagnosis.step import Step, effects_without, explained_share
from pzt_ident.diagnosis.ties import TIE
from pzt_ident.diagnosis.verdict import diagnose

PLACES = 2  # of a mode of the mechanics that are refitted: the best of those where a second mode may be it


def exchange_main_mode(case: Case, first: Fit, now: Fit) -> list[Step]:
    """The step that takes out a second mode which is the main one, with the mechanics of the job where that is, or puts
    the effect in its place for which they stood in, any that fits as well."""
    for effect in now.effects[len(first.effects) :]:
        others = case.problem(effects_without(now, effect), now.steps)
        if not mechanics_at_main_mode(now, others.names) or not case.budget.allows("mechanics at another mode", WHOLE):
            continue
        without = refit(case, now, effects_without(now, effect), {})
        if removed_rms(without.total, now.total) < TIE * case.floor:
            return [Step(without, None, effect, {}, explained_share(case, now, without))]
        there = fit_at(without.effects, others, start_of(others, now, {}))
        best = diagnose(case, there, first).best
        if best and best.fit and removed_rms(best.fit.total, now.total) < TIE * case.floor:
            return [exchange_step(case, now, best.fit, effect)]
    return []


def exchange_second_mode(case: Case, first: Fit, now: Fit) -> list[Step]:
    """The step that takes out a second mode where one of the mechanics, that rested elsewhere, does as well there."""
    for effect in now.effects[len(first.effects) :]:
        effects = effects_without(now, effect)
        others = case.problem(effects, now.steps, now.measured_only)
        points = np.array([others.unit_point(values) for values in with_modes_at_second(now, others.names)])
        if not points.size or not case.budget.allows("mechanics at another mode", WHOLE):
            continue
        best = points[np.argsort(others.loss(points), kind="stable")[:PLACES]]
        fits = [fit_at(effects, others, case.descend(others, point), True, now.measured_only) for point in best]
        without = min((refine_steps(case, fit) for fit in fits), key=lambda fit: fit.total)
        if removed_rms(without.total, now.total) < TIE * case.floor:
            return [Step(without, None, effect, {}, explained_share(case, now, without))]
    return []
