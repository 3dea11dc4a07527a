"""Fits from random points: of the job's own model, and of one block of a fit anew."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from functools import partial
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.criteria import adequate
from pzt_ident.diagnosis.fit import Fit, fit_at
from pzt_ident.diagnosis.modes import with_aliases
from pzt_ident.diagnosis.refit import refine_steps
from pzt_ident.diagnosis.threads import side_by_side
from pzt_ident.model.block import Modes
from pzt_ident.search.descent import descend
from pzt_ident.search.problem import Problem

Array = NDArray[np.float64]

STARTS = 240  # random points; the best are refined, a batch at a time, until two minima agree
REFINED, MOST_REFINED = 4, 24  # points in a batch, and in all batches
AGREEMENT = 0.01  # of the loss, between the two best minima
GLANCED, GLANCES = 2, 6  # points and steps from each that tell where a model leads
ENOUGH = 12  # minima that agree: a model that is not adequate is fitted from more points than lead to two, until then
ON_STARTS = 0.1  # of the budget, which ends that where two agree
STARTS_BESIDE = 60  # random points of the model with other effects, and where each costs a solution
STARTS_SOLVED = 20  # random points of a block where each costs a solution for what the response is linear in
RESTARTS = 2  # random points of one block that are refined
NEARER = 4  # power of the distance to a null, of its range, of the points near it
MOST_RESTARTED = 4  # times that all blocks are restarted, where no two minima agree


def first_fit(
    case: Case,
    seed: int,
    known: Array | None = None,
    effects: tuple[str, ...] | None = None,
    rival: float = np.inf,
) -> Fit:
    """The job's own model, or the one with other effects, fitted from random points, the fewer the better it is; not
    converged where the two best minima differ, and restarts of single blocks still lead lower. known: the point of a
    fit that was searched for, beside which one batch of random points is enough. rival: the loss of another model, far
    above which a descent that crawls is given up."""
    beside, effects = effects is not None, case.effects if effects is None else effects
    problem = case.problem(effects)
    number_of_points = STARTS_BESIDE if beside or problem.linear.columns.size else STARTS
    minima = np.empty((0, problem.dimensions)) if known is None else case.descend(problem, known)[None]
    order, agreed, least = ranked_points(problem, seed, number_of_points), False, rival
    most = MOST_REFINED if known is None else REFINED
    for number in range(0, most, REFINED):
        starts = order[number : number + REFINED]
        for minimum in side_by_side(partial(case.descend, problem, rival=least, rough=True), starts):
            minima = np.vstack([minima, minimum])
            case.on_event({"event": "fitted", "done": len(minima), "of": most + (known is not None)})
        losses = problem.loss(minima)
        least = min(rival, float(losses.min()))
        alike = np.count_nonzero(losses <= (1 + AGREEMENT) * losses.min() + 0.1 * case.floor)
        agreed = bool(alike > 1 and np.isfinite(losses.min()))
        lowest = fit_at(effects, problem, minima[np.argmin(losses)])
        if agreed and (alike >= ENOUGH or adequate(case, lowest, lowest) or case.budget.spent(ON_STARTS)):
            break
    point = min((minima[np.argmin(losses)], best_of_each_axis(case, problem, minima)), key=lambda p: problem.loss(p)[0])
    fit = fit_at(effects, problem, case.descend(problem, point), agreed or known is not None)
    return refine_steps(case, best_exchange(case, fit if fit.converged else settled(case, fit)))


def at_a_glance(case: Case, effects: tuple[str, ...]) -> float:
    """The loss to which few steps from few random points lead the model with other effects."""
    problem = case.problem(effects)
    starts = ranked_points(problem, 0, STARTS_BESIDE)[:GLANCED]
    points = np.array([descend(problem, start, GLANCES, going=case.budget.lasts) for start in starts])
    return float(problem.loss(points).min())


def best_exchange(case: Case, fit: Fit) -> Fit:
    """The best of the fit and of those with two modes the other way round or, where it does not reach the noise, with a
    mode at another frequency. Modes whose bounds overlap are alike but for their order, and in the wrong one a mode may
    end on a bound short of where it is: many starts then agree on it."""
    ordered = best_of(case, fit, exchanged(fit.problem, fit.point) if fit.on_bounds else ())
    return ordered if adequate(case, ordered, ordered) else best_alias(case, ordered)


def best_alias(case: Case, fit: Fit) -> Fit:
    """The best of the fit and of those with a mode at a frequency of which the samples look alike."""
    return best_of(case, fit, [fit.problem.unit_point(values) for values in with_aliases(fit)])


def best_of(case: Case, fit: Fit, starts: Iterable[Array]) -> Fit:
    """The best of the fit and of those from other starts, while the budget lasts."""
    fits = [fit]
    for start in starts:
        if not case.budget.lasts():
            break
        point = case.descend(fit.problem, start)
        fits.append(fit_at(fit.effects, fit.problem, point, fit.converged, fit.measured_only))
    return best_with_fine_steps(case, fits, lambda candidate: candidate.identify)


def best_with_fine_steps(case: Case, fits: Sequence[Fit], error: Callable[[Fit], float]) -> Fit:
    """The best fit, or the first one where the best is worse than that with steps that are fine enough for it: a mode
    that rings at the rate of the samples may stand in for anything between them."""
    best = min(fits, key=error)
    return best if best is fits[0] else min(fits[0], refine_steps(case, best), key=error)


def exchanged(problem: Problem, point: Array) -> Array:
    """(pairs of modes, dimensions): the point with all free parameters of two modes exchanged, within their bounds."""
    values, places = problem.physical(point)[0], dict[int, dict[tuple[int, str], int]]()
    for place, column in enumerate(problem.free):
        entry = problem.model.entries[column]
        if issubclass(entry.block, Modes):
            word, number = entry.word.rsplit("_", 1)
            places.setdefault(int(number), {})[entry.axis, word] = place
    points = []
    for one, other in combinations(places.values(), 2):
        both, swapped = one.keys() & other.keys(), values.copy()
        swapped[[one[key] for key in both]] = values[[other[key] for key in both]]
        swapped[[other[key] for key in both]] = values[[one[key] for key in both]]
        points.append(problem.unit_point(dict(zip(problem.names, swapped, strict=True))))
    return np.array(points)


def settled(case: Case, fit: Fit) -> Fit:
    """The fit that restarts of single blocks lead to; converged if the last of them led no lower."""
    for _ in range(MOST_RESTARTED):
        lower = restart(case, fit)
        if not lower.identify < (1 - AGREEMENT) * fit.identify - 0.1 * case.floor:
            return replace(lower, converged=bool(np.isfinite(lower.identify)))
        fit = lower
    return fit


def ranked_points(problem: Problem, seed: int, count: int) -> Array:
    """(count, dimensions) random points, half of them with effects near their nulls, the best first."""
    rng = np.random.default_rng(seed)
    points = rng.uniform(size=(count, problem.dimensions))
    near = np.isfinite(nulls := places_of_nulls(problem)) & (rng.random((count, 1)) < 0.5)
    points = np.where(near, towards(nulls, points), points)
    return points[np.argsort(problem.rough().loss(points), kind="stable")]


def places_of_nulls(problem: Problem) -> Array:
    """Where in their ranges parameters are null, (dimensions,); NaN for those that have no null there."""
    nulls = [problem.model.entries[column].parameter.null for column in problem.free]
    known = {name: null for name, null in zip(problem.names, nulls, strict=True) if null is not None}
    middle = dict(zip(problem.names, problem.physical(np.full(problem.dimensions, 0.5))[0].tolist(), strict=True))
    places = problem.unit_point(middle | known)
    within = [
        name in known and low <= known[name] <= high
        for name, low, high in zip(problem.names, problem.lower, problem.upper, strict=True)
    ]
    return np.where(within, places, np.nan)


def towards(places: Array, points: Array) -> Array:
    """Points moved towards places in the unit cube, most of them nearly there."""
    room = np.where(points > places, 1 - places, places)
    return places + (points - places) * np.abs((points - places) / np.where(room > 0, room, 1.0)) ** (NEARER - 1)


def best_of_each_axis(case: Case, problem: Problem, minima: Array) -> Array:
    """The minimum from the parameters that each axis has in the minimum which is best for its own response: axes that
    are nearly independent of each other need not be lucky together."""
    errors = np.nan_to_num(problem.by_axis(minima), nan=np.inf)
    best = dict(zip(problem.model.measured, np.argmin(errors, axis=0), strict=True))
    axes = [problem.model.entries[column].axis for column in problem.free]
    point = np.array([minima[best.get(axis, np.argmin(errors.sum(axis=1)))][i] for i, axis in enumerate(axes)])
    return case.descend(problem, point) if len(set(best.values())) > 1 else point


def restart(case: Case, fit: Fit, block: str = "", starts_per_block: int = RESTARTS, share: float = 1.0) -> Fit:
    """The best of the fit and of fits restarted from other values of one block, on all axes together, the rest kept: of
    each block in turn but of those that guess from a residual, as the frequency of a line, or of `block` only. A block
    may rest in a side minimum, such as a distant resonance, when it was fitted beside a misfit that has since been
    explained, or from a poor guess. share: of the budget, after which none is begun."""
    problem = fit.problem
    owners = [problem.model.entries[column].block for column in problem.free]
    rng = np.random.default_rng(0)
    fits = [fit]
    chosen = [owner for owner in owners if owner.name == block or (not block and not hasattr(owner, "guess"))]
    for owner in dict.fromkeys(chosen):
        if case.budget.spent(share) or not case.budget.lasts():
            break
        restarted = np.array([column_owner is owner for column_owner in owners])
        starts = restarts(problem, fit.point, restarted, random_points(problem, rng))[:starts_per_block]
        minima = np.array([fit.point, *(case.descend(problem, start, fit.identify) for start in starts)])
        for point in (*minima[1:], best_of_each_axis(case, problem, minima)):
            fits.append(fit_at(fit.effects, problem, point, fit.converged, fit.measured_only))
    best = best_with_fine_steps(case, fits, lambda candidate: candidate.total)
    if block or case.budget.spent(share):
        return best
    return min(best, best_alias(case, best), key=lambda candidate: candidate.total)


def restarts(problem: Problem, point: Array, restarted: NDArray[np.bool_], points: Array) -> Array:
    """(starts, dimensions): the point with parameters from random points, the best first: each axis has its own best,
    but for modes, which have all axes in common, and without a response, where they are the best for all."""
    errors = problem.rough_by_axis(np.where(restarted, points, point), point)
    by_axis, together = (np.argsort(each, axis=0, kind="stable") for each in (errors, problem.loss_of(errors)))
    starts = np.tile(point, (len(points), 1))
    for i in np.flatnonzero(restarted):
        entry, measured = problem.model.entries[problem.free[i]], problem.model.measured
        own = entry.axis in measured and not issubclass(entry.block, Modes)
        starts[:, i] = points[by_axis[:, measured.index(entry.axis)] if own else together, i]
    return starts


def random_points(problem: Problem, rng: np.random.Generator) -> Array:
    """(points, dimensions) random points; half of them keep parameters whose lower bound is 0 near it."""
    points = rng.uniform(size=(STARTS_SOLVED if problem.linear.columns.size else STARTS, problem.dimensions))
    near = (problem.lower == 0) & (rng.random((len(points), 1)) < 0.5)
    return np.where(near, points**NEARER, points)
