"""Value, standard error and verdict of each parameter."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.units import factor
from pzt_ident.model.parameter import NOTHING_BEYOND
from pzt_ident.search.problem import Problem
from pzt_ident.search.profile import TWO_SIDED, intervals
from pzt_ident.search.sandwich import Sandwich

Array = NDArray[np.float64]

LOOSE = 0.2  # of the search range: with a larger standard error a parameter is not determined
FLAT = 0.01  # of the RMSE: a smaller change of the RMSE is negligible
WIDE = 0.5  # of the search range: with a negligible change over more, a parameter is not determined
EDGE, SURELY = 1e-4, 2.0  # of the search range, and standard errors: a parameter this close to a bound is on it
SAME = 1 + FLAT  # times the best RMSE: what runs with less reach is the same
SCATTER = 0.01  # of the search range, by which such runs may put a parameter beyond its interval
TIED = 0.995  # correlation above which two parameters are known only together
EXTRAPOLATED = 5.0  # times the longest record: of a time constant beyond, records hold the beginning


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

    Standard errors are those of least squares with correlated residuals, see `Sandwich`: blocks of neighbouring samples
    alone miss what is correlated over their ends. Where the profile of the loss is
    flatter than its curvature says, the standard error is that of the interval which the profile gives. A parameter is
    not determined if its standard error exceeds LOOSE, or if it changes the RMSE by less than one percent over more
    than WIDE, of its search range, or if a time constant of its block is beyond the records (EXTRAPOLATED): what comes
    to rest later is what the form of the effect says, and not what was measured. going: as of `intervals`.
    """
    problem = problem.narrowed(point)
    sandwich = Sandwich(lambda: problem.samples(point))
    covariance = sandwich.covariance
    error = np.sqrt(np.diag(covariance))
    ends = intervals(problem, point, sandwich.jacobian, error, going)
    misleads = np.ptp(ends, axis=1) > 1.01 * 2 * TWO_SIDED * error
    error = np.where(misleads, np.ptp(ends, axis=1) / (2 * TWO_SIDED), error)
    value = problem.physical(point)[0]
    slope = (problem.physical(point + 1e-6) - problem.physical(point - 1e-6))[0] / 2e-6
    flat = flat_share(problem, point)
    scale = np.where(error > 0, error, 1)
    correlation = np.nan_to_num(covariance / np.outer(scale, scale))
    rows, slow = [], slow_blocks(problem, value)
    for i, name in enumerate(problem.names):
        verdict, note = verdict_of(point[i], error[i], flat[i], ends_at_bound(problem, point, i))
        if verdict == "determined" and name.rpartition(".")[0] in slow:
            verdict, note = "not determined", slow[name.rpartition(".")[0]]
        interval = interval_of(problem, point, i, ends[i])
        standard_error = float(error[i] * abs(slope[i])) if verdict != "not determined" else None
        if verdict == "determined":
            note = caution(problem, i, value[i], standard_error or 0.0, correlation[i])
        lower, upper = float(problem.lower[i]), float(problem.upper[i])
        scale_word = "log" if problem.log[i] else "linear"
        facts = (problem.units[i], lower, upper, standard_error, scale_word, verdict, note, None)
        rows.append(Estimate(name, float(value[i]), *facts, interval if standard_error is not None else None))
    return rows + linear_estimates(problem, point), correlation


def slow_blocks(problem: Problem, values: Array) -> dict[str, str]:
    """Why the parameters of a block say what was not measured, by the block and its axis: a time constant is far beyond
    the records that are fitted. values: of the free parameters, in the user's units."""
    fitted = (record for record in problem.records if record.use == "identify")
    longest, slow = max(record.samples * record.dt for record in fitted), dict[str, str]()
    for name, value, unit in zip(problem.names, values.tolist(), problem.units, strict=True):
        if unit == "s" and value > EXTRAPOLATED * longest:
            owner = name.rpartition(".")[0]
            slow[owner] = f"{name} is far beyond the longest record, of {longest:.3g} s: these hold its beginning only"
    return slow


def interval_of(problem: Problem, point: Array, i: int, ends: Array) -> tuple[float, float]:
    """The ends of an interval in the user's units. Of a logarithmic parameter they are not symmetric; beyond the cube,
    where it has none, they are as far from the value as its slope says, but not below 0 of what is never negative."""
    slope = (problem.physical(point + 1e-6) - problem.physical(point - 1e-6))[0, i] / 2e-6
    value, in_units = problem.physical(point)[0, i], []
    for end in ends:
        moved = point.copy()
        moved[i] = np.clip(end, 0, 1)
        in_units.append(
            float(problem.physical(moved)[0, i]) if 0 <= end <= 1 else float(value + slope * (end - point[i]))
        )
    declared = problem.model.entries[problem.free[i]].parameter.bounds[0]
    least = 0.0 if min(declared, problem.lower[i]) >= 0 else -np.inf
    return max(min(in_units), least), max(in_units)


def covariance(problem: Problem, point: Array) -> Array:
    """Covariance of the free parameters in the user's units, (free, free)."""
    slope = (problem.physical(point + 1e-6) - problem.physical(point - 1e-6))[0] / 2e-6
    return Sandwich(lambda: problem.narrowed(point).samples(point)).covariance * np.outer(slope, slope)


def linear_estimates(problem: Problem, point: Array) -> list[Estimate]:
    """Estimates of the linear parameters; for the standard errors those at zero are held there."""
    theta = problem.parameters(point)[0]
    columns = problem.linear.columns
    if not columns.size:
        return []
    solution = problem.linear.solved(theta)
    multiple, active = solution.values / solution.units, solution.values != 0
    error = np.zeros(columns.size)
    if active.any():
        error[active] = np.sqrt(np.diag(Sandwich(lambda: problem.samples_of_linear(point)).covariance))
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
    if parameter["verdict"] == "not determined" or not parameter.get("interval"):
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
    note = f"runs whose RMSE differs by less than 1 % put it at {min(values):.3g} to {max(values):.3g}{unit}"
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


def ends_at_bound(problem: Problem, point: Array, i: int) -> bool:
    """Whether nothing lies beyond the bound that a parameter is next to: the range ends there of itself, or it is never
    negative."""
    parameter = problem.model.entries[problem.free[i]].parameter
    if point[i] >= 0.5:
        return parameter.ends_at(float(problem.upper[i]), "upper")
    never_negative = problem.lower[i] == 0 <= parameter.bounds[0]
    return never_negative or parameter.ends_at(float(problem.lower[i]), "lower")


def verdict_of(place: float, error: float, flat: float, ends: bool = False) -> tuple[str, str]:
    """Verdict and reason from the value, its standard error and the flat interval, as shares of the search range; ends:
    whether nothing lies beyond the bound next to it."""
    if not error < LOOSE:
        return (
            "not determined",
            "its standard error is a fifth of its search range or more: these data do not determine it",
        )
    if flat > WIDE:
        return "not determined", f"over {flat:.0%} of its search range it changes the RMSE by less than 1 %"
    near = min(EDGE, SURELY * error)
    for side, distance in (("lower", place), ("upper", 1 - place)):
        if distance <= near:
            doubt = "the best value may lie beyond it: widen the bounds, or doubt the model"
            return f"on its {side} bound", NOTHING_BEYOND if ends else doubt
    return "determined", ""


def flat_share(problem: Problem, point: Array, steps: int = 24) -> Array:
    """Share of each parameter's range over which the loss stays within FLAT of the best, the others fixed: (free,).
    Every second place of a range decides whether it may be more than half; 0 where it is not. What is solved for
    follows to first order, which is exact where the response hardly changes."""
    near, most = problem.near(point), (1 + FLAT) * problem.loss(point)[0]
    losses = problem.loss if near is problem else lambda points: np.linalg.norm(near.rotated_residuals(points), axis=1)
    grid, shares = (np.arange(steps) + 0.5) / steps, np.zeros(problem.dimensions)

    def flat_at(numbers: NDArray[np.intp], places: Array) -> Array:
        points = np.tile(point, (numbers.size, places.size, 1))
        points[np.arange(numbers.size), :, numbers] = places
        return (losses(points.reshape(-1, point.size)) <= most).reshape(numbers.size, places.size)

    seconds = flat_at(np.arange(problem.dimensions), grid[::2])
    possible = np.flatnonzero(seconds.any(axis=1))
    if possible.size:
        shares[possible] = np.hstack([seconds[possible], flat_at(possible, grid[1::2])]).mean(axis=1)
    return shares
