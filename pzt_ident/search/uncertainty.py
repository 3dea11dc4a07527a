"""Value, standard error and verdict of each parameter."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.units import factor
from pzt_ident.search.problem import Problem
from pzt_ident.search.profile import TWO_SIDED, intervals

Array = NDArray[np.float64]

LOOSE = 0.2  # of the search range: with a larger standard error a parameter is not determined
FLAT = 0.01  # of the RMSE: a smaller change of the RMSE is negligible
WIDE = 0.5  # of the search range: with a negligible change over more, a parameter is not determined
EDGE = 1e-4  # of the search range: a parameter this close to a bound is on it
SAME = 1.001  # times the best RMSE: what runs with less reach is the same
SCATTER = 0.01  # of the search range, by which such runs may put a parameter beyond its interval
TIED = 0.995  # correlation above which two parameters are known only together


class Estimate(NamedTuple):
    """One free parameter in the user's units; standard_error is None if it is not determined. `at`: for a parameter of
    a branch, the drive at which the branch acts, and its unit. `interval`: of 95 %, None where it has none."""

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
    interval: tuple[float, float] | None = None


def estimates(problem: Problem, point: Array, going: Callable[[], bool] = lambda: True) -> tuple[list[Estimate], Array]:
    """Estimates of the free parameters and of the linear ones, and the correlations of the free ones (free, free).

    Standard errors are those of least squares with correlated residuals: (J'J)^-1 M (J'J)^-1 with M summed over
    blocks of neighbouring samples (White 1980; Newey & West 1987), in no direction less than white noise or noise with
    the spectrum of the residual gives: blocks miss what is correlated over their ends. Where the profile of the loss is
    flatter than its curvature says, the standard error is that of the interval which the profile gives. A parameter is
    not determined if its standard error exceeds LOOSE, or if it changes the RMSE by less than one percent over more
    than WIDE, of its search range. going: as of `intervals`.
    """
    jacobian = problem.jacobian(point)
    covariance = covariance_of(jacobian, problem.residuals(point)[0])
    error = np.sqrt(np.diag(covariance))
    ends = intervals(problem, point, jacobian, error, going)
    misleads = np.ptp(ends, axis=1) > 1.01 * 2 * TWO_SIDED * error
    error = np.where(misleads, np.ptp(ends, axis=1) / (2 * TWO_SIDED), error)
    value = problem.physical(point)[0]
    slope = (problem.physical(point + 1e-6) - problem.physical(point - 1e-6))[0] / 2e-6
    flat = flat_share(problem, point)
    scale = np.where(error > 0, error, 1)
    correlation = np.nan_to_num(covariance / np.outer(scale, scale))
    rows = []
    for i, name in enumerate(problem.names):
        verdict, note = verdict_of(point[i], error[i], flat[i])
        interval = interval_of(problem, point, i, ends[i])
        standard_error = float(error[i] * abs(slope[i])) if verdict != "not determined" else None
        if verdict == "determined":
            note = caution(problem, i, value[i], standard_error or 0.0, correlation[i])
        lower, upper = float(problem.lower[i]), float(problem.upper[i])
        scale_word = "log" if problem.log[i] else "linear"
        facts = (problem.units[i], lower, upper, standard_error, scale_word, verdict, note, None)
        rows.append(Estimate(name, float(value[i]), *facts, interval if standard_error is not None else None))
    return rows + linear_estimates(problem, point), correlation


def interval_of(problem: Problem, point: Array, i: int, ends: Array) -> tuple[float, float]:
    """The ends of an interval in the user's units. Of a logarithmic parameter they are not symmetric; beyond the cube,
    where it has none, they are as far from the value as its slope says."""
    slope = (problem.physical(point + 1e-6) - problem.physical(point - 1e-6))[0, i] / 2e-6
    value, in_units = problem.physical(point)[0, i], []
    for end in ends:
        moved = point.copy()
        moved[i] = np.clip(end, 0, 1)
        in_units.append(
            float(problem.physical(moved)[0, i]) if 0 <= end <= 1 else float(value + slope * (end - point[i]))
        )
    return min(in_units), max(in_units)


def covariance(problem: Problem, point: Array) -> Array:
    """Covariance of the free parameters in the user's units, (free, free)."""
    slope = (problem.physical(point + 1e-6) - problem.physical(point - 1e-6))[0] / 2e-6
    return covariance_of(problem.jacobian(point), problem.residuals(point)[0]) * np.outer(slope, slope)


def linear_estimates(problem: Problem, point: Array) -> list[Estimate]:
    """Estimates of the linear parameters; for the standard errors those at zero are held there."""
    theta = problem.parameters(point)[0]
    columns = problem.linear.columns
    if not columns.size:
        return []
    solution = problem.linear.solved(theta)
    multiple, active = solution.values / solution.units, solution.values != 0
    jacobian = np.vstack([solution.columns, solution.prior])[:, active]
    error = np.zeros(columns.size)
    if active.any():
        residual = np.append(solution.residual, solution.prior @ multiple)
        error[active] = np.sqrt(np.diag(covariance_of(jacobian, residual)))
    rows = []
    for i, column in enumerate(columns):
        entry, unit = problem.model.entries[column], problem.all_units[column]
        peers = [j for j, other in enumerate(columns) if problem.model.entries[other].parameter is entry.parameter]
        visible = bool(solution.columns[:, i].any())
        verdict, note = verdict_of_linear(visible, multiple[i], error[i], multiple[peers].max())
        known = verdict == "determined" and active[i]
        standard_error = float(error[i] * abs(solution.units[i])) / factor(unit) if known else None
        lower, upper = sorted(bound * solution.units[i] / factor(unit) for bound in entry.parameter.bounds)
        value = float(solution.values[i]) / factor(unit)
        threshold = problem.model.threshold_of(column, theta)
        drive_unit = problem.records[0].drive_units[entry.axis]
        at = None if threshold is None else (float(threshold) / factor(drive_unit), drive_unit)
        rows.append(Estimate(entry.name, value, unit, lower, upper, standard_error, "linear", verdict, note, at))
    return rows


def judged(best: dict[str, Any], runs: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """The best run, its parameters not determined where runs that reach the same RMSE put them beyond their intervals,
    by more than SCATTER of the search range."""
    same = [run for run in runs if run["rmse"]["identify"] <= SAME * best["rmse"]["identify"]]
    parameters = {}
    for name, parameter in best["parameters"].items():
        values = [run["parameters"][name]["value"] for run in same if name in run["parameters"]]
        parameters[name] = parameter if agree(parameter, values) else parameter | scattered(parameter, values)
    return best | {"parameters": parameters}


def agree(parameter: Mapping[str, Any], values: Sequence[float]) -> bool:
    """Whether the values of a parameter lie within its interval, or close to it. True where it has none."""
    if parameter["verdict"] != "determined" or not parameter.get("interval"):
        return True
    places = [place_of(parameter, value) for value in values]
    low, high = (place_of(parameter, end) for end in parameter["interval"])
    return all(low - SCATTER < place < high + SCATTER for place in places)


def place_of(parameter: Mapping[str, Any], value: float) -> float:
    """Where a value is in the search range, 0 to 1."""
    low, high = parameter["lower"], parameter["upper"]
    if parameter["scale"] == "log":
        low, high, value = np.log(low), np.log(high), np.log(max(value, low * 1e-3))
    return float((value - low) / ((high - low) or 1.0))


def scattered(parameter: Mapping[str, Any], values: Sequence[float]) -> dict[str, Any]:
    unit = f" {parameter['unit']}".removesuffix(" 1")
    note = f"runs of the same RMSE put it at {min(values):.3g} to {max(values):.3g}{unit}"
    return {"verdict": "not determined", "note": note, "standard_error": None, "interval": None}


def verdict_of_linear(visible: bool, value: float, error: float, largest: float) -> tuple[str, str]:
    """Verdict and reason for a linear parameter. visible: the response depends on it. value, error, largest: the value,
    its standard error and the largest value of the same curve, as multiples of the unit."""
    if not visible:
        return "not moved", "no record depends on it: these data give no information about it"
    if value == 0:
        return "determined", "zero, its bound: it may not change its sign"
    if error > largest / 2:
        return "not determined", "its standard error is more than half of the largest value of its kind"
    return "determined", ""


def caution(problem: Problem, i: int, value: float, error: float, correlation: Array) -> str:
    """Reservations about a determined parameter: an uncertain sign, or a strong correlation with another."""
    tied = [name for j, name in enumerate(problem.names) if j != i and abs(correlation[j]) > TIED]
    sentences = ["zero lies within two standard errors"] if abs(value) < 2 * error else []
    return "; ".join(sentences + ([f"known only together with {', '.join(tied)}"] if tied else []))


def verdict_of(place: float, error: float, flat: float) -> tuple[str, str]:
    """Verdict and reason from the value, its standard error and the flat interval, as shares of the search range."""
    if not error < LOOSE:
        return (
            "not determined",
            "its standard error is a fifth of its search range or more: these data do not determine it",
        )
    if flat > WIDE:
        return "not determined", f"over {flat:.0%} of its search range it changes the RMSE by less than 1 %"
    for side, reached in (("lower", place < EDGE), ("upper", place > 1 - EDGE)):
        if reached:
            return f"on its {side} bound", "the best value may lie beyond it: widen the bounds, or doubt the model"
    return "determined", ""


def covariance_of(jacobian: Array, residual: Array, blocks: int = 40) -> Array:
    """Covariance of the parameters in the unit cube, (free, free); huge along directions that the data leave open."""
    u, s, vt = np.linalg.svd(jacobian, full_matrices=False)
    singular = np.maximum(s, 1e-9 * max(s.max(initial=0), 1e-300))
    parts = np.array_split(u * residual[:, None], blocks)
    sums = np.array([part.sum(axis=0) for part in parts])
    meat = sums.T @ sums
    white = residual @ residual / max(1, residual.size - s.size)
    least = np.maximum(white, stationary(u, residual))  # a direction without influence has no gradient
    meat += np.diag(np.maximum(least - np.diag(meat), 0))
    bread = vt.T / singular
    return bread @ meat @ bread.T


def stationary(directions: Array, residual: Array) -> Array:
    """Variance of each direction's sum with noise that has the spectrum of the residual: (directions,)."""
    weights, variance = autoregression(residual)
    length = 1 << (2 * residual.size - 1).bit_length()
    density = variance / np.abs(np.fft.rfft(weights, length)) ** 2
    density[1:-1] *= 2
    return np.array([density @ np.abs(np.fft.rfft(column, length)) ** 2 for column in directions.T]) / length


def autoregression(residual: Array) -> tuple[Array, float]:
    """Weights a, from 1, and variance of e in sum_i a_i r[k - i] = e[k], from the equations of Yule and Walker. The
    order is that of the least AIC (Akaike 1974), 10 log10 of the number of samples at most."""
    from scipy.linalg import solve_toeplitz

    size = residual.size
    most = min(size - 1, int(10 * np.log10(size)))
    lags = np.fft.irfft(np.abs(np.fft.rfft(residual, 2 * size)) ** 2)[: most + 1] / size
    best, least = (np.ones(1), float(lags[0])), 0.0
    for order in range(1, most + 1 if lags[0] > 0 else 1):
        weights = np.append(1.0, solve_toeplitz(lags[:order], -lags[1 : order + 1]))
        variance = float(weights @ lags[: order + 1])
        if not variance > 1e-12 * lags[0]:
            break
        criterion = size * np.log(variance / lags[0]) + 2 * order
        if criterion < least:
            best, least = (weights, variance), criterion
    return best


def flat_share(problem: Problem, point: Array, steps: int = 24) -> Array:
    """Share of each parameter's range over which the loss stays within FLAT of the best, the others fixed: (free,)."""
    grid = (np.arange(steps) + 0.5) / steps
    count = problem.dimensions
    points = np.tile(point, (count * steps, 1))
    for i in range(count):
        points[i * steps : (i + 1) * steps, i] = grid
    losses = problem.loss(points).reshape(count, steps)
    return (losses <= (1 + FLAT) * problem.loss(point)[0]).mean(axis=1)
