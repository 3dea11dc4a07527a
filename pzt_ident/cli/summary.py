"""What a job and its data hold, and what a word in a job stands for: as data, and as text for the terminal."""

from __future__ import annotations

import inspect
from collections.abc import Iterator
from dataclasses import asdict, fields
from itertools import groupby
from typing import TYPE_CHECKING, Any

import click
import numpy as np

from pzt_ident.cli import terminal
from pzt_ident.data.units import factor
from pzt_ident.errors import InputError, nearest
from pzt_ident.model.block import Term
from pzt_ident.model.registry import blocks, optimizers
from pzt_ident.report.words import ranges

if TYPE_CHECKING:
    from pzt_ident.data.record import Record
    from pzt_ident.job.schema import Job
    from pzt_ident.model.parameter import Form, Setting
    from pzt_ident.search.problem import Problem

Facts = dict[str, Any]


def of_job(job: Job) -> Facts:
    """Records, axes, parameters and optimizers of a job. Raises InputError on whatever is wrong with its data."""
    from pzt_ident.run.identify import read, tasks_of
    from pzt_ident.run.task import problem_of

    records = read(job)
    problem = problem_of(job, records)
    tasks = tasks_of(job, records, job.folder)
    return {
        "name": job.name,
        "hash": job.hash,
        "model": [block.name for block in problem.model.blocks],
        "records": [_record(record) for record in records],
        "axes": [_axis(records, axis) for axis in range(len(records[0].axes))],
        "parameters": _parameters(problem),
        "runs": [task.run for task in tasks],
        "evaluations": sum(task.stop["evaluations"] for task in tasks),
    }


def _record(record: Record) -> Facts:
    return {
        "name": record.name,
        "use": record.use,
        "samples": record.samples,
        "sample_rate": 1 / record.dt,
        "seconds": record.samples * record.dt,
        "settle": record.settle * record.dt,
        "file": record.file,
        "notes": list(record.notes),
    }


def _axis(records: list[Record], axis: int) -> Facts:
    first = records[0]
    channels = {"drive": first.drive_units[axis], "response": first.response_units[axis]}
    facts: Facts = {"name": first.axes[axis]}
    for channel, unit in channels.items():
        facts[f"{channel}_unit"] = unit
        if unit is not None:
            values = [getattr(record, channel)[axis] / factor(unit) for record in records]
            facts[f"{channel}_range"] = [float(min(map(np.min, values))), float(max(map(np.max, values)))]
    return facts


def _parameters(problem: Problem) -> list[Facts]:
    bounds = dict(zip(problem.names, zip(problem.lower, problem.upper, strict=True), strict=True))
    found = []
    for entry, unit, value in zip(problem.model.entries, problem.all_units, problem.theta, strict=True):
        facts: Facts = {"name": entry.name, "unit": unit, "doc": entry.parameter.doc}
        if entry.name in bounds:
            facts["bounds"] = [float(bound) for bound in bounds[entry.name]]
        elif np.isfinite(value):
            facts["value"] = float(value / factor(unit))
        found.append(facts)
    return found


def show_job(found: Facts) -> None:
    number = terminal.number
    click.echo(f"{found['name']} ({found['hash']}): {' -> '.join(found['model'])}\n")
    terminal.table(
        ("record", "use", "samples", "rate [Hz]", "length [s]", "not scored [s]", "file"),
        [
            (row["name"], row["use"], row["samples"], *(number(row[key]) for key in _TIMES), row["file"])
            for row in found["records"]
        ],
    )
    terminal.show_notes(found["records"])
    terminal.table(
        ("axis", "drive", "response"),
        [(axis["name"], _range(axis, "drive"), _range(axis, "response")) for axis in found["axes"]],
    )
    terminal.table(
        ("parameter", "unit", "bounds", "what it is"),
        [(row["name"], row["unit"], _searched(row), row["doc"]) for row in _together(found["parameters"])],
    )
    click.echo(f"runs: {' '.join(found['runs'])}, {found['evaluations']} evaluations in all")


def _together(rows: list[Facts]) -> Iterator[Facts]:
    """Rows of parameters, those in one that differ in their number alone."""
    for facts, alike in groupby(rows, lambda row: {key: value for key, value in row.items() if key != "name"}):
        yield from (facts | {"name": said} for said in ranges(row["name"] for row in alike))


_TIMES = ("sample_rate", "seconds", "settle")


def _range(axis: Facts, channel: str) -> str:
    if axis[f"{channel}_unit"] is None:
        return "not measured"
    low, high = axis[f"{channel}_range"]
    return f"{low:.4g} to {high:.4g} {axis[f'{channel}_unit']}"


def _searched(row: Facts) -> str:
    """What becomes of a parameter."""
    if not {"value", "bounds"} & set(row):
        return "solved for"
    return "fixed at {:.4g}".format(row["value"]) if "value" in row else "{:.4g} to {:.4g}".format(*row["bounds"])


def words(kind: str) -> dict[str, str]:
    """The words of a kind (`blocks`, `effects` or `optimizers`) with the first line of what they are."""
    if kind == "optimizers":
        return {item.name: _headline(item) for item in optimizers}
    own = {item.name: _headline(item) for item in blocks if bool(item.remedy) == (kind == "effects")}
    return (_terms() if kind == "effects" else {}) | own


def _terms() -> dict[str, str]:
    """Effects that are parameters of other blocks, with those blocks."""
    found: dict[str, list[str]] = {}
    for block in blocks:
        for declared in block.parameters().values():
            if declared.effect and block.name not in found.setdefault(declared.effect, []):
                found[declared.effect].append(block.name)
    return {effect: "a term of " + ", ".join(owners) for effect, owners in sorted(found.items())}


def _headline(item: type) -> str:
    return (inspect.getdoc(item) or "").partition("\n")[0]


def of_word(name: str) -> Facts:
    """What a block, effect or optimizer declares. Raises InputError with the nearest words for an unknown one."""
    if name in blocks:
        return _block(name)
    if name in optimizers:
        return _optimizer(name)
    terms = _terms()
    if name in terms:
        return {"name": name, "kind": "effect", "doc": terms[name], "parameters": _owned(name)}
    raise InputError(f"unknown word {name!r}", remedy=nearest(name, [*blocks.words(), *optimizers.words(), *terms]))


def _owned(effect: str) -> list[Facts]:
    """The parameters of all blocks that belong to an effect."""
    every = [row | {"name": f"{block.name}.{row['name']}"} for block in blocks for row in _declared(block)]
    return [row for row in every if row["effect"] == effect]


def _block(name: str) -> Facts:
    block, kind = blocks[name], blocks.folder(name)
    facts = {"name": name, "kind": kind, "doc": inspect.getdoc(block)}
    if kind == "effects":
        facts |= {key: getattr(block, key) for key in ("look_alikes", "separate_by", "remedy")}
    if issubclass(block, Term):
        return facts | {"parameters": _owned(name)}
    forms = [block, *(block.make(**{word: each}) for word, each in _forms(block))]
    settings = {word: item for form in forms for word, item in form.settings().items()}
    rows = [{"name": word, "default": item.value, "unit": "1"} | _choices(item) for word, item in settings.items()]
    own = {"settings": rows} if rows else {}
    return facts | {"place": block.place.name.lower(), "parameters": _declared(block)} | own


def _forms(block: type[Any]) -> list[tuple[str, str]]:
    """Settings with the words that make another form of a block."""
    every = [(word, each) for word, item in block.settings().items() for each in getattr(item, "words", ())]
    return [(word, each) for word, each in every if each in block.forms]


def _choices(item: Setting | Form) -> Facts:
    return {key: value for key, value in asdict(item).items() if key != "value"}


def _declared(block: type[Any]) -> list[Facts]:
    """Parameters of a block, and what another form of it has beside them."""
    keys = ("unit", "bounds", "null", "value", "scale", "effect", "per_record", "doc")
    own = {name: (declared, "") for name, declared in block.parameters().items()}
    for word, each in _forms(block):
        more = block.make(**{word: each}).parameters()
        usual = f"{word}: {block.setting(word)}"
        own = {name: (item, form if name in more else usual) for name, (item, form) in own.items()}
        own |= {name: (item, f"{word}: {each}") for name, item in more.items() if name not in own}
    return [
        {"name": name, "form": form} | {key: getattr(item, key) for key in keys} for name, (item, form) in own.items()
    ]


def _optimizer(name: str) -> Facts:
    item = optimizers[name]
    settings = [{"name": setting.name, "default": setting.default, **setting.metadata} for setting in fields(item)]
    return {"name": name, "kind": "optimizer", "doc": inspect.getdoc(item), "source": item.source, "settings": settings}


def show_word(found: Facts) -> None:
    click.echo(f"{found['name']} ({found['kind']})\n\n{found['doc']}\n")
    if source := found.get("source"):
        click.echo(f"{source}\n")
    if "settings" in found:
        terminal.table(
            ("setting", "default", "from - to", "unit", "what it is"),
            [(row["name"], row["default"], _allowed(row), row["unit"], row["doc"]) for row in found["settings"]],
        )
    if "parameters" in found:
        terminal.table(
            ("parameter", "unit", "bounds", "null", "what it is"),
            [
                (row["name"], row["unit"], "{:g} to {:g}".format(*row["bounds"]), _plain(row["null"]), _meaning(row))
                for row in _together(found["parameters"])
            ],
        )
        if any("drive" in row["unit"] or "response" in row["unit"] for row in found["parameters"]):
            click.echo("Bounds in units of drive and response are multiples of the data's own peak-to-peak values,")
            click.echo("those of response/drive with either sign where the response does not rise with the drive.")
    for title, key in (("Leaves the same trace as", "look_alikes"), ("To tell", "separate_by"), ("To do", "remedy")):
        if said := found.get(key):
            click.echo(f"\n{title}: {said if isinstance(said, str) else ', '.join(said)}")


def _allowed(row: Facts) -> str:
    return " or ".join(row["words"]) if "words" in row else "{:g} to {:g}".format(*row["bounds"])


def _plain(value: float | None) -> str:
    return "" if value is None else f"{value:g}"


def _meaning(row: Facts) -> str:
    """What a parameter is, and what it takes to have it searched for."""
    fixed = "" if row["value"] is None else f" Fixed at {row['value']:g} unless the job gives bounds."
    effect = "" if row["effect"] is None else f" With the effect {row['effect']} only."
    own = " Each record has its own." if row["per_record"] else ""
    form = f" With `{row['form']}` only." if row["form"] else ""
    return row["doc"] + fixed + effect + own + form
