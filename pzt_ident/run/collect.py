"""What all runs of a job came to: `result.json`, and the tables and curves beside it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from datetime import datetime
from pathlib import Path
from typing import Any

import numpy as np

from pzt_ident.data.noise import noise_floor, units_and_floors
from pzt_ident.data.record import Record
from pzt_ident.data.signals import write_signals
from pzt_ident.data.units import factor
from pzt_ident.errors import RunError
from pzt_ident.files import digest_of, write_sealed, write_text
from pzt_ident.run.checkpoint import read_losses
from pzt_ident.run.folder import read_environment
from pzt_ident.run.misfit import write_misfits
from pzt_ident.run.start import START
from pzt_ident.run.statement import Statement
from pzt_ident.run.task import Task, read_result
from pzt_ident.search.finer_steps import change_in_finer_steps, finer_steps
from pzt_ident.search.league import rank
from pzt_ident.search.problem import Problem
from pzt_ident.search.uncertainty import judged

MOST_OF_THE_NOISE = 0.2  # that finer steps of a simulation may change, before it is said


def collect(
    statement: Statement, folder: Path, tasks: list[Task], failed: dict[str, str], misfits: bool = True
) -> dict[str, Any]:
    """Tables and curves of all runs, with `residuals.json` if `misfits`; `result.json` comes last and is returned.

    Raises RunError where every run failed.
    """
    done = [task for task in tasks if task.run not in failed]
    if not done:
        raise RunError("every run failed: " + "; ".join(dict.fromkeys(failed.values())))
    job, records, problem = statement.job, statement.records, statement.problem
    runs = [read_result(task) for task in done]
    searches = [task for task in done if task.optimizer != START]
    histories = {task.run: history_of(task, factor(statement.unit)) for task in searches}
    league = rank(runs, histories)
    best = judged(min(runs, key=lambda run: run["rmse"]["identify"]), runs)
    point = np.array(best["point"])
    write_text(folder / "history.csv", history_text(searches, histories))
    write_signals(folder / "signals.nc", problem.errors(point))
    floors = [noise_floor(records, axis).value for axis in records[0].measured]
    result = {
        "name": job.name,
        **units_and_floors(records),
        "seed": job.seed,
        "command": read_environment(folder)["command"],
        "created": datetime.now().astimezone().isoformat(timespec="seconds"),
        "records": [facts_of(record, problem, point, floors) for record in records],
        "league": league,
        "best": best,
        "runs": [{key: value for key, value in run.items() if key != "correlation"} for run in runs],
        "failed_runs": [{"run": name, "reason": reason} for name, reason in failed.items()],
    }
    if misfits:
        write_misfits(folder, result)
    result["files"] = {name: digest_of(folder / name) for name in ("history.csv", "signals.nc")}
    write_sealed(folder / "result.json", result)
    return result


def facts_of(record: Record, problem: Problem, point: np.ndarray, floors: Sequence[float]) -> dict[str, Any]:
    """What is to be known of a record, and what the model leaves of it. floors: noise of each measured axis, SI."""
    theta = problem.parameters(point)
    finer = replace(record, steps=finer_steps(problem, record, theta))
    changes = change_in_finer_steps(problem, record, finer, theta)
    change = float(np.max(changes / np.array(floors))) if np.min(floors) > 0 else 0.0
    return {
        **errors_in(record, problem, point),
        "file": record.file,
        "sha256": record.sha256,
        "samples": record.samples,
        "sample_rate": 1 / record.dt,
        "settle": record.settle * record.dt,
        "axes": [record.axes[a] for a in record.measured],
        "step_change": change,
        "notes": [*record.notes, *problem.simulator_of(record).violations(theta), *coarse(record, change)],
    }


def coarse(record: Record, change: float) -> Iterator[str]:
    """The note on a simulation whose step costs much of the noise. change: in finer steps, in floors."""
    if change > MOST_OF_THE_NOISE:
        how = f"give the record `steps: {4 * record.steps}`"
        yield f"finer steps of the simulation change the response by {change:.2g} noise floors: {how}"


def errors_in(record: Record, problem: Problem, point: np.ndarray) -> dict[str, Any]:
    """RMSE of each measured axis of a record, each in its own unit."""
    simulator = problem.simulator_of(record)
    rmse = np.sqrt(simulator.squares(problem.parameters(point))[0] / simulator.scored)
    by_axis = {axis: error / factor(unit) for (axis, unit), error in zip(record.units.items(), rmse, strict=True)}
    return {"name": record.name, "use": record.use, "rmse": by_axis}


def history_of(task: Task, size: float) -> np.ndarray:
    """(generations, 3): evaluations so far, seconds so far, best RMSE so far in the user's unit."""
    rows, evaluations, best = [], 0, np.inf
    for seconds, losses in read_losses(task.losses):
        evaluations, best = evaluations + len(losses), min(best, losses.min())
        rows.append((evaluations, seconds, best / size))
    return np.array(rows)


def history_text(done: list[Task], histories: dict[str, np.ndarray]) -> str:
    lines = ["optimizer,repeat,generation,evaluations,seconds,best"]
    for task in done:
        for generation, (evaluations, seconds, best) in enumerate(histories[task.run], 1):
            lines.append(f"{task.optimizer},{task.repeat},{generation},{evaluations:.0f},{seconds:.6g},{best:.9g}")
    return "\n".join(lines) + "\n"
