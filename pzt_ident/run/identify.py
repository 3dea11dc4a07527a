"""From a job to a result on the disk: records, model, searches side by side, tables and curves."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from pzt_ident.data.over_axes import together
from pzt_ident.data.units import factor, same_kind
from pzt_ident.errors import InputError, RunError
from pzt_ident.job.schema import Job
from pzt_ident.model.registry import optimizers
from pzt_ident.run.collect import collect
from pzt_ident.run.events import Listen, event_log, nobody
from pzt_ident.run.folder import begin, check_unchanged, read_environment, results_folder
from pzt_ident.run.pool import run_all
from pzt_ident.run.start import START, Starts
from pzt_ident.run.statement import Statement
from pzt_ident.run.task import Task, search, work


def run(
    job: Job,
    out: Path | None = None,
    *,
    workers: int | None = None,
    listen: Listen = nobody,
    start: Path | None = None,
    only_start: bool = False,
) -> Path:
    """Identify what the job asks for; returns the folder of results. `listen` is told each event as it happens. start:
    a folder of results, or a file of values, whose fit is polished as a row of its own beside the searches, or instead
    of them if `only_start`; the better one is the result.

    Writes `job.yaml`, `environment.json`, `events.jsonl`, `history.csv`, `signals.nc`, `residuals.json` and, last,
    `result.json`. Raises InputError before anything is written where the job or its data are wrong.
    """
    statement = Statement(job)
    folder = results_folder(job, out)
    starts = Starts(search=not only_start or start is None).and_(start, job)
    tasks = tasks_of(statement, folder, starts)
    begin(folder, job, job.text, statement.records)
    starts.keep(folder)
    return _search(statement, folder, tasks, workers, listen)


def resume(
    folder: Path,
    *,
    workers: int | None = None,
    listen: Listen = nobody,
    plugins: bool = False,
    start: Path | None = None,
) -> Path:
    """Go on where a killed run stopped, to the result that it would have had. start: as of `run`, one more.

    Raises InputError where the folder holds no run, or its job or data have changed.
    """
    begun = read_environment(folder)
    text = (folder / "job.yaml").read_text(encoding="utf-8")
    job = Job.from_text(text, Path(begun["job_folder"]), f"{begun['job_name']}.yaml", plugins)
    statement = Statement(job)
    check_unchanged(job, statement.records, begun, folder)
    starts = Starts.kept(folder).and_(start, job)
    starts.keep(folder)
    return _search(statement, folder, tasks_of(statement, folder, starts), workers, listen)


def _search(statement: Statement, folder: Path, tasks: list[Task], workers: int | None, listen: Listen) -> Path:
    """Run the tasks that have no result yet, and collect those of all."""
    missing = [task for task in tasks if not task.result.exists()]
    with event_log(folder, listen) as tell:
        if missing or not (folder / "result.json").exists():
            runs, budget = [task.run for task in missing], sum(task.stop["evaluations"] for task in missing)
            size = {"budget": budget, "unit": statement.unit, "together": together(statement.records[0].units)}
            tell({"event": "start", "runs": runs, **size, "folder": str(folder)})
            collect(statement, folder, tasks, _worked(statement, missing, workers, tell))
        else:
            tell({"event": "finished"})
        tell({"event": "done", "folder": str(folder)})
    return folder


def _worked(statement: Statement, tasks: list[Task], workers: int | None, tell: Listen) -> dict[str, str]:
    """Run searches in processes, and polish fits from elsewhere here; the reason for each run that failed."""
    job, failed = statement.job, dict[str, str]()
    searches = [task for task in tasks if task.optimizer != START]
    if searches:
        arguments = [(task.run, (task, job.text, job.folder, statement.records)) for task in searches]
        failed = run_all(work, arguments, workers, tell)
    for task in (task for task in tasks if task.optimizer == START):
        try:
            with np.errstate(all="ignore"):
                search(task, statement, tell)
        except RunError as error:
            failed[task.run] = str(error)
            tell({"event": "failed", "run": task.run, "reason": str(error)})
    return failed


def stop_of(statement: Statement) -> dict[str, float | int | None]:
    """When each search ends; all have the budget of the first optimizer unless the job gives one.

    Raises InputError where the target is in another kind of unit than the response.
    """
    job, unit = statement.job, statement.unit
    first, target = job.optimizers[0], job.stop.target
    if target and target.unit and not same_kind(target.unit, unit):
        problem = f"{target.value:g} {target.unit} cannot be an RMSE of a response in {unit}"
        raise InputError(problem, where="stop.target", remedy=f"give it in a unit such as {unit}")
    return {
        "evaluations": job.stop.evaluations or optimizers[first.name].make(**first.settings).evaluations,
        "seconds": job.stop.seconds,
        "stagnation": job.stop.stagnation,
        "target": target.value * factor(target.unit or unit) if target else None,
    }


def tasks_of(statement: Statement, folder: Path, starts: Starts = Starts()) -> list[Task]:  # noqa: B008
    """Optimizers times repeats, then the fits to start from. Raises InputError as `stop_of` does."""
    job, stop = statement.job, stop_of(statement)
    searches = [
        Task(f"{choice.name}-{repeat}", choice.name, choice.settings, repeat, job.seed, stop, job.polish, folder)
        for choice in job.optimizers
        for repeat in range(job.repeats)
    ]
    alone = {"evaluations": 1}
    return searches * starts.search + [
        Task(f"{START}-{number}", START, {"start": start}, number, job.seed, alone, True, folder)
        for number, (_, start) in enumerate(starts.given)
    ]
