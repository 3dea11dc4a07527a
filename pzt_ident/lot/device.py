"""The job on one device: what a worker does at a time."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from pzt_ident.data.faults import fault_phrases
from pzt_ident.data.readers import read_records
from pzt_ident.data.record import Record
from pzt_ident.diagnosis.criteria import CLEAR, VALIDATION_FACTOR
from pzt_ident.errors import InputError, RunError
from pzt_ident.files import digest_of, read_files, read_sealed, write_bytes, write_json, write_sealed, write_text
from pzt_ident.job.files import Template, on_files
from pzt_ident.job.schema import Job
from pzt_ident.lot.measured import measured
from pzt_ident.model.registry import blocks
from pzt_ident.run.collect import collect
from pzt_ident.run.elsewhere import move
from pzt_ident.run.events import nobody
from pzt_ident.run.folder import environment
from pzt_ident.run.identify import tasks_of
from pzt_ident.run.improve import improve
from pzt_ident.run.statement import Statement
from pzt_ident.run.task import search

WITHIN_95 = 1.96  # standard errors to either side hold the truth in 95 of 100 cases


@dataclass(frozen=True)
class Orders:
    """What is the same for all devices. folder: that of the job."""

    template: Template
    folder: Path
    command: str
    improve: bool
    budget: float | None


@dataclass(frozen=True)
class Given:
    """A device as a worker gets it. key: of job and data. sha256: of the data. home: its folder of results. files:
    where each file of the job is, as the user named it. contents: those of the files, where the worker does not share
    the disk."""

    name: str
    key: str
    sha256: str
    home: Path
    files: Mapping[str, Path]
    contents: Mapping[str, bytes] | None = None

    def names(self) -> dict[str, str]:
        """Each file as the job in the device's own folder names it."""
        return {file: _relative(path, self.home) for file, path in self.files.items()}


def _relative(path: Path, folder: Path) -> str:
    import os

    return os.path.relpath(path.resolve(), folder.resolve())


def identify_device(tell: Any, orders: Orders, given: Given) -> dict[str, bytes]:
    """Entry of a worker; returns the files of the device's folder. `device.json` among them is its row of the table.

    Raises InputError where its data are wrong, RunError where no search came to anything.
    """
    start, job = time.process_time(), _job(orders, given)
    own = {name: given.files[file] for file, name in given.names().items()}
    with named_as_given(own), TemporaryDirectory(prefix="pzt-ident-") as scratch:
        records, folder = read(job, orders, given, Path(scratch)), Path(scratch) / "device"
        result = identified(job, records, orders, folder)
        improvement = improved(job, records, orders, given, folder / "improved") if orders.improve else {}
        row = row_of(given, result, improvement) | {"readings": wrong_readings(records)}
        row |= {"measured": measured(records), "cpu_seconds": time.process_time() - start}
        write_sealed(folder / "device.json", row | {"written": written(folder)})
        return read_files(folder)


def wrong_readings(records: list[Record]) -> list[str]:
    """What looks wrong with the readings of a device, by its record."""
    return [f"{record.name}: {phrase}" for record in records for phrase in fault_phrases(record)]


def written(folder: Path) -> dict[str, str]:
    """The digest of each file of a device, less what a report makes again."""
    files = (path for path in sorted(folder.rglob("*")) if path.is_file() and path.name != "residuals.json")
    return {path.relative_to(folder).as_posix(): digest_of(path) for path in files}


@lru_cache(maxsize=4)
def _stated(text: str, folder: Path) -> Job:
    return Job.from_text(text, folder, plugins=True)


def _job(orders: Orders, given: Given) -> Job:
    """The job of the device, in its folder; all that does not hang on the files is made once a worker."""
    stated = _stated(orders.template.on({}), orders.folder)
    names = given.names()
    job = on_files(stated, lambda file: names[file])
    job._text, job._folder = orders.template.on(names), given.home.resolve()
    return job


def read(job: Job, orders: Orders, given: Given, scratch: Path) -> list[Record]:
    """The records of the device. Errors name its files as the user did."""
    stated = _stated(orders.template.on({}), orders.folder)
    paths = {file: path.resolve() for file, path in given.files.items()}
    if given.contents is not None:
        paths = {file: scratch / f"{place}-{path.name}" for place, (file, path) in enumerate(paths.items())}
        for file, content in given.contents.items():
            write_bytes(paths[file], content)
    here = on_files(stated, lambda file: str(paths[file]))
    sources = [
        replace(source, name=source.name or Path(file.file).stem)
        for source, file in zip(here.records, stated.records, strict=True)
    ]
    with named_as_given({str(path): given.files[file] for file, path in paths.items()}):
        records = read_records(sources, here.channels.axes, here.channels.time, Path())
    return [replace(record, file=source.file) for record, source in zip(records, job.records, strict=True)]


@contextmanager
def named_as_given(files: Mapping[str, Path]) -> Iterator[None]:
    """Errors name files as the user did. files: as the user named them, by how the errors do."""

    def shown(text: str) -> str:
        for name, path in files.items():
            text = text.replace(name, str(path))
        return text

    try:
        yield
    except InputError as error:
        raise InputError(shown(error.message), where=shown(error.where), remedy=shown(error.remedy)) from None
    except RunError as error:
        raise RunError(shown(str(error))) from None


def identified(job: Job, records: list[Record], orders: Orders, folder: Path) -> dict[str, Any]:
    """The run of the job on these records, in a folder as `pzt-ident run` leaves it, less the losses."""
    statement = Statement(job, records)
    write_text(folder / "job.yaml", job.text)
    write_json(folder / "environment.json", environment(job, records) | {"command": orders.command})
    tasks, failed = tasks_of(statement, folder), dict[str, str]()
    for task in tasks:
        try:
            search(task, statement, nobody)
        except RunError as error:
            failed[task.run] = str(error)
    result = collect(statement, folder, tasks, failed, misfits=False)
    for task in tasks:
        task.losses.unlink(missing_ok=True)  # nine tenths of all bytes, and never needed again
    return result


def improved(job: Job, records: list[Record], orders: Orders, given: Given, folder: Path) -> dict[str, Any]:
    improve(job, folder, budget=orders.budget, records=records)
    move(folder, given.home / "improved")
    return read_sealed(folder / "improvement.json") | {"faults": read_sealed(folder / "diagnosis.json")["faults"]}


def missing_of(improvement: Mapping[str, Any]) -> list[str]:
    """What a model misses: each effect that was added, with those that the data cannot tell from it as `A or B`."""
    classes = {step["added"]: " or ".join(step["class"]) for step in improvement["steps"] if step["class"]}
    return [classes.get(effect, effect) for effect in improvement["effects"]]


def row_of(given: Given, result: dict[str, Any], improvement: dict[str, Any]) -> dict[str, Any]:
    best, floor = result["best"], result["floor"]
    last = improvement["steps"][-1] if improvement else best
    return {
        "device": given.name,
        "key": given.key,
        "state": "done",
        "reason": improvement.get("reason", ""),
        "verdict": improvement["verdict"] if improvement else verdict_of(best["rmse"], floor),
        "effects": improvement.get("effects", []),
        "missing": missing_of(improvement) if improvement else [],
        "faults": {word: blocks[word].remedy for word in improvement.get("faults", [])},
        "suspects": [suspect["effect"] for suspect in improvement.get("suspects", [])],
        "unit": result["unit"],
        "rmse": best["rmse"],
        "rmse_improved": last["rmse"] if improvement else None,
        "noise_floor": floor,
        "step_change": max(record["step_change"] for record in result["records"]),
        "parameters": {
            name: interval(parameter) | {"verdict": parameter["verdict"]}
            for name, parameter in best["parameters"].items()
        },
        "improved": {
            name: interval(parameter) | {"verdict": parameter["verdict"]}
            for name, parameter in last["parameters"].items()
            if improvement
        },
        "amounts": last.get("amounts", []),
        "files": {file: str(path) for file, path in given.files.items()},
        "sha256": given.sha256,
    }


def interval(parameter: Mapping[str, Any]) -> dict[str, Any]:
    """A parameter with the ends of its interval of 95 %; none where the data do not determine it."""
    value, error = parameter["value"], parameter["standard_error"]
    near = (None, None) if error is None else (value - WITHIN_95 * error, value + WITHIN_95 * error)
    ends = parameter.get("interval") or near
    return {"value": value, "unit": parameter["unit"], "low": ends[0], "high": ends[1]}


def verdict_of(rmse: Mapping[str, float | None], floor: float | None) -> str:
    """Whether a model is at the noise, as a diagnosis would see it; what is missing only an improvement says."""
    if not floor or rmse["identify"] is None:
        return "noise not known"
    most = floor * np.hypot(1, CLEAR), floor * np.hypot(1, VALIDATION_FACTOR * CLEAR)
    at_noise = rmse["identify"] <= most[0] and (rmse["validate"] is None or rmse["validate"] <= most[1])
    return "adequate" if at_noise else "above the noise"
