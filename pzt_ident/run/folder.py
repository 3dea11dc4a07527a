"""The folder of a run: where it is, what it begins with, and what is needed to go on with it."""

from __future__ import annotations

import errno
import os
import platform
import sys
from collections.abc import Mapping, Sequence
from datetime import datetime
from functools import cache
from pathlib import Path
from typing import Any

from pzt_ident.data.record import Record
from pzt_ident.errors import InputError
from pzt_ident.files import damaged, read_sealed, write_json, write_text
from pzt_ident.job.schema import Job
from pzt_ident.run.alone import LOCK

PACKAGES = ("pzt-ident", "numpy", "scipy", "numba", "pandas", "pyswarms", "deap", "cma")


def results_folder(job: Job, out: Path | None) -> Path:
    """Where the results of a job go: `out`, else `results/<name>/<time>-<hash>`."""
    return out or Path("results") / job.name / f"{datetime.now():%Y%m%d-%H%M%S}-{job.hash}"


def begin(folder: Path, job: Job, text: str, records: Sequence[Record], task: Mapping[str, Any] | None = None) -> None:
    """Make the folder of a run and put the job's text and the environment into it. task: what was asked for beside a
    run, to begin it again.

    Raises InputError where that cannot be, or something is in it.
    """
    make_empty(folder, text)
    write_text(folder / "job.yaml", text, lasting=True)
    content = environment(job, records) | ({"task": dict(task)} if task else {})
    write_json(folder / "environment.json", content, lasting=True)


def make_empty(folder: Path, text: str) -> None:
    """Make the folder. Raises InputError where that cannot be, or something is in it but what is left of a beginning
    with this text of a job."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        if not os.access(folder, os.W_OK):
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))
        full = any(not _is_left(path, text) for path in folder.iterdir())
    except OSError as error:
        remedy = "give another folder with --out"
        raise InputError(error.strerror or str(error), where=str(folder), remedy=remedy) from None
    if full:
        resumable = any((folder / name).is_file() for name in ("environment.json", "fleet.json"))
        remedy = "give another folder with --out" + ", or resume it" * resumable
        raise InputError("this folder is not empty", where=str(folder), remedy=remedy)


def _is_left(path: Path, text: str) -> bool:
    """Whether a file is of a beginning that was killed: the job, its lock, or what was to become a file."""
    if path.name == "job.yaml":
        return path.is_file() and path.read_bytes() == text.encode("utf-8", "backslashreplace")
    if path.name == LOCK:
        return True
    return path.name.startswith((".job.yaml.", ".environment.json.", ".fleet.json.")) and path.suffix == ".tmp"


def environment(job: Job, records: Sequence[Record]) -> dict[str, Any]:
    """Where this ran and on what: enough to run it again, and to go on with nothing else."""
    return {
        "python": platform.python_version(),
        "platform": platform.platform(),
        "cpu": platform.processor() or platform.machine(),
        "cores": os.cpu_count(),
        "packages": {name: version_of(name) for name in PACKAGES},
        "command": " ".join(["pzt-ident", *sys.argv[1:]]),
        "data": {record.name: record.sha256 for record in records},
        "job_hash": job.hash,
        "job_name": job.name,
        "job_folder": str(job.folder.resolve()),
    }


@cache
def version_of(package: str) -> str:
    from importlib.metadata import PackageNotFoundError, version

    try:
        return version(package)
    except PackageNotFoundError:
        return "not installed"


def read_environment(folder: Path) -> dict[str, Any]:
    """The environment of the run in a folder. Raises InputError where there is none, DamagedError where it is not as it
    was written."""
    path = folder / "environment.json"
    if not path.is_file():
        remedy = "give the folder that `pzt-ident run` wrote"
        raise InputError("holds no run", where=str(folder), remedy=remedy)
    environment = read_sealed(path)
    texts = all(isinstance(environment.get(key), str) for key in ("command", "job_hash", "job_name", "job_folder"))
    if not texts or not isinstance(environment.get("data"), dict) or not isinstance(environment.get("task", {}), dict):
        raise damaged(path, "does not say what this run began with")
    return environment


def read_job(folder: Path, name: str = "job.yaml") -> str:
    """The text of the job that a folder was begun with. Raises InputError where it cannot be read."""
    path = folder / name
    try:
        return path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError):
        remedy = "put the job in its place that the run began with, or start a new run"
        raise InputError("cannot be read", where=str(path), remedy=remedy) from None


def check_unchanged(job: Job, records: Sequence[Record], environment: dict[str, Any], folder: Path) -> None:
    """Raises InputError where job or data are not those of the environment that a run began with."""
    remedy = "undo the change, or start a new run"
    if job.hash != environment["job_hash"]:
        raise InputError("is not the job that this run began with", where=str(folder / "job.yaml"), remedy=remedy)
    for record in records:
        if record.sha256 != environment["data"].get(record.name):
            where = str(job.folder / record.file)
            raise InputError("has changed since this run began", where=where, remedy=remedy)
