"""Fits of the model with effects added, accurate enough to blame the residual on the model."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.criteria import removed_rms
from pzt_ident.diagnosis.fit import NO_WORSE, Fit, fit_at
from pzt_ident.diagnosis.misfit import squared_misfit
from pzt_ident.diagnosis.modes import mechanics_at_main_mode, mechanics_without_payload
from pzt_ident.model.registry import blocks
from pzt_ident.search.descent import FAR
from pzt_ident.search.finer_steps import change_in_finer_steps, finer_steps
from pzt_ident.search.problem import Problem

Array = NDArray[np.float64]

STEP_FAULT = 0.6  # of the misfit: where finer steps of the simulation change more, the step is to blame
STEP_TOLERANCE = 0.05  # of the noise, or twice as much of the misfit: a step is halved where that changes more
FINEST = 8  # steps per sample
AT_NOISE = 1.05  # noise floors: what leaves no more is fitted from no other guess
SCANNED = 0.82 ** np.arange(1, 15)  # of a guess, or of the range of a parameter, where it is tried
SHARES = 0.5 ** np.arange(15)  # of a range, at which the amount of a part is tried


def refit(
    case: Case,
    before: Fit,
    effects: tuple[str, ...],
    guess: dict[str, float],
    rival: float = np.inf,
    other: Fit | None = None,
) -> Fit:
    """The model with other effects, started from the parameters of the fit `before` and from a guess (user's units) of
    the new ones. The new effects act on all axes or on the measured ones only, whichever fits better. A guess that
    leads to a model which fits worse than the one it is added to is astray: the new effects then begin where the model
    fits best on the way from the guess to their nulls. One that leaves an amount at its null beside another begins at
    the size of it that fits best. rival: an RMSE that a refit which stays far above it is given up for. other: the
    refit from another guess, in the place of one that leads no lower."""
    problem = case.problem(effects, before.steps)
    point = start_beside_nulls(problem, before, effects, guess)
    key = (effects, before.steps, point.tobytes(), rival)
    if key not in case.refits:
        fit = _best_of_axes(case, before, effects, problem, point, rival, other)
        if leads_astray(before, fit):
            point = start_on_the_way(problem, before, guess)
            fit = min(fit, _best_of_axes(case, before, effects, problem, point, rival), key=lambda each: each.identify)
        case.refits[key] = fit
    fit = case.refits[key]
    case.on_event({"event": "refitted", "effects": effects, "identify": fit.identify, "validate": fit.validate})
    return fit


def leads_astray(before: Fit, fit: Fit) -> bool:
    """Whether a fit with all that another one has, and more, is worse."""
    holds = {*before.problem.names} <= {*fit.problem.names} and {*before.effects} <= {*fit.effects}
    return holds and not fit.identify <= (1 + NO_WORSE) * before.identify


def start_on_the_way(problem: Problem, before: Fit, guess: dict[str, float]) -> Array:
    """The point with the new amounts at that share of a guess, from all to nothing, which leaves least: how large an
    effect is that moves a resonance does not follow from its slope at the null."""
    nulls = nulls_of_new(problem, before)
    ways = [
        {name: null + share * (guess.get(name, null) - null) for name, null in nulls.items()} for share in (*SCANNED, 0)
    ]
    points = np.array([start_of(problem, before, guess | way) for way in ways])
    return np.asarray(points[int(np.argmin(problem.loss(points)))])


def start_beside_nulls(problem: Problem, before: Fit, effects: tuple[str, ...], guess: dict[str, float]) -> Array:
    """The point of a guess; what it leaves at its null, beside another amount of the last effect on the same axis,
    begins at that of the effect's sizes which leaves least: a threshold, and what acts alike on either side of its
    null, have no slope there."""
    nulls, most = nulls_of_new(problem, before), dict(zip(problem.names, problem.upper.tolist(), strict=True))
    moved = {axis_of(name) for name, null in nulls.items() if guess.get(name, null) != null}
    resting = {name: null for name, null in nulls.items() if guess.get(name) == null and axis_of(name) in moved}
    if not resting:
        return start_of(problem, before, guess)
    ways = [
        {name: null + share * (most[name] - null) for name, null in resting.items()}
        for share in (0, *blocks[effects[-1]].sizes)
    ]
    points = np.array([start_of(problem, before, guess | way) for way in ways])
    return np.asarray(points[int(np.argmin(problem.loss(points)))])


def axis_of(name: str) -> str:
    """The axis of a parameter, by its name; empty where there is one axis."""
    return name.rsplit(".", 2)[0] if name.count(".") > 1 else ""


def nulls_of_new(problem: Problem, before: Fit) -> dict[str, float]:
    """The amounts that a fit does not have, by name, each at its null."""
    entries = {name: problem.model.entries[i] for name, i in zip(problem.names, problem.free, strict=True)}
    nulls = {name: entry.parameter.null for name, entry in entries.items() if name not in before.values}
    return {name: null for name, null in nulls.items() if null is not None}


def refit_from(
    case: Case, before: Fit, effects: tuple[str, ...], guesses: Sequence[dict[str, float]], rival: float = np.inf
) -> Fit:
    """The best of the refits from each guess, one after the other, up to one at the noise."""
    fits: list[Fit] = []
    for guess in guesses or [{}]:
        if any(fit.total < AT_NOISE * case.floor for fit in fits):
            break
        least = min(fits, key=lambda fit: fit.total, default=None)
        fits.append(refit(case, before, effects, guess, min([rival, *(fit.identify for fit in fits)]), least))
    return min(fits, key=lambda fit: fit.total)


def refit_beside(
    case: Case, fits: Sequence[Fit], effects: tuple[str, ...], guess: dict[str, float], rival: float = np.inf
) -> Fit:
    """The refit from the fit whose parameters leave least with the guess."""
    problem = case.problem(effects, fits[0].steps)
    losses = problem.loss(np.array([start_of(problem, fit, guess) for fit in fits]))
    return refit(case, fits[int(np.argmin(losses))], effects, guess, rival)


def refit_holding(case: Case, now: Fit, effects: tuple[str, ...]) -> Fit:
    """The refit with a form that holds what another effect did, from the parameters of a fit with both: the amounts
    that it has beside these begin at the share of their ranges, of some decades, that leaves least."""
    problem = case.problem(effects, now.steps)
    columns = zip(problem.names, problem.free, problem.upper.tolist(), strict=True)
    nulls = {name: (problem.model.entries[column].parameter.null, most) for name, column, most in columns}
    ends = {name: most for name, (null, most) in nulls.items() if name not in now.values and null is not None}
    guesses = [{name: float(share * most) for name, most in ends.items()} for share in SHARES]
    losses = problem.loss(np.array([start_of(problem, now, guess) for guess in guesses]))
    return refit(case, now, effects, guesses[int(np.argmin(losses))])


def start_of(problem: Problem, before: Fit, guess: dict[str, float]) -> Array:
    """The point of the guess, of the fit `before` for other parameters, and of the middle of the range of the rest."""
    known, middle = values_in(problem, before), problem.physical(np.full(problem.dimensions, 0.5))[0]
    return problem.unit_point(
        {name: guess.get(name, known.get(name, middle[i])) for i, name in enumerate(problem.names)}
    )


def values_in(problem: Problem, before: Fit) -> dict[str, float]:
    """The parameters of a fit; what one of them that the problem does not have is added to has the sum, or mechanics of
    a fixed mass are as with it, and mechanics are where a second mode was that the problem does not have, if that was
    the main one."""
    moved = mechanics_at_main_mode(before, problem.names) | mechanics_without_payload(before, problem.names)
    values, entries = before.values | moved, before.problem.model.entries
    for name, column in zip(before.problem.names, before.problem.free, strict=True):
        parameter = entries[column].parameter
        whole = name.removesuffix(parameter.name) + (parameter.adds_to or "")
        if parameter.adds_to and whole in values and name not in problem.names:
            values[whole] += values[name]
    return values


def _best_of_axes(
    case: Case,
    before: Fit,
    effects: tuple[str, ...],
    problem: Problem,
    start: Array,
    rival: float,
    other: Fit | None = None,
) -> Fit:
    """The better of the fits with the effects on all axes and on the measured ones only, where the two differ."""
    variants = [(problem, False)]
    if case.unmeasured_nulls(effects):
        restricted = case.problem(effects, before.steps, True)
        if residuals_differ(case, problem.residuals(start)[0], restricted.residuals(start)[0]):
            variants.append((restricted, True))
    fits = list[Fit]()
    for variant, measured_only in variants:
        fit = fit_at(effects, variant, case.descend(variant, start, rival), measured_only=measured_only)
        fits.append(other if other and leads_no_lower(fit, other) else refine_steps(case, fit, rival))
    return min(fits, key=lambda fit: fit.total)


def leads_no_lower(fit: Fit, other: Fit) -> bool:
    """Whether a fit leaves no less than another one of the same parameters did before its steps were refined."""
    same = fit.problem.names == other.problem.names
    return same and other.coarse is not None and fit.identify >= (1 - NO_WORSE) * other.coarse


def residuals_differ(case: Case, one: Array, other: Array) -> bool:
    """Whether two residuals differ by more than finer steps of the simulation may change."""
    return bool(np.linalg.norm(one - other) > STEP_TOLERANCE * case.floor)


def refine_steps(case: Case, fit: Fit, rival: float = np.inf, checked: Sequence[int] | None = None) -> Fit:
    """The fit, continued with finer simulation steps for the records where these change the response by
    more than a part of the misfit, or of the noise. checked: the numbers of the records in question, by default of all.
    None is refined behind the end of the budget, nor where the fit stays far above a rival whatever finer steps change.

    Where the drive is linear between samples, the signals between blocks are taken as linear too.
    """
    if not case.budget.lasts():
        return fit
    most = STEP_TOLERANCE * max(case.floor, 2 * removed_rms(fit.identify, case.floor))
    numbers = [n for n in (range(len(fit.steps)) if checked is None else checked) if fit.steps[n] < FINEST]
    errors = step_errors(case, fit, numbers)
    coarse = [n for n, error in zip(numbers, errors, strict=True) if error > most]
    if not coarse or fit.identify - errors.max() > FAR * rival:
        return fit
    steps = [count * (2 if n in coarse else 1) for n, count in enumerate(fit.steps)]
    problem = case.problem(fit.effects, steps, fit.measured_only)
    point = case.descend(problem, fit.point, rival)
    finer = fit_at(fit.effects, problem, point, fit.converged, fit.measured_only)
    finer = replace(finer, coarse=fit.coarse or fit.identify)
    return refine_steps(case, finer, rival, coarse)


def change_if_too_coarse(case: Case, fit: Fit) -> float:
    """The change of the response in finer steps of the simulation, root mean square, in units of the loss, where that
    is so much of the misfit that the step is to blame; 0 elsewhere."""
    change = float(np.sqrt(np.mean(np.square(step_errors(case, fit)))))
    return change if change > STEP_FAULT * squared_misfit(fit.identify, case.floor) ** 0.5 else 0.0


def step_errors(case: Case, fit: Fit, numbers: Iterable[int] | None = None) -> Array:
    """Change of the response of records, by default of all, in finer steps of the simulation, root mean square, in
    units of the loss: (records,)."""
    problem, theta = fit.problem, fit.problem.parameters(fit.point)
    errors = []
    for number in range(len(problem.records)) if numbers is None else numbers:
        record = problem.records[number]
        finer = case.record_with_steps(number, finer_steps(problem, record, theta))
        change = change_in_finer_steps(problem, record, finer, theta)
        errors.append(np.sqrt(np.mean(np.square(change / problem.sizes))))
    return np.array(errors)
