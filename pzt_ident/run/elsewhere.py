"""An improvement or a diagnosis at a place that may share no disk with this process, and one that was killed, begun
again."""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from pzt_ident.data.record import Record
from pzt_ident.errors import DamagedError, InputError, RunError
from pzt_ident.files import read_files, read_sealed, write_files, write_json, write_text
from pzt_ident.job.files import moved
from pzt_ident.job.schema import Job
from pzt_ident.run.events import Listen, event_log, nobody
from pzt_ident.run.folder import read_environment, read_job
from pzt_ident.run.improve import begin_task, diagnose, improve
from pzt_ident.run.place import HERE, Place
from pzt_ident.run.pool import Tell
from pzt_ident.run.start import file_of, read_start

OF_THIS_PROCESS = ("job.yaml", "environment.json")
LAST = ("diagnosis.json", "events.jsonl")
TASKS = {"improve": improve, "diagnose": diagnose}


def sought_at(
    place: Place,
    task: str,
    job: Job,
    out: Path | None = None,
    listen: Listen = nobody,
    budget: float | None = None,
    start: Path | None = None,
) -> Path:
    """As what TASKS has under the name `task`, at a place. Raises RunError where it came to nothing there, LostError
    where the place is gone."""
    if place.shares_disk:
        return TASKS[task](job, out, listen, budget, start)
    known = None if start is None else file_of(read_start(start, job))
    statement, folder = begin_task(job, out, budget, start, task=task)
    given = (task, job.text, job.folder.resolve(), statement.records, folder.resolve(), budget, known)

    def keep(name: str, files: dict[str, bytes]) -> None:
        names = sorted(files.keys() - set(OF_THIS_PROCESS), key=end_last)
        write_files(folder, {name: files[name] for name in names})

    listen({"event": "start", "runs": [], "budget": 0, "unit": statement.unit, "together": "", "folder": str(folder)})
    failed = place.run_all(sought_there, (), [(job.name, given)], listen, keep)
    for reason in failed.values():
        raise RunError(reason)
    return folder


def sought_there(
    tell: Tell,
    task: str,
    text: str,
    job_folder: Path,
    records: Sequence[Record],
    folder: Path,
    budget: float | None,
    known: dict[str, Any] | None,
) -> dict[str, bytes]:
    """Entry of a worker; returns the files of the results. known: the content of a file of values to start from."""
    with TemporaryDirectory(prefix="pzt-ident-") as scratch:
        start = None if known is None else Path(scratch) / "start.json"
        if start:
            write_json(start, known)
        job = Job.from_text(text, job_folder, plugins=True)
        results = TASKS[task](job, Path(scratch) / "results", tell, budget, start, records)
        move(results, folder)
        return read_files(results)


def end_last(name: str) -> tuple[int, str]:
    """A key to sort files by: after the others come `diagnosis.json`, which says that all are there, and the log, which
    is held until then."""
    return LAST.index(name) + 1 if name in LAST else 0, name


def move(results: Path, folder: Path) -> None:
    """Let the paths of the jobs in a folder of results be those from another one, which it is to become."""
    for path in results.glob("*.yaml"):
        write_text(path, moved(path.read_text(encoding="utf-8"), results, folder))


def task_of(folder: Path) -> str:
    """What the folder was begun with: `run`, `improve` or `diagnose`. Raises InputError where it holds none."""
    return str(read_environment(folder).get("task", {}).get("name", "run"))


def is_whole(folder: Path) -> bool:
    """Whether a diagnosis or an improvement came to its end, and is as it was written."""
    names = ["diagnosis.json", *(name for name in ("improvement.json", "residuals.json") if (folder / name).exists())]
    try:
        return all(read_sealed(folder / name) for name in names)
    except DamagedError:
        return False


def begin_again(
    folder: Path, listen: Listen = nobody, plugins: bool = False, place: Place = HERE, start: Path | None = None
) -> Path:
    """An improvement or a diagnosis that did not come to its end, from its beginning, beside what is there until it is
    done. start: a fit to go on from instead of the one that it began with; from that it is sought anew where it came to
    its end, too. Raises InputError where the folder holds none."""
    task = read_environment(folder)["task"]
    if start is None and is_whole(folder):
        listen({"event": "finished"})
        return folder
    job = Job.from_text(read_job(folder), folder, str(folder / "job.yaml"), plugins)
    new = folder.with_name(f".{folder.name}.again")
    if task["name"] not in TASKS:
        raise InputError(f"was begun with {task['name']!r}", where=str(folder), remedy="start it anew")
    with event_log(folder, listen):
        shutil.rmtree(new, ignore_errors=True)
        before = task.get("start")
        sought_at(place, task["name"], job, new, listen, task.get("budget"), start or (before and Path(before)))
        names = (path.relative_to(new).as_posix() for path in new.rglob("*") if path.is_file())
        for name in sorted(names, key=end_last):
            (folder / name).parent.mkdir(exist_ok=True)
            (new / name).replace(folder / name)
        shutil.rmtree(new)
    return folder
