"""Identified models to export: of a fit, of a folder of results, of an exported JSON."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pzt_ident.api.arguments import rate_or_stamps
from pzt_ident.control.export.identified import Identified
from pzt_ident.control.export.tables import FORMAT
from pzt_ident.data.record import Record
from pzt_ident.data.units import factor
from pzt_ident.errors import InputError
from pzt_ident.job.chain import ChainParts
from pzt_ident.job.schema import Job, load_job
from pzt_ident.job.sections import Choice
from pzt_ident.run.statement import Statement

Array = NDArray[np.float64]
Errors = Mapping[str, float | None]
A_RESULT = "give the folder of a finished run or improvement, or the JSON of an export"


def of_fit(fit: Any) -> Identified:
    errors = {name: parameter.stderr for name, parameter in fit.parameters.items()}
    theta = fit.statement.problem.parameters(fit.point)[0]
    rmse = ", ".join(f"{error:.3g} {fit.unit} {use}" for use, error in fit.rmse.items() if error is not None)
    return of_statement(fit.statement, theta, errors, f"RMSE: {rmse}.")


def of_improvement(folder: Path, plugins: bool) -> Identified:
    """The last model of `pzt-ident improve`."""
    statement = Statement(load_job(folder / "improved.yaml", plugins))
    steps = json.loads((folder / "improvement.json").read_text(encoding="utf-8"))["steps"]
    values = {name: item["value"] for name, item in steps[-1]["parameters"].items()}
    if missing := [name for name in statement.problem.names if name not in values]:
        raise InputError(f"improvement.json has no value of {missing[0]}", where=str(folder), remedy="improve it again")
    theta = statement.problem.parameters(statement.problem.unit_point(values))[0]
    rmse = ", ".join(f"{error:.3g} {statement.unit} {use}" for use, error in steps[-1]["rmse"].items() if error)
    return of_statement(statement, theta, {}, f"RMSE: {rmse}.")


def of_statement(statement: Statement, theta: Array, errors: Errors, origin: str) -> Identified:
    """theta: SI units. errors: standard errors by name, in the user's units."""
    problem, records = statement.problem, [r for r in statement.records if r.use == "identify"]
    first = records[0]
    ends = np.array([[record.drive.min(axis=1), record.drive.max(axis=1)] for record in records])
    return Identified(
        statement.job.name,
        problem.model,
        theta,
        tuple(problem.all_units),
        tuple(errors.get(name) for name in problem.model.names),
        min(record.dt for record in records),
        np.array([ends[:, 0].min(axis=0), ends[:, 1].max(axis=0)]).T,
        tuple(first.drive_units),
        tuple(first.response_units),
        origin,
        words_of(statement.job),
    )


def words_of(job: Job) -> dict[str, Any]:
    """What makes the chain of a job again."""
    model = [item if isinstance(item, str) else {"name": item.name, **item.settings} for item in job.model]
    return {"model": model, "effects": list(job.effects), "shared": list(job.shared), "given": sorted(job.parameters)}


def of_json(path: Path) -> Identified:
    """Raises InputError for a file that is no export."""
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        content = {}
    if not isinstance(content, dict) or content.get("format") != FORMAT:
        raise InputError(f"is no {FORMAT!r}", where=str(path), remedy=A_RESULT)
    axes, values = content["axes"], content["parameters"]
    measured = tuple(i for i, units in enumerate(axes.values()) if units["response"] is not None)
    items = [item if isinstance(item, str) else choice(item) for item in (*content["model"], *content["effects"])]
    shared, given = tuple(content["shared"]), frozenset(content["given"])
    chain = ChainParts(tuple(items), tuple(axes), measured, shared, given).chain()
    if set(chain.names) != set(values):
        raise InputError("its parameters are not those of its blocks", where=str(path), remedy="export it again")
    units = tuple(values[name]["unit"] for name in chain.names)
    drives = tuple(units_["drive"] for units_ in axes.values())
    sizes = np.array([[factor(unit)] for unit in drives])
    return Identified(
        content["name"],
        chain,
        np.array([values[name]["value"] * factor(unit) for name, unit in zip(chain.names, units, strict=True)]),
        units,
        tuple(values[name]["standard_error"] for name in chain.names),
        content["sample_time"]["value"],
        np.array([content["range"][axis] for axis in axes]) * sizes,
        drives,
        tuple(units_["response"] for units_ in axes.values()),
        content["origin"],
        {key: content[key] for key in ("model", "effects", "shared", "given")},
    )


def choice(item: Mapping[str, Any]) -> Choice:
    return Choice(item["name"], {key: value for key, value in item.items() if key != "name"})


def sample_time(rate: str | float) -> float:
    """s, of a rate such as `10kHz`. Raises InputError for what is no rate."""
    hertz = rate_or_stamps(rate, "rate")[0]
    if hertz is None:
        raise InputError(f"{rate!r} is no sample rate", where="rate", remedy="give text such as '10kHz'")
    return 1 / hertz


def blank_record(identified: Identified) -> Record:
    """A record with the axes and units of a model, and nothing measured."""
    drive = np.zeros((len(identified.drive_units), 1))
    return Record(
        identified.name,
        "validate",
        identified.dt,
        drive,
        np.full(drive.shape, np.nan),
        axes=identified.chain.axes,
        drive_units=identified.drive_units,
        response_units=identified.response_units,
    )
