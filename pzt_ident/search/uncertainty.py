"""What the data say of each parameter."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.units import factor
from pzt_ident.search.problem import Problem

Array = NDArray[np.float64]

LOOSE = 0.2  # of its search range: a standard error above this says nothing
FLAT = 0.01  # of the RMSE: a parameter may go where the RMSE rises by less
WIDE = 0.5  # of its search range, over which it may go
EDGE = 1e-4  # of its search range
TIED = 0.995  # correlation of two parameters that are known together only


class Estimate(NamedTuple):
    """One free parameter in the user's units; standard_error is None where it is not determined. `at` is the drive that
    one of a counted parameter stands for, and its unit."""

    name: str
    value: float
    unit: str
    lower: float
    upper: float
    standard_error: float | None
    scale: str
    verdict: str
    note: str
    at: tuple[float, str] | None = None


def estimates(problem: Problem, point: Array) -> tuple[list[Estimate], Array]:
    """Value, standard error and verdict of each free parameter and of those that are solved for, and the correlations
    of the former (free, free).

    Standard errors are those of least squares with correlated residuals: (J'J)^-1 M (J'J)^-1 with M summed over
    blocks of neighbouring samples (White 1980; Newey & West 1987). A parameter is not determined where its standard
    error, or the stretch over which it changes the RMSE by less than one percent, takes up its search range.
    """
    covariance = covariance_of(problem.jacobian(point), problem.residuals(point)[0])
    error = np.sqrt(np.diag(covariance))
    value = problem.physical(point)[0]
    slope = (problem.physical(point + 1e-6) - problem.physical(point - 1e-6))[0] / 2e-6
    flat = flat_share(problem, point)
    scale = np.where(error > 0, error, 1)
    correlation = np.nan_to_num(covariance / np.outer(scale, scale))
    found = []
    for i, name in enumerate(problem.names):
        verdict, note = judge(point[i], error[i], flat[i])
        known = float(error[i] * abs(slope[i])) if verdict != "not determined" else None
        if verdict == "determined":
            note = doubts(problem, i, value[i], known or 0.0, correlation[i])
        lower, upper = float(problem.lower[i]), float(problem.upper[i])
        axis = "log" if problem.log[i] else "linear"
        found.append(Estimate(name, float(value[i]), problem.units[i], lower, upper, known, axis, verdict, note))
    return found + solved(problem, point), correlation


def covariance(problem: Problem, point: Array) -> Array:
    """Covariance of the free parameters in the user's units, (free, free)."""
    slope = (problem.physical(point + 1e-6) - problem.physical(point - 1e-6))[0] / 2e-6
    return covariance_of(problem.jacobian(point), problem.residuals(point)[0]) * np.outer(slope, slope)


def solved(problem: Problem, point: Array) -> list[Estimate]:
    """Of the parameters that the response is linear in; those at zero are held there for their errors."""
    theta = problem.parameters(point)[0]
    columns = problem.linear.columns
    if not columns.size:
        return []
    own = problem.linear.solved(theta)
    share, active = own.values / own.units, own.values != 0
    jacobian = np.vstack([own.columns, own.prior])[:, active]
    error = np.zeros(columns.size)
    if active.any():
        error[active] = np.sqrt(np.diag(covariance_of(jacobian, np.append(own.residual, own.prior @ share))))
    found = []
    for i, column in enumerate(columns):
        entry, unit = problem.model.entries[column], problem.all_units[column]
        peers = [j for j, other in enumerate(columns) if problem.model.entries[other].parameter is entry.parameter]
        verdict, note = judge_solved(bool(own.columns[:, i].any()), share[i], error[i], share[peers].max())
        known = float(error[i] * abs(own.units[i])) / factor(unit) if verdict == "determined" and active[i] else None
        lower, upper = sorted(bound * own.units[i] / factor(unit) for bound in entry.parameter.bounds)
        value = float(own.values[i]) / factor(unit)
        stands = problem.model.stands(column, theta)
        drive = problem.records[0].drive_units[entry.axis]
        at = None if stands is None else (float(stands) / factor(drive), drive)
        found.append(Estimate(entry.name, value, unit, lower, upper, known, "linear", verdict, note, at))
    return found


def judge_solved(seen: bool, value: float, error: float, largest: float) -> tuple[str, str]:
    """Verdict and its reason, the value and its standard error beside the largest of its like."""
    if not seen:
        return "not moved", "no record moves it: these data say nothing of it"
    if value == 0:
        return "determined", "zero: less than nothing is not allowed"
    if error > largest / 2:
        return "not determined", "its standard error is half the largest of its like, or more"
    return "determined", ""


def doubts(problem: Problem, i: int, value: float, error: float, correlation: Array) -> str:
    """What to know of a determined parameter: that its sign is open, or with which other it is tied."""
    tied = [name for j, name in enumerate(problem.names) if j != i and abs(correlation[j]) > TIED]
    said = ["zero lies within two standard errors"] if abs(value) < 2 * error else []
    return "; ".join(said + ([f"known only together with {', '.join(tied)}"] if tied else []))


def judge(place: float, error: float, flat: float) -> tuple[str, str]:
    """Verdict and its reason from the place, the standard error and the flat stretch, as shares of the range."""
    if not error < LOOSE:
        return "not determined", "its standard error is as wide as its search range: these data do not see it"
    if flat > WIDE:
        return "not determined", f"over {flat:.0%} of its search range it changes the RMSE by less than 1 %"
    for side, on in (("lower", place < EDGE), ("upper", place > 1 - EDGE)):
        if on:
            return f"on its {side} bound", "the best value may lie beyond it: widen the bounds, or doubt the model"
    return "determined", ""


def covariance_of(jacobian: Array, residual: Array, blocks: int = 40) -> Array:
    """Covariance of the parameters in the cube; huge along directions that the data do not see."""
    u, s, vt = np.linalg.svd(jacobian, full_matrices=False)
    seen = np.maximum(s, 1e-9 * max(s.max(initial=0), 1e-300))
    parts = np.array_split(u * residual[:, None], blocks)
    sums = np.array([part.sum(axis=0) for part in parts])
    meat = sums.T @ sums
    white = residual @ residual / max(1, residual.size - s.size)
    meat += np.diag(np.maximum(white - np.diag(meat), 0))  # an unseen direction has no gradient of its own
    turn = vt.T / seen
    return turn @ meat @ turn.T


def flat_share(problem: Problem, point: Array, steps: int = 24) -> Array:
    """Share of each parameter's range over which the loss stays within FLAT of the best, the others held: (free,)."""
    grid = (np.arange(steps) + 0.5) / steps
    count = problem.dimensions
    tries = np.tile(point, (count * steps, 1))
    for i in range(count):
        tries[i * steps : (i + 1) * steps, i] = grid
    losses = problem.loss(tries).reshape(count, steps)
    return (losses <= (1 + FLAT) * problem.loss(point)[0]).mean(axis=1)
