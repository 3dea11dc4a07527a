"""The job that arguments of the library state: the same text that the command line reads, on arrays."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np

from pzt_ident.api.model import Model
from pzt_ident.api.record import Record
from pzt_ident.data import record as data
from pzt_ident.data.readers import read_records
from pzt_ident.errors import InputError
from pzt_ident.job.schema import Job
from pzt_ident.job.sections import Choice
from pzt_ident.run.statement import Statement

Numbers = Mapping[str, Any]


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
    rest = {"shared": list(model.shared)} | dict(sections)
    return _yaml(content | {key: value for key, value in rest.items() if value not in (None, {}, [])})


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

    Raises InputError with the sentences of the command line, without places in a file that nobody has seen.
    """
    job = Job.from_text(text, Path(), "")
    stamps = has_stamps(records)
    arrays = {file_of(record): record.table(stamps) for each in records.values() for record in each}
    signals = read_records(job.records, job.channels.axes, job.channels.time, job.folder, arrays)
    return Statement(job, signals)


def drive_record(record: Record, like: data.Record) -> data.Record:
    """The drives of a record as the simulator takes them, its responses blank ones as another record has them.

    Raises InputError where an axis is missing, or the time is not uniform.
    """
    if record.axes != like.axes:
        problem = f"drives {', '.join(record.axes)}, the model has {', '.join(like.axes)}"
        raise InputError(problem, where=record.name, remedy="give a drive of each axis")
    stamps = record.t is not None
    axes = {axis: data.Axis(data.Channel(name=header["drive"])) for axis, header in record.channels().items()}
    settings: dict[str, Any] = {"name": record.name, "run_in": record.run_in, "steps": record.steps}
    source = data.Source(record.name, sample_rate=record.rate, **settings)
    time = data.Channel(name="time [s]") if stamps else None
    (drives,) = read_records([source], axes, time, Path(), {record.name: record.table(stamps)})
    return replace(drives, response=np.zeros_like(drives.drive), response_units=like.response_units)


def has_stamps(records: Mapping[str, Sequence[Record]]) -> bool:
    """Whether the records have a column of time: all of them, unless each has a sample rate alone."""
    return any(record.t is not None for each in records.values() for record in each)


def file_of(record: Record) -> str:
    """Where a record lies beside the job."""
    return f"data/{record.name}.csv"


def named_apart(records: Mapping[str, Sequence[Record]]) -> None:
    """Raises InputError where two records have one name, or axes differ."""
    names: list[str] = []
    axes: tuple[str, ...] = ()
    for use, each in records.items():
        for record in each:
            if not isinstance(record, Record):
                remedy = "give pzt_ident.Record(t, u, y), or a list of them"
                raise InputError(f"{type(record).__name__} is no record", where=use, remedy=remedy)
            if record.name in names:
                remedy = "give each record a name: Record(..., name='slow')"
                raise InputError(f"two records are named {record.name!r}", where=use, remedy=remedy)
            axes = axes or record.axes
            if record.axes != axes:
                problem = f"record {record.name!r} has the axes {', '.join(record.axes)}, not {', '.join(axes)}"
                raise InputError(problem, where=use, remedy="give all records the same axes")
            names.append(record.name)


def _record(record: Record, use: str, stamps: bool) -> dict[str, Any]:
    facts: dict[str, Any] = {"file": file_of(record), "use": use, "name": record.name}
    facts |= {} if stamps else {"sample_rate": record.rate}
    usual = {"settle": 0.0, "run_in": 0, "steps": 1}
    return facts | {key: getattr(record, key) for key, value in usual.items() if getattr(record, key) != value}


def _item(item: str | Choice) -> Any:
    return item if isinstance(item, str) else {"name": item.name, **item.settings}


def _yaml(content: dict[str, Any]) -> str:
    """Block style, the items of each section on a line of their own."""
    from ruamel.yaml import YAML
    from ruamel.yaml.comments import CommentedMap, CommentedSeq

    def inline(value: Any) -> Any:
        if isinstance(value, dict):
            made: Any = CommentedMap({str(key): inline(item) for key, item in value.items()})
        elif isinstance(value, list | tuple):
            made = CommentedSeq([inline(item) for item in value])
        else:
            return value.item() if hasattr(value, "item") else value
        made.fa.set_flow_style()
        return made

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
