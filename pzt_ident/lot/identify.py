"""A job on a lot of devices, in a folder that can be gone on with: what was done is not done again."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from pzt_ident.errors import DamagedError, InputError
from pzt_ident.files import read_sealed, write_sealed, write_text
from pzt_ident.job.files import Template
from pzt_ident.job.schema import Job
from pzt_ident.lot.device import Orders
from pzt_ident.lot.devices import devices_of
from pzt_ident.lot.identification import Identification
from pzt_ident.run.alone import alone_in
from pzt_ident.run.events import Listen, nobody
from pzt_ident.run.folder import make_empty, read_job
from pzt_ident.run.place import HERE, Place

NOT_A_FLEET = "give the folder that `pzt-ident fleet` wrote"


def fleet(
    job: Job,
    patterns: Sequence[str],
    out: Path | None = None,
    *,
    improve: bool = False,
    budget: float | None = None,
    place: Place = HERE,
    listen: Listen = nobody,
) -> Path:
    """Identify the job's model on every device, and diagnose each if `improve`; returns the folder of results.

    A folder a device, `devices.parquet` and `devices.csv` of all. In a folder that holds a fleet, what was done with
    the same job on the same data stays. patterns: of folders, of files, or tables with a column `file` or `folder`.
    Raises InputError where job or patterns are wrong, or another process is at work in the folder, LostError where the
    place is gone.
    """
    folder = out or Path("results") / job.name / "fleet"
    devices = devices_of(patterns, job)
    if not (folder / "fleet.json").is_file():
        make_empty(folder, job.text)
    with alone_in(folder):
        tell_other(folder, job, improve, budget, listen)
        orders = orders_of(job, patterns, improve, budget, folder)
        return Identification(folder, devices, job, orders, listen).identify(place)


def tell_other(folder: Path, job: Job, improve: bool, budget: float | None, listen: Listen) -> None:
    """Say that something else was asked of the fleet in a folder. Raises InputError where what it took longest for
    would go: the improvements of its devices."""
    try:
        stated = read_statement(folder)
    except InputError:
        return
    if stated["improve"] and not improve and any(folder.glob("devices/*/improved")):
        remedy = "give --improve, or another folder with --out"
        problem = "holds a fleet made with --improve, whose improvements would be lost"
        raise InputError(problem, where=str(folder), remedy=remedy)
    before = stated["job_hash"], stated["improve"], stated["budget"]
    if before != (job.hash, improve, budget):
        listen({"event": "other", "said": f"this is not what was asked before in {folder}: every device is done again"})


def orders_of(job: Job, patterns: Sequence[str], improve: bool, budget: float | None, folder: Path) -> Orders:
    """Write what a fleet is asked for into its folder; the same as orders to its workers."""
    statement = {
        "job_name": job.name,
        "job_folder": str(job.folder.resolve()),
        "job_hash": job.hash,
        "patterns": list(patterns),
        "working_folder": os.getcwd(),
        "improve": improve,
        "budget": budget,
        "command": " ".join(["pzt-ident", *sys.argv[1:]]),
    }
    write_text(folder / "job.yaml", job.text, lasting=True)
    write_sealed(folder / "fleet.json", statement, lasting=True)
    return Orders(Template(job), job.folder.resolve(), str(statement["command"]), improve, budget)


def is_fleet(folder: Path) -> bool:
    return (folder / "fleet.json").is_file()


def resume(folder: Path, *, place: Place = HERE, listen: Listen = nobody, plugins: bool = False) -> Path:
    """Go on with a fleet that was stopped: devices that were not done, that failed, or whose data have changed."""
    stated = read_statement(folder)
    job = Job.from_text(read_job(folder), Path(stated["job_folder"]), f"{stated['job_name']}.yaml", plugins)
    base = Path(os.path.relpath(stated["working_folder"]))
    patterns = [str(base / pattern) + "/" * pattern.endswith("/") for pattern in stated["patterns"]]
    return fleet(job, patterns, folder, improve=stated["improve"], budget=stated["budget"], place=place, listen=listen)


def read_statement(folder: Path) -> dict[str, Any]:
    """What a fleet was asked for. Raises InputError where the folder holds none."""
    try:
        stated = read_sealed(folder / "fleet.json")
        return stated | {"patterns": list(stated["patterns"]), "improve": bool(stated["improve"])}
    except (DamagedError, KeyError, TypeError):
        if not is_fleet(folder):
            raise InputError("holds no fleet", where=str(folder), remedy=NOT_A_FLEET) from None
        remedy = f"give the command that made it again, with --out {folder}: what was identified stays"
        raise InputError("its fleet.json is damaged", where=str(folder), remedy=remedy) from None
