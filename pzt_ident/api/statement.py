"""The job that arguments of the library state: the same text that the command line reads, on arrays."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, replace
from io import StringIO
from itertools import chain, count
from pathlib import Path
from typing import Any
from urllib.parse import quote

import numpy as np

from pzt_ident.api.arguments import Signals
from pzt_ident.api.model import Model
from pzt_ident.api.record import Record
from pzt_ident.api.wording import as_arguments
from pzt_ident.data import record as data
from pzt_ident.data.readers import read_records
from pzt_ident.data.units import same_kind
from pzt_ident.errors import InputError
from pzt_ident.job.schema import Job
from pzt_ident.job.sections import Choice
from pzt_ident.run.statement import Statement

ARGUMENT = {"identify": "train", "validate": "validate"}
NAME = {"identify": "train", "validate": "test"}


def job_text(name: str, model: Model, records: Mapping[str, Sequence[Record]], sections: Mapping[str, Any]) -> str:
    """The YAML of a job on records that lie in `data/` beside it, by use. sections: those of a job; empty ones are left
    out."""
    stamps = has_stamps(records)
    content: dict[str, Any] = {"name": name}
    content["records"] = [_record(record, use, stamps) for use, each in records.items() for record in each]
    axes = next(iter(records["identify"])).channels()
    content["channels"] = ({"time": "time [s]"} if stamps else {}) | {"axes": axes}
    content["model"] = [_item(item) for item in model.blocks]
    content["effects"] = list(model.effects)
    content |= {"shared": list(model.shared)} | dict(sections)
    return _yaml({key: _plain(value, key) for key, value in content.items() if not _blank(value)})


def sections_of(job: Job) -> dict[str, Any]:
    """What a job says beside its model and records."""
    limits = {key: value for key, value in asdict(job.limits).items() if value is not None}
    stop = {key: value for key, value in asdict(job.stop).items() if value is not None}
    if job.stop.target:
        stop["target"] = f"{job.stop.target.value!r} {job.stop.target.unit or ''}".strip()
    parameters = {
        name: {"bounds": list(spec.bounds)} if spec.bounds else {"value": spec.value}
        for name, spec in job.parameters.items()
    }
    return {
        "rule_out": list(job.rule_out),
        "parameters": parameters,
        "optimizers": [_item(choice) for choice in job.optimizers],
        "repeats": job.repeats,
        "seed": job.seed,
        "polish": job.polish,
        "stop": stop,
        "limits": {key: list(value) if isinstance(value, tuple) else value for key, value in limits.items()},
    }


def statement_of(text: str, records: Mapping[str, Sequence[Record]]) -> Statement:
    """What the job of a text states about records in memory.

    Raises InputError with the sentences of the command line, in the words of the arguments.
    """
    stamps = has_stamps(records)
    arrays = {file_of(record): record.table(stamps) for each in records.values() for record in each}
    with as_arguments():
        job = Job.from_text(text, Path(), "")
        signals = read_records(job.records, job.channels.axes, job.channels.time, job.folder, arrays)
        return Statement(job, signals)


def drive_record(t: Any, u: Signals | None, like: data.Record) -> data.Record:
    """Drives as the simulator takes them, the responses blank ones as another record has them. t and u are those of a
    `Record`, u in the units of the other; or t is one.

    Raises InputError where an axis is missing or in another kind of unit, or the time is not uniform.
    """
    given = t if isinstance(t, Record) else Record(t, u, name="drive")
    record = given.with_name(given.name or "drive")
    units = dict(zip(like.axes, like.drive_units, strict=True))
    if set(record.axes) != set(like.axes):
        problem = f"drives {', '.join(record.axes)}, the model has {', '.join(like.axes)}"
        raise InputError(problem, where="simulate: u", remedy="give a drive of each axis")
    if given is not t:
        record.drive = units
    for axis, unit in units.items():
        if not same_kind(record.drive[axis], unit):
            problem = f"axis {axis} is in {record.drive[axis]}, the model takes {unit}"
            raise InputError(problem, where="simulate: u", remedy=f"give it in a unit such as {unit}")
    drives = uniform(record, like.axes)
    return replace(drives, response=np.zeros_like(drives.drive), response_units=like.response_units)


def uniform(record: Record, axes: Sequence[str]) -> data.Record:
    """The drives of a record on a uniform grid, in SI units, the axes in this order."""
    headers = record.channels()
    channels = {axis: data.Axis(data.Channel(name=headers[axis]["drive"])) for axis in axes}
    settings: dict[str, Any] = {
        "sample_rate": record.rate,
        "run_in": record.run_in,
        "rest_at": {axis: data.Level(level, record.drive[axis]) for axis, level in record.rest_at.items()},
        "denoise_drive": record.denoise_drive,
        "smooth_drive": record.smooth_drive,
        "steps": record.steps,
    }
    source = data.Source(file_of(record), name=record.name, **settings)
    time = data.Channel(name="time [s]") if record.t is not None else None
    with as_arguments():
        (drives,) = read_records([source], channels, time, Path(), {source.file: record.table(time is not None)})
    return drives


def has_stamps(records: Mapping[str, Sequence[Record]]) -> bool:
    """Whether the records have a column of time: all of them, unless each has a sample rate alone."""
    return any(record.t is not None for each in records.values() for record in each)


def file_of(record: Record) -> str:
    """Where a record lies beside the job."""
    return f"data/{quote(record.name, safe=' ')}.csv"


def named_apart(records: Mapping[str, Sequence[Record]]) -> dict[str, tuple[Record, ...]]:
    """The records by use; those without a name are train or test, several of them numbered.

    Raises InputError where two were given one name, or axes differ.
    """
    taken: set[str] = set()
    first = next(iter(records["identify"]))
    for use, each in records.items():
        for record in each:
            _check_axes(record, first, ARGUMENT[use])
            if record.name and record.name in taken:
                remedy = "give each record a name: Record(..., name='slow')"
                raise InputError(f"two records are named {record.name!r}", where=ARGUMENT[use], remedy=remedy)
            taken.add(record.name)
    return {use: tuple(_named(each, NAME[use], taken)) for use, each in records.items()}


def _check_axes(record: Record, first: Record, where: str) -> None:
    for driven, axes, usual in (("axes", record.u, first.u), ("responses", record.y, first.y)):
        if set(axes) != set(usual):
            problem = f"{_title(record)} has the {driven} {_listed(axes)}, not {_listed(usual)}"
            raise InputError(problem, where=where, remedy=f"give all records the same {driven}")


def _title(record: Record) -> str:
    return f"record {record.name!r}" if record.name else "a record"


def _listed(axes: Iterable[str]) -> str:
    return ", ".join(axes) or "none"


def _named(each: Sequence[Record], word: str, taken: set[str]) -> Iterator[Record]:
    alone = sum(not record.name for record in each) == 1
    names = chain([word] if alone else [], (f"{word}_{number}" for number in count(1)))
    free = (name for name in names if name not in taken)
    return (record if record.name else record.with_name(next(free)) for record in each)


def _record(record: Record, use: str, stamps: bool) -> dict[str, Any]:
    facts: dict[str, Any] = {"file": file_of(record), "use": use, "name": record.name}
    facts |= {} if stamps else {"sample_rate": record.rate}
    usual = {"settle": 0.0, "run_in": 0, "rest_at": {}, "denoise_drive": False, "smooth_drive": None, "steps": 1}
    return facts | {key: getattr(record, key) for key, value in usual.items() if getattr(record, key) != value}


def _item(item: str | Choice) -> Any:
    return item if isinstance(item, str) else {"name": item.name, **item.settings}


def _blank(value: Any) -> bool:
    return value is None or (isinstance(value, dict | list) and not value)


def _plain(value: Any, where: str) -> Any:
    """What YAML has words for, NumPy's numbers and arrays as Python's. Raises InputError for anything else."""
    if isinstance(value, np.generic | np.ndarray):
        return _plain(value.tolist(), where)
    if isinstance(value, Mapping):
        return {str(key): _plain(item, where) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item, where) for item in value]
    if value is None or isinstance(value, str | bool | int | float):
        return value
    raise InputError(f"{type(value).__name__} is no plain value", where=where, remedy="give a number or text")


def _yaml(content: dict[str, Any]) -> str:
    """Block style, the items of each section on a line of their own."""
    from ruamel.yaml import YAML
    from ruamel.yaml.comments import CommentedMap, CommentedSeq

    def inline(value: Any) -> Any:
        if isinstance(value, dict):
            node: Any = CommentedMap({str(key): inline(item) for key, item in value.items()})
        elif isinstance(value, list | tuple):
            node = CommentedSeq([inline(item) for item in value])
        else:
            return value
        node.fa.set_flow_style()
        return node

    def section(value: Any) -> Any:
        if isinstance(value, dict):
            return CommentedMap({key: inline(item) for key, item in value.items()})
        if isinstance(value, list) and any(isinstance(item, dict) for item in value):
            return CommentedSeq([inline(item) for item in value])
        return inline(value)

    document = CommentedMap({key: section(value) for key, value in content.items()})
    yaml = YAML()
    yaml.width = 10_000
    text = StringIO()
    yaml.dump(document, text)
    return text.getvalue()
