"""The identified model in a folder of results, or in an exported JSON: what control and export start from."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pzt_ident.control.export.tables import FORMAT
from pzt_ident.control.identified import Identified
from pzt_ident.control.notes import frequency
from pzt_ident.data.over_axes import over_uses
from pzt_ident.data.units import factor
from pzt_ident.errors import InputError
from pzt_ident.files import read_sealed
from pzt_ident.job.chain import ChainParts
from pzt_ident.job.schema import Job
from pzt_ident.job.sections import Choice
from pzt_ident.run.folder import check_unchanged, read_environment, read_job
from pzt_ident.run.statement import Statement

Array = NDArray[np.float64]
Errors = Mapping[str, float | None]
A_RESULT = "give the folder of a finished run or improvement, or the JSON of an export"


def read_identified(path: Path, plugins: bool = False, as_given: bool = False) -> Identified:
    """The last model of a folder that `run`, `improve` or a saved fit wrote, or of an exported JSON; of an improvement
    the first one if `as_given`.

    Raises InputError where there is none, or its data have changed.
    """
    if path.is_file():
        return of_json(path)
    improved = (path / "improved.yaml").is_file()
    if not improved and not (path / "result.json").is_file():
        raise InputError("holds no result", where=str(path), remedy=A_RESULT)
    values, rmse, name = _improved(path, as_given) if improved else _best(path)
    environment = read_environment(path)
    beside = improved or (path / "data").is_dir()  # the data are named from where the job lies
    home = path if beside else Path(environment["job_folder"])
    job = Job.from_text(read_job(path, name), home, str(path / name), plugins)
    statement = Statement(job)
    if not improved:
        check_unchanged(job, statement.records, environment, path)
    errors = {name: item.get("standard_error") for name, item in values.items()}
    return of_statement(statement, _theta(statement, values, path), errors, rmse)


Values = Mapping[str, Mapping[str, Any]]


def _best(folder: Path) -> tuple[Values, Errors, str]:
    best = read_sealed(folder / "result.json", "best")["best"]
    return best["parameters"] | best["fixed"], best["rmse"], "job.yaml"


def _improved(folder: Path, as_given: bool) -> tuple[Values, Errors, str]:
    steps = read_sealed(folder / "improvement.json", "steps")["steps"]
    step, name = (steps[0], "job.yaml") if as_given else (steps[-1], "improved.yaml")
    return step["parameters"], step["rmse"], name


def _theta(statement: Statement, values: Values, folder: Path) -> Array:
    problem = statement.problem
    theta = problem.theta.copy()
    for column, (name, unit) in enumerate(zip(problem.model.names, problem.all_units, strict=True)):
        if name in values:
            theta[column] = values[name]["value"] * factor(unit)
    if unknown := [name for name, value in zip(problem.model.names, theta, strict=True) if np.isnan(value)]:
        raise InputError(f"holds no value of {unknown[0]}", where=str(folder), remedy="run it again")
    return theta


def of_statement(statement: Statement, theta: Array, errors: Errors, rmse: Errors) -> Identified:
    """theta: SI units. errors: standard errors by name, in the user's units. rmse: by use."""
    problem, records = statement.problem, [r for r in statement.records if r.use == "identify"]
    stated, axes = statement.job.limits, range(len(problem.model.axes))
    ends = np.array([[record.drive.min(axis=1), record.drive.max(axis=1)] for record in records])
    known = {use: f"{error:.3g} {statement.unit}" for use, error in rmse.items() if error is not None}
    return Identified(
        statement.job.name,
        problem.model,
        theta,
        tuple(problem.all_units),
        tuple(errors.get(name) for name in problem.model.names),
        min(record.dt for record in records),
        np.array([ends[:, 0].min(axis=0), ends[:, 1].max(axis=0)]).T,
        tuple(records[0].drive_units),
        tuple(records[0].response_units),
        tuple(max(frequency(record.drive[axis], record.dt) for record in records) for axis in axes),
        (stated.drive, stated.slew),
        f"RMSE: {over_uses(known)}.",
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
    axes, values, stated = content["axes"], content["parameters"], content["limits"]
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
        tuple(content["frequency"][axis] for axis in axes),
        (None if stated["drive"] is None else tuple(stated["drive"]), stated["slew"]),
        content["origin"],
        {key: content[key] for key in ("model", "effects", "shared", "given")},
    )


def choice(item: Mapping[str, Any]) -> Choice:
    return Choice(item["name"], {key: value for key, value in item.items() if key != "name"})
