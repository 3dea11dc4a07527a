"""From a job to a result on the disk: records, model, searches side by side, tables and curves."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from pzt_ident.data.over_axes import together
from pzt_ident.data.units import factor, same_kind
from pzt_ident.errors import DamagedError, InputError, RunError
from pzt_ident.files import write_files
from pzt_ident.job.schema import Job
from pzt_ident.model.registry import optimizers
from pzt_ident.run.collect import collect
from pzt_ident.run.events import Listen, event_log, nobody
from pzt_ident.run.folder import begin, check_unchanged, read_environment, read_job, results_folder
from pzt_ident.run.here import search_here
from pzt_ident.run.place import HERE, Place
from pzt_ident.run.results import read_results
from pzt_ident.run.start import START, Starts
from pzt_ident.run.statement import Statement
from pzt_ident.run.task import Task, read_result, search, work, work_away


def run(
    job: Job,
    out: Path | None = None,
    *,
    place: Place = HERE,
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
    return _search(statement, folder, tasks, place, listen)


def resume(
    folder: Path,
    *,
    place: Place = HERE,
    listen: Listen = nobody,
    plugins: bool = False,
    start: Path | None = None,
) -> Path:
    """Go on where a killed run stopped, to the result that it would have had. start: as of `run`, one more.

    Raises InputError where the folder holds no run, or its job or data have changed.
    """
    environment = read_environment(folder)
    text = read_job(folder)
    job = Job.from_text(text, Path(environment["job_folder"]), f"{environment['job_name']}.yaml", plugins)
    statement = Statement(job)
    check_unchanged(job, statement.records, environment, folder)
    starts = Starts.kept(folder).and_(start, job)
    starts.keep(folder)
    return _search(statement, folder, tasks_of(statement, folder, starts), place, listen)


def _search(statement: Statement, folder: Path, tasks: list[Task], place: Place, listen: Listen) -> Path:
    """Run the tasks that have no result yet, or a damaged one, and collect those of all."""
    with event_log(folder, listen) as tell:
        missing = [task for task in tasks if not is_done(task, tell)]
        if missing or not is_collected(folder, tell):
            runs, budget = [task.run for task in missing], sum(task.stop["evaluations"] for task in missing)
            size = {"budget": budget, "unit": statement.unit, "together": together(statement.records[0].units)}
            tell({"event": "start", "runs": runs, **size, "folder": str(folder)})
            collect(statement, folder, tasks, _worked(statement, folder, missing, place, tell))
        else:
            tell({"event": "finished"})
        tell({"event": "done", "folder": str(folder)})
    return folder


def is_done(task: Task, tell: Listen) -> bool:
    """Whether a task has a result; one that is damaged is told."""
    try:
        return task.result.exists() and bool(read_result(task))
    except DamagedError as error:
        tell({"event": "damaged", "said": f"{error.where} {error.message}; its search is done again"})
        return False


def is_collected(folder: Path, tell: Listen) -> bool:
    """Whether what all tasks came to is there; what is damaged of it is told."""
    if not (folder / "result.json").exists():
        return False
    try:
        damages = list(read_results(folder).damaged)
    except InputError as error:
        damages = [str(error).replace("\n ", ";")]
    for sentence in damages:
        tell({"event": "damaged", "said": f"{sentence.partition(';')[0]}; it is made again"})
    return not damages


def search_all(statement: Statement, folder: Path, tasks: list[Task], place: Place, tell: Listen) -> dict[str, str]:
    """Run the tasks at a place, their files into the folder; returns the reason for each that failed."""
    job = statement.job
    common = job.text, job.folder.resolve(), statement.records
    if place.shares_disk:
        return place.run_all(work, common, [(task.run, (task,)) for task in tasks], tell)
    calls = ((task.run, (task, told_so_far(task))) for task in tasks)
    return place.run_all(work_away, common, calls, tell, lambda name, files: write_files(folder, files))


def told_so_far(task: Task) -> bytes:
    return task.losses.read_bytes() if task.losses.exists() else b""


def _worked(statement: Statement, folder: Path, tasks: list[Task], place: Place, tell: Listen) -> dict[str, str]:
    """Run searches at a place, and polish fits from elsewhere here; the reason for each run that failed."""
    searches = [task for task in tasks if task.optimizer != START]
    searches, failed = search_here(statement, searches, tell) if place == HERE else (searches, {})
    if searches:
        failed |= search_all(statement, folder, searches, place, tell)
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
    job = statement.job
    with job.placed():
        stop = stop_of(statement)
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
