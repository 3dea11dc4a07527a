"""One optimizer, one repeat: what a worker does at a time."""

from __future__ import annotations

import time
import zlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from pzt_ident.data.record import Record
from pzt_ident.data.units import factor
from pzt_ident.errors import RunError
from pzt_ident.files import damaged, read_files, read_sealed, write_bytes, write_sealed
from pzt_ident.model.optimizer import Optimizer
from pzt_ident.model.registry import optimizers
from pzt_ident.run.checkpoint import Checkpoint, read_losses
from pzt_ident.run.start import START, start_point
from pzt_ident.run.statement import Statement
from pzt_ident.search.descent import polish
from pzt_ident.search.loop import History, Outcome, State, Stop, optimize
from pzt_ident.search.problem import Problem
from pzt_ident.search.uncertainty import estimates

Tell = Callable[[dict[str, Any]], None]
SECONDS_BETWEEN_EVENTS = 0.1


@dataclass(frozen=True)
class Task:
    """Everything that a search is a function of, and where it leaves its traces."""

    run: str
    optimizer: str
    settings: dict[str, Any]
    repeat: int
    seed: int
    stop: dict[str, Any]
    polish: bool
    folder: Path

    @property
    def losses(self) -> Path:
        return self.folder / "runs" / f"{self.run}.losses"

    @property
    def result(self) -> Path:
        return self.folder / "runs" / f"{self.run}.json"


def work(tell: Tell, job_text: str, folder: Path, records: Sequence[Record], task: Task) -> None:
    """Entry of a worker that shares the disk: results go to the task's folder."""
    from pzt_ident.job.schema import Job

    search(task, Statement(Job.from_text(job_text, folder, plugins=True), records), tell)


def work_away(
    tell: Tell, job_text: str, folder: Path, records: Sequence[Record], task: Task, losses: bytes
) -> dict[str, bytes]:
    """Entry of a worker that may be anywhere; returns the files of its result. losses: those so far, as a file."""
    with TemporaryDirectory() as scratch:
        away = replace(task, folder=Path(scratch))
        write_bytes(away.losses, losses)
        work(tell, job_text, folder, records, away)
        return read_files(away.folder)


def search(task: Task, statement: Statement, tell: Tell) -> None:
    """Search, polish, judge the parameters, and write the result; continues from the losses on the disk."""
    result = identification(task, statement, Checkpoint(task.losses), tell)
    write_sealed(task.result, result)
    tell({"event": "run", "run": task.run, "rmse": result["rmse"], "stopped_by": result["stopped_by"]})


def identification(task: Task, statement: Statement, checkpoint: Checkpoint, tell: Tell) -> dict[str, Any]:
    """The entry of one run in `result.json`. Raises RunError where every simulation failed."""
    problem, size = statement.problem, factor(statement.unit)
    find = begun_from if task.optimizer == START else searched
    outcome, seconds, cpu_seconds = find(task, problem, size, checkpoint, tell)
    if not np.isfinite(outcome.loss):
        raise RunError(f"the simulation of each of its {outcome.evaluations} candidates failed: narrow the bounds")
    start, problem.failed = time.perf_counter(), 0
    point, polish_evaluations = polish(problem, outcome.point) if task.polish else (outcome.point, 0)
    polish_seconds = time.perf_counter() - start
    failed = problem.failed + checkpoint.failures
    return {
        "run": task.run,
        "optimizer": task.optimizer,
        "repeat": task.repeat,
        **what_is_known(statement, point),
        "rmse_before_polish": rmse(problem, outcome.point, size),
        "evaluations": outcome.evaluations,
        "polish_evaluations": polish_evaluations,
        "seconds": seconds,
        "cpu_seconds": cpu_seconds,
        "polish_seconds": polish_seconds,
        "failed_simulations": failed,
        "stopped_by": outcome.stopped_by,
    }


def what_is_known(statement: Statement, point: np.ndarray) -> dict[str, Any]:
    """Of a model at a point of the cube: RMSE, its parameters and what the data determine of them."""
    problem = statement.problem
    parameters, correlation = estimates(problem, point)
    return {
        "rmse": rmse(problem, point, factor(statement.unit)),
        "parameters": {
            estimate.name: {k: v for k, v in estimate._asdict().items() if k != "name"} for estimate in parameters
        },
        "fixed": fixed(problem),
        "correlation": {"names": list(problem.names), "matrix": correlation},
        "point": point,
    }


def searched(
    task: Task, problem: Problem, size: float, checkpoint: Checkpoint, tell: Tell
) -> tuple[Outcome, float, float]:
    """The optimizer's own outcome, and the wall and CPU time that it took, s."""
    optimizer = optimizers[task.optimizer].make(**task.settings).with_budget(task.stop["evaluations"])
    warm_up(optimizer, problem)
    before, known = checkpoint.seconds, [losses for _, losses in checkpoint.generations]
    start, cpu, shown = time.perf_counter(), time.process_time(), 0.0

    def elapsed() -> float:
        return before + time.perf_counter() - start

    with checkpoint.appending() as append:

        def note(state: State) -> None:
            nonlocal shown
            seconds = elapsed()
            append(seconds, state.losses)
            if seconds - shown > SECONDS_BETWEEN_EVENTS or shown == 0:
                shown = seconds
                tell(generation_event(task, state.evaluations, rmse(problem, state.point, size), seconds))

        outcome = optimize(
            optimizer,
            problem.dimensions,
            problem.loss,
            np.random.SeedSequence([task.seed, task.repeat, zlib.crc32(task.optimizer.encode())]),
            Stop(**task.stop),
            residuals=problem.rotated_residuals,
            callback=note,
            earlier_losses=known,
        )
    seconds, cpu_seconds = elapsed(), time.process_time() - cpu
    tell(generation_event(task, outcome.evaluations, rmse(problem, outcome.point, size), seconds))
    return outcome, seconds, cpu_seconds


def begun_from(
    task: Task, problem: Problem, size: float, checkpoint: Checkpoint, tell: Tell
) -> tuple[Outcome, float, float]:
    """A fit from elsewhere in the place of an optimizer's outcome."""
    start, cpu = time.perf_counter(), time.process_time()
    point = start_point(problem, task.settings["start"])
    losses = problem.loss(point)
    seconds = time.perf_counter() - start
    if not checkpoint.generations:
        with checkpoint.appending() as append:
            append(seconds, losses)
    tell(generation_event(task, 1, rmse(problem, point, size), seconds))
    history = History(np.ones(1, dtype=np.int64), np.array([seconds]), losses)
    return Outcome(point, float(losses[0]), 1, history, START), seconds, time.process_time() - cpu


def warm_up(optimizer: Optimizer, problem: Problem) -> None:
    """Have kernels and libraries there before the clock starts."""
    problem.loss(np.full(problem.dimensions, 0.5))
    search = optimizer.search(problem.dimensions, np.random.default_rng(0))
    next(search)
    search.close()


def rmse(problem: Problem, point: Any, size: float) -> dict[str, float]:
    return {use: float(problem.loss(point, use)[0]) / size for use in ("identify", "validate")}


def fixed(problem: Problem) -> dict[str, Any]:
    """Parameters that were not searched, in the user's units."""
    return {
        entry.name: {"value": problem.theta[i] / factor(problem.all_units[i]), "unit": problem.all_units[i]}
        for i, entry in enumerate(problem.model.entries)
        if i not in problem.free and i not in problem.linear.columns
    }


def generation_event(task: Task, evaluations: int, best: dict[str, float], seconds: float) -> dict[str, Any]:
    return {
        "event": "generation",
        "run": task.run,
        "optimizer": task.optimizer,
        "repeat": task.repeat,
        "evaluations": evaluations,
        "best": best["identify"],
        "validate": best["validate"],
        "seconds": seconds,
    }


def read_result(task: Task) -> dict[str, Any]:
    """Raises DamagedError where it is not whole, or not that of the losses beside it."""
    result = read_sealed(task.result, "run", "rmse", "parameters", "point", "evaluations")
    counted = sum(len(losses) for _, losses in read_losses(task.losses))
    if task.losses.exists() and counted != result["evaluations"]:
        raise damaged(task.losses, "does not hold the losses of its run")
    return result
