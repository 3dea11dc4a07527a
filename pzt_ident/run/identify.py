"""From a job to a result on the disk: records, model, searches side by side, tables and curves."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from datetime import datetime
from importlib import import_module
from pathlib import Path
from threading import Lock, Thread
from typing import Any

import numpy as np

from pzt_ident.data.noise import noise_floor
from pzt_ident.data.readers import read_records
from pzt_ident.data.record import Record
from pzt_ident.data.signals import write_signals
from pzt_ident.data.units import factor, same_kind
from pzt_ident.errors import InputError, RunError
from pzt_ident.files import plain, write_json, write_text
from pzt_ident.job.schema import Job
from pzt_ident.model.registry import optimizers
from pzt_ident.run.pool import run_all
from pzt_ident.run.task import Task, problem_of, read_losses, read_result, unit_of, work
from pzt_ident.search.league import compare
from pzt_ident.search.problem import Problem

Event = dict[str, Any]
Listen = Callable[[Event], None]


def run(
    job: Job,
    out: Path | None = None,
    *,
    workers: int | None = None,
    report: bool = True,
    listen: Listen = lambda event: None,
) -> Path:
    """Identify what the job asks for; returns the folder of results. `listen` is told each event as it happens.

    Raises InputError before anything is written where the job or its data are wrong.
    """
    records = read(job)
    problem_of(job, records)
    folder = folder_for(job, out)
    tasks = tasks_of(job, records, folder)
    make_empty(folder)
    write_text(folder / "job.yaml", job.text)
    write_json(folder / "environment.json", environment(job, records))
    return go_on(job, records, folder, tasks, workers, report, listen)


def resume(
    folder: Path,
    *,
    workers: int | None = None,
    report: bool = True,
    listen: Listen = lambda event: None,
    plugins: bool = False,
) -> Path:
    """Go on where a killed run stopped, to the result that it would have had.

    Raises InputError where the folder holds no run, or its job or data have changed.
    """
    before = begun(folder)
    text = (folder / "job.yaml").read_text(encoding="utf-8")
    job = Job.from_text(text, Path(before["job_folder"]), f"{before['job_name']}.yaml", plugins)
    records = read(job)
    same_as_before(job, records, before, folder)
    return go_on(job, records, folder, tasks_of(job, records, folder), workers, report, listen)


def same_as_before(job: Job, records: list[Record], before: dict[str, Any], folder: Path) -> None:
    remedy = "undo the change, or start a new run"
    if job.hash != before["job_hash"]:
        raise InputError("is not the job that this run began with", where=str(folder / "job.yaml"), remedy=remedy)
    for record in records:
        if record.sha256 != before["data"][record.name]:
            where = str(job.folder / record.file)
            raise InputError("has changed since this run began", where=where, remedy=remedy)


def read(job: Job) -> list[Record]:
    return read_records(job.records, job.channels.axes, job.channels.time, job.folder)


def folder_for(job: Job, out: Path | None) -> Path:
    """Where the results of a job go."""
    return out or Path("results") / job.name / f"{datetime.now():%Y%m%d-%H%M%S}-{job.hash}"


def make_empty(folder: Path) -> None:
    """Make the folder. Raises InputError where that cannot be, or something is in it."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        full = any(folder.iterdir())
    except OSError as error:
        remedy = "give another folder with --out"
        raise InputError(error.strerror or str(error), where=str(folder), remedy=remedy) from None
    if full:
        raise InputError("this folder is not empty", where=str(folder), remedy="give another --out, or resume it")


def begun(folder: Path) -> dict[str, Any]:
    """The environment of the run in a folder. Raises InputError where there is none."""
    try:
        return dict(json.loads((folder / "environment.json").read_text(encoding="utf-8")))
    except (OSError, ValueError):
        remedy = "give the folder that `pzt-ident run` wrote"
        raise InputError("holds no run", where=str(folder), remedy=remedy) from None


def go_on(
    job: Job,
    records: list[Record],
    folder: Path,
    tasks: list[Task],
    workers: int | None,
    report: bool,
    listen: Listen,
) -> Path:
    missing = [task for task in tasks if not task.result.exists()]
    with recorded(folder, listen) as tell:
        if missing or not (folder / "result.json").exists():
            runs, budget = [task.run for task in missing], sum(task.stop["evaluations"] for task in missing)
            tell({"event": "start", "runs": runs, "budget": budget, "unit": unit_of(records), "folder": str(folder)})
            if report:
                import_ahead()
            arguments = [(task.run, (task, job.text, job.folder, records)) for task in missing]
            collect(job, records, folder, tasks, run_all(work, arguments, workers, tell))
        else:
            tell({"event": "finished"})
        if report:
            from pzt_ident.report.page import write_report

            write_report(folder)
        tell({"event": "done", "folder": str(folder)})
    return folder


@contextmanager
def recorded(folder: Path, listen: Listen) -> Iterator[Listen]:
    """A listener that keeps each event as a line of `events.jsonl` and tells it on; any thread may call it."""
    one_at_a_time = Lock()
    with (folder / "events.jsonl").open("a", encoding="utf-8") as events:

        def tell(event: Event) -> None:
            with one_at_a_time:
                events.write(json.dumps(plain(event)) + "\n")
                events.flush()
                listen(event)

        yield tell


def import_ahead() -> None:
    """Import what draws the report while the searches run: they leave this process idle."""
    drawing = ("pandas", "matplotlib.figure", "matplotlib.backends.backend_svg", "h5netcdf", "pzt_ident.report.page")
    Thread(target=lambda: [import_module(name) for name in drawing], daemon=True).start()


def tasks_of(job: Job, records: list[Record], folder: Path) -> list[Task]:
    """Optimizers times repeats, all with the budget of the first unless the job gives one.

    Raises InputError where the target is in another kind of unit than the response.
    """
    first = job.optimizers[0]
    budget = job.stop.evaluations or optimizers[first.name].make(**first.settings).evaluations
    unit, target = unit_of(records), job.stop.target
    if target and target.unit and not same_kind(target.unit, unit):
        problem = f"{target.value:g} {target.unit} cannot be an RMSE of a response in {unit}"
        raise InputError(problem, where="stop.target", remedy=f"give it in a unit such as {unit}")
    stop = {
        "evaluations": budget,
        "seconds": job.stop.seconds,
        "stagnation": job.stop.stagnation,
        "target": target and target.value * factor(target.unit or unit),
    }
    return [
        Task(f"{choice.name}-{repeat}", choice.name, choice.settings, repeat, job.seed, stop, job.polish, folder)
        for choice in job.optimizers
        for repeat in range(job.repeats)
    ]


def collect(job: Job, records: list[Record], folder: Path, tasks: list[Task], failed: dict[str, str]) -> None:
    """Tables and curves of all runs; `result.json` comes last. Raises RunError where every run failed."""
    done = [task for task in tasks if task.run not in failed]
    if not done:
        raise RunError("every run failed: " + "; ".join(dict.fromkeys(failed.values())))
    size = factor(unit_of(records))
    runs = [read_result(task) for task in done]
    histories = {task.run: history_of(task, size) for task in done}
    league = compare(runs, histories)
    best = min(runs, key=lambda run: run["rmse"]["identify"])
    problem = problem_of(job, records)
    point = np.array(best["point"])
    write_text(folder / "history.csv", history_text(done, histories))
    write_signals(folder / "signals.nc", problem, point)
    floors = {records[0].axes[a]: noise_floor(list(records), a) for a in records[0].measured}
    units = {records[0].axes[a]: str(records[0].response_units[a]) for a in records[0].measured}
    result = {
        "name": job.name,
        "unit": unit_of(records),
        "seed": job.seed,
        "command": begun(folder)["command"],
        "created": datetime.now().astimezone().isoformat(timespec="seconds"),
        "noise_floor": {axis: floor.value / factor(units[axis]) for axis, floor in floors.items()},
        "noise_floor_source": {axis: floor.source for axis, floor in floors.items()},
        "records": [about(record, problem, point) for record in records],
        "league": league,
        "best": best,
        "runs": [{key: value for key, value in run.items() if key != "correlation"} for run in runs],
        "failed_runs": [{"run": name, "reason": reason} for name, reason in failed.items()],
    }
    write_json(folder / "result.json", result)


def about(record: Record, problem: Problem, point: np.ndarray) -> dict[str, Any]:
    simulator = next(
        simulator
        for simulators in problem.simulators.values()
        for simulator in simulators
        if simulator.record is record
    )
    theta = problem.parameters(point)
    return {
        **errors_in(record, problem, point),
        "file": record.file,
        "sha256": record.sha256,
        "samples": record.samples,
        "sample_rate": 1 / record.dt,
        "settle": record.settle * record.dt,
        "axes": [record.axes[a] for a in record.measured],
        "notes": [*record.notes, *simulator.broken(theta)],
    }


def errors_in(record: Record, problem: Problem, point: np.ndarray) -> dict[str, Any]:
    """RMSE of each measured axis of a record, each in its own unit."""
    simulator = next(
        simulator
        for simulators in problem.simulators.values()
        for simulator in simulators
        if simulator.record is record
    )
    rmse = np.sqrt(simulator.squares(problem.parameters(point))[0] / simulator.scored)
    sizes = [factor(str(record.response_units[a])) for a in record.measured]
    each = {record.axes[a]: rmse[i] / sizes[i] for i, a in enumerate(record.measured)}
    return {"name": record.name, "use": record.use, "rmse": each}


def history_of(task: Task, size: float) -> np.ndarray:
    """(generations, 3): evaluations so far, seconds so far, best RMSE so far in the user's unit."""
    rows, evaluations, best = [], 0, np.inf
    for seconds, losses in read_losses(task.told):
        evaluations, best = evaluations + len(losses), min(best, losses.min())
        rows.append((evaluations, seconds, best / size))
    return np.array(rows)


def history_text(done: list[Task], histories: dict[str, np.ndarray]) -> str:
    lines = ["optimizer,repeat,generation,evaluations,seconds,best"]
    for task in done:
        for generation, (evaluations, seconds, best) in enumerate(histories[task.run], 1):
            lines.append(f"{task.optimizer},{task.repeat},{generation},{evaluations:.0f},{seconds:.6g},{best:.9g}")
    return "\n".join(lines) + "\n"


def environment(job: Job, records: list[Record]) -> dict[str, Any]:
    """Where this ran and on what: enough to run it again, and to go on with nothing else."""
    import os
    import platform
    from importlib.metadata import PackageNotFoundError, version

    packages = {}
    for name in ("pzt-ident", "numpy", "scipy", "numba", "pandas", "pyswarms", "deap", "cma"):
        try:
            packages[name] = version(name)
        except PackageNotFoundError:
            packages[name] = "not installed"
    return {
        "python": platform.python_version(),
        "platform": platform.platform(),
        "cpu": platform.processor() or platform.machine(),
        "cores": os.cpu_count(),
        "packages": packages,
        "command": " ".join(["pzt-ident", *sys.argv[1:]]),
        "data": {record.name: record.sha256 for record in records},
        "job_hash": job.hash,
        "job_name": job.name,
        "job_folder": str(job.folder.resolve()),
    }
