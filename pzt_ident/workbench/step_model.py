"""The model of a step, kept compiled in this process: its parameters, and what it does when they are moved."""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.notation import unit as printed_unit
from pzt_ident.data.units import factor
from pzt_ident.engine.simulator import Simulator
from pzt_ident.errors import InputError, nearest
from pzt_ident.job.schema import Job, load_job
from pzt_ident.model.chain import Entry
from pzt_ident.report.decimation import decimate
from pzt_ident.run.improve import case_of
from pzt_ident.run.start import read_start, theta_of
from pzt_ident.run.statement import Statement
from pzt_ident.search.problem import Problem

Array = NDArray[np.float64]
POINTS = 6000  # of a record, at most, that a moved slider answers
ROUNDING = 1e-9  # of the range of a parameter
KEPT = 4  # steps whose records stay in memory

_statements: dict[tuple[str, str], Statement] = {}


def stated(path: Path, job: Job) -> Statement:
    """The job with its records and its compiled model, made once. Raises InputError on what is wrong with the data."""
    key = str(path), job.text
    if key not in _statements:
        while len(_statements) >= KEPT:
            _statements.pop(next(iter(_statements)))
        _statements[key] = Statement(job)
    return _statements[key]


def model_of(step: Path, plugins: bool) -> StepModel:
    """The model of a step; made anew when its result changes."""
    result = step / "run" / "result.json"
    return _model(step, job_in(step, plugins), result.stat().st_mtime_ns if result.exists() else 0)


def job_in(step: Path, plugins: bool) -> Job:
    """The job of a step, read again when it changes. Raises InputError where it is missing or damaged."""
    path = step / "job.yaml"
    return _job(path, plugins, path.stat().st_mtime_ns if path.exists() else 0)


@lru_cache(16)
def _job(path: Path, plugins: bool, stamp: int) -> Job:
    return load_job(path, plugins)


@lru_cache(KEPT)
def _model(step: Path, job: Job, stamp: int) -> StepModel:
    return StepModel(step, stated(step / "job.yaml", job))


class StepModel:
    """A step's statement with what its run found, if it was run."""

    def __init__(self, step: Path, statement: Statement) -> None:
        self.step, self.statement = step, statement
        path = step / "run" / "result.json"
        result = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
        self.best: dict[str, Any] = result.get("best") or {}
        start = read_start(step / "run", statement.job) if self.best else {}
        self.theta = theta_of(statement.problem, start)
        self._extended: dict[str, AdjustableModel] = {}

    @property
    def problem(self) -> Problem:
        return self.statement.problem

    @property
    def parameters(self) -> list[dict[str, Any]]:
        """Every parameter of the model: value, 95 % interval, unit, bounds and verdict, None where it was not run."""
        return [self._facts(self.problem, i, self.theta if self.best else None) for i in range(len(self.theta))]

    def proposal(self, effect: str) -> list[dict[str, Any]]:
        """The parameters that an effect would bring, at its null. Raises InputError where it cannot be added."""
        moved = self.with_effect(effect)
        new = [i for i, name in enumerate(moved.problem.model.names) if name not in self.problem.model.names]
        return [self._facts(moved.problem, i, moved.theta) for i in new]

    def with_effect(self, effect: str) -> AdjustableModel:
        """The model with an effect more, at its null; without one the model itself."""
        if effect not in self._extended:
            self._extended[effect] = AdjustableModel(self._problem_with(effect), self.theta, self.problem)
        return self._extended[effect]

    def _problem_with(self, effect: str) -> Problem:
        if not effect:
            return self.problem
        from pzt_ident.model.registry import blocks

        if effect not in blocks:
            raise InputError(f"unknown effect {effect!r}", remedy=nearest(effect, blocks.effects()))
        return case_of(self.statement).problem((*self.statement.job.effects, effect))

    def _facts(self, problem: Problem, column: int, theta: Array | None) -> dict[str, Any]:
        entry, unit = problem.model.entries[column], problem.all_units[column]
        fit = self.best.get("parameters", {}).get(entry.name, {})
        free = column in problem.free or column in problem.linear.columns
        low, high = bounds_of(problem, column)
        scale = entry.parameter.scale if low > 0 else "linear"
        found = None if theta is None or not np.isfinite(theta[column]) else float(theta[column] / factor(unit))
        ends = fit.get("interval") or interval_of(fit)
        return {
            "name": entry.name,
            "axis": problem.model.axes[entry.axis],
            "block": entry.block.name,
            "symbol": entry.name.rpartition(".")[2],
            "unit": printed_unit(unit),
            "value": found if found is None else to_bound(found, low, high, scale),
            "low": ends and max(ends[0], low),
            "high": ends and min(ends[1], high),
            "bounds": [low, high],
            "scale": scale,
            "fixed": not free,
            "solved": column in problem.linear.columns,
            "determined": determined(fit),
            "physics": described(entry),
        }


class AdjustableModel:
    """A model whose parameters are moved: its problem, and where they start."""

    def __init__(self, problem: Problem, theta: Array, before: Problem) -> None:
        self.problem = problem
        values = dict(zip(before.model.names, theta, strict=True))
        start = {name: (value, "1") for name, value in values.items() if np.isfinite(value)}
        self.theta = theta_of(problem, start)

    @cached_property
    def simulators(self) -> list[Simulator]:
        return self.problem.every_simulator

    @cached_property
    def kept(self) -> list[NDArray[np.intp]]:
        """Of each record the samples that are answered: the extremes of its responses and of its drives."""
        return [kept_samples(simulator) for simulator in self.simulators]

    def at(self, values: Mapping[str, Any]) -> Array:
        """theta with some parameters, by name, at values in the user's units. Raises InputError for an unknown one."""
        theta, names = self.theta.copy(), list(self.problem.model.names)
        for name, value in values.items():
            if name not in names:
                raise InputError(f"unknown parameter {name!r}", remedy=nearest(str(name), names))
            column = names.index(name)
            theta[column] = float(value) * factor(self.problem.all_units[column])
        rows = theta[None]
        self.problem.linear.fill(rows)
        return np.asarray(rows[0])

    def answer(self, values: Mapping[str, Any], positions: bool) -> tuple[dict[str, Any], bytes]:
        """RMSE by use, the records and axes with the number of their points (and their positions), and the model at
        these as 32-bit floats, one after the other, in the units of the responses."""
        theta, problem = self.at(values), self.problem
        records, parts = [], []
        squares = {use: np.zeros(len(problem.sizes)) for use in problem.simulators}
        scored = dict.fromkeys(problem.simulators, 0)
        for simulator, kept in zip(self.simulators, self.kept, strict=True):
            record = simulator.record
            errors = simulator.errors(theta)[0]
            squares[record.use] += np.square(errors[:, record.settle :]).sum(axis=1)
            scored[record.use] += simulator.scored
            for axis, error in zip(record.measured, errors, strict=True):
                model = (record.response[axis, kept] + error[kept]) / factor(str(record.response_units[axis]))
                parts.append(model.astype("<f4").tobytes())
                facts: dict[str, Any] = {"name": record.name, "use": record.use, "axis": record.axes[axis]}
                facts["points"] = kept.size
                records.append(facts | ({"positions": kept.tolist()} if positions else {}))
        return {"rmse": rmse_of(problem, squares, scored), "records": records}, b"".join(parts)


def rmse_of(problem: Problem, squares: Mapping[str, Array], scored: Mapping[str, int]) -> dict[str, float | None]:
    """By use, in the user's unit, as the run has it; None without records and where the simulation failed."""
    from pzt_ident.run.statement import loss_unit

    size, rmse = factor(loss_unit(problem.records)), dict[str, float | None]()
    for use, count in scored.items():
        error = np.sqrt(np.mean(squares[use] / count / problem.sizes**2)) / size if count else np.nan
        rmse[use] = float(error) if np.isfinite(error) else None
    return rmse


def kept_samples(simulator: Simulator) -> NDArray[np.intp]:
    record = simulator.record
    if record.samples <= POINTS:
        return np.arange(record.samples)
    curves = [*record.response[list(record.measured)], *record.drive]
    bins = POINTS // (2 * len(curves)) - 2
    return np.unique(np.concatenate([decimate(curve, bins) for curve in curves]))


def bounds_of(problem: Problem, column: int) -> tuple[float, float]:
    """Of a parameter in the user's units; those declared of a fixed one, NaN where a drive that rests gives none."""
    if column in problem.free:
        return problem.range_of(column)
    try:
        return problem.declared_bounds(column)
    except InputError:
        return float("nan"), float("nan")


def to_bound(value: float, low: float, high: float, scale: str) -> float:
    """A bound in the place of a value that rounding alone keeps from it."""
    near = (abs(value - bound) <= ROUNDING * (bound if scale == "log" else high - low) for bound in (low, high))
    return next((bound for bound, is_near in zip((low, high), near, strict=True) if is_near), value)


def interval_of(fit: Mapping[str, Any]) -> list[float] | None:
    """Ends of the 95 % interval that a standard error gives."""
    error = fit.get("standard_error")
    return [fit["value"] - 1.96 * error, fit["value"] + 1.96 * error] if error else None


def determined(fit: Mapping[str, Any]) -> str:
    """`yes`, `no`, another verdict or a reservation, or nothing where there is none."""
    verdict = fit.get("verdict", "")
    if verdict == "determined":
        return str(fit.get("note") or "yes")
    return "no" if verdict == "not determined" else str(verdict)


def described(entry: Entry) -> str:
    return entry.parameter.doc
