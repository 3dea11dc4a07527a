"""The model that a folder of results holds, with its identified parameters: what control and export start from."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pzt_ident.control.stage import Stage
from pzt_ident.data.record import Record
from pzt_ident.data.units import factor
from pzt_ident.errors import InputError
from pzt_ident.job.schema import Job
from pzt_ident.run.folder import check_unchanged, read_environment
from pzt_ident.run.statement import Statement

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Identified:
    """theta: all parameters of the model, SI units. errors: standard errors in the user's units, where they are known,
    by the names of the parameters."""

    statement: Statement
    theta: Array
    errors: Mapping[str, float | None]

    @property
    def records(self) -> list[Record]:
        return [record for record in self.statement.records if record.use == "identify"]

    @property
    def axes(self) -> tuple[str, ...]:
        """The measured axes, those that can follow a reference."""
        model = self.statement.problem.model
        return tuple(model.axes[axis] for axis in model.measured)

    @property
    def inputs(self) -> dict[str, str]:
        """What control takes of each axis, by its unit: the displacement, or the drive where none is measured."""
        like = self.records[0]
        return {
            axis: response or drive
            for axis, response, drive in zip(like.axes, like.response_units, like.drive_units, strict=True)
        }

    @property
    def peaks(self) -> Array:
        """The largest magnitude of the drive of each axis in the identification records, SI units."""
        return np.max([np.abs(record.drive).max(axis=1) for record in self.records], axis=0)

    @property
    def spans(self) -> Array:
        """The largest peak-to-peak drive of each axis."""
        return np.max([np.ptp(record.drive, axis=1) for record in self.records], axis=0)

    def stage(self, dt: float, spans: Array | None = None, peaks: Array | None = None) -> Stage:
        """The stage at a sample time, s; spans and peaks of its drive as in the identification unless given."""
        spans, peaks = self.spans if spans is None else spans, self.peaks if peaks is None else peaks
        return Stage(self.statement.problem.model, self.theta, dt, spans.tolist(), peaks.tolist())


def read_identified(folder: Path, plugins: bool = False, as_given: bool = False) -> Identified:
    """The last model of a folder that `run`, `improve` or a saved fit wrote; of an improvement the first one if
    `as_given`.

    Raises InputError where it holds none, or its data have changed.
    """
    begun = read_environment(folder)
    improved = (folder / "improvement.json").exists()
    best, name = _improved(folder, as_given) if improved else _best(folder)
    home = folder if (folder / "data").is_dir() else Path(begun["job_folder"])
    job = Job.from_text((folder / name).read_text(encoding="utf-8"), home, str(folder / name), plugins)
    statement = Statement(job)
    if not improved:
        check_unchanged(job, statement.records, begun, folder)
    return Identified(statement, _theta(statement, best), _errors(best))


def _best(folder: Path) -> tuple[dict[str, Any], str]:
    try:
        best = json.loads((folder / "result.json").read_text(encoding="utf-8"))["best"]
    except FileNotFoundError:
        remedy = "give the folder of a finished `pzt-ident run` or `pzt-ident improve`"
        raise InputError("holds no result", where=str(folder), remedy=remedy) from None
    return best["parameters"] | best["fixed"], "job.yaml"


def _improved(folder: Path, as_given: bool) -> tuple[dict[str, Any], str]:
    steps = json.loads((folder / "improvement.json").read_text(encoding="utf-8"))["steps"]
    return (steps[0]["parameters"], "job.yaml") if as_given else (steps[-1]["parameters"], "improved.yaml")


def _theta(statement: Statement, values: Mapping[str, Any]) -> Array:
    problem = statement.problem
    theta = problem.theta.copy()
    for column, (name, unit) in enumerate(zip(problem.model.names, problem.all_units, strict=True)):
        if name in values:
            theta[column] = values[name]["value"] * factor(unit)
    return theta


def _errors(values: Mapping[str, Any]) -> dict[str, float | None]:
    return {name: item.get("standard_error") for name, item in values.items()}
