"""A model fitted to records: its parameters, what they are worth, and its response."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pzt_ident.api.arguments import Signals
from pzt_ident.api.controlled import Controlled
from pzt_ident.api.model import Model
from pzt_ident.api.record import Record
from pzt_ident.api.statement import drive_record
from pzt_ident.control.identified import Identified
from pzt_ident.data.noise import units_and_floors
from pzt_ident.data.units import factor
from pzt_ident.engine.simulator import simulate
from pzt_ident.errors import InputError, nearest
from pzt_ident.run.checkpoint import Checkpoint
from pzt_ident.run.statement import Statement
from pzt_ident.search.uncertainty import covariance, judged

if TYPE_CHECKING:
    import pandas as pd


Array = NDArray[np.float64]
Records = Mapping[str, Sequence[Record]]


@dataclass(frozen=True)
class Parameter:
    """An identified parameter in the user's unit. stderr is None where the data do not determine it, or where it was
    fixed; `verdict` says which, `note` why."""

    name: str
    value: float
    stderr: float | None
    unit: str
    bounds: tuple[float, float] | None
    verdict: str
    note: str = ""


class Parameters(dict[str, Parameter]):
    """By name; an unknown one is refused with the nearest known ones."""

    def __missing__(self, name: Any) -> Parameter:
        raise InputError(f"unknown parameter {name!r}", where="parameters", remedy=nearest(str(name), self))


class Parts(NamedTuple):
    """What a fit is made of. sections: what the job says beside model and records. runs: as in `result.json`, one an
    optimizer and repeat, each with its checkpoint."""

    statement: Statement
    model: Model
    records: Records
    sections: Mapping[str, Any]
    runs: Sequence[tuple[dict[str, Any], Checkpoint]]


class Fitted(Controlled):
    """What a fit knows of itself, from its `Parts`."""

    def __init__(
        self,
        statement: Statement,
        model: Model,
        records: Records,
        sections: Mapping[str, Any],
        runs: Sequence[tuple[dict[str, Any], Checkpoint]],
    ) -> None:
        self.statement, self.model, self.records, self.sections = statement, model, records, dict(sections)
        self.runs = tuple(runs)
        results = [run for run, _ in self.runs]
        self.best = judged(min(results, key=lambda run: run["rmse"]["identify"]), results)
        self.point = np.asarray(self.best["point"], dtype=np.float64)

    @property
    def parameters(self) -> Parameters:
        """Every parameter of the model by name, the identified ones first."""
        entries = self.best["parameters"] | self.best["fixed"]
        return Parameters({name: _parameter(name, item) for name, item in entries.items()})

    @property
    def rmse(self) -> dict[str, float | None]:
        """By use, `identify` and `validate`, in `unit`: of several axes the root mean square of theirs."""
        return {use: None if error != error else error for use, error in self.best["rmse"].items()}

    @property
    def unit(self) -> str:
        return self.statement.unit

    @cached_property
    def noise(self) -> dict[str, Any]:
        """Units and noise floors as in `result.json`: of each axis, their source, and `floor` of all together."""
        return units_and_floors(self.statement.records)

    @property
    def noise_floor(self) -> dict[str, float]:
        """Of each axis, in its own unit."""
        return self.noise["noise_floor"]

    @cached_property
    def covariance(self) -> pd.DataFrame:
        """Of the free parameters, in their units, with correlated residuals."""
        import pandas as pd

        names = self.statement.problem.names
        return pd.DataFrame(covariance(self.statement.problem, self.point), names, names)

    @cached_property
    def residuals(self) -> dict[str, Array]:
        """Model minus measurement of each record, in the units of its axes: (samples,), of several axes
        (samples, axes)."""
        return {
            record.name: columns(error, list(record.units.values()))
            for record, error in self.statement.problem.errors(self.point)
        }

    @property
    def identified(self) -> Identified:
        """What control and export start from."""
        from pzt_ident.run.identified import of_statement

        errors = {name: item.stderr for name, item in self.parameters.items()}
        return of_statement(self.statement, self.statement.problem.parameters(self.point)[0], errors, self.rmse)

    def simulate(self, t: ArrayLike | str | Record, u: Signals | None = None) -> Array:
        """The model's response to a drive, in the units of the responses: (samples,), of several axes (samples, axes).
        t and u are those of a `Record`, or t is one. The offset is the record's own, so that the response has none.

        Raises InputError where an axis is missing, in another kind of unit, or a shape does not fit.
        """
        record = drive_record(t, u, self.statement.records[0])
        theta = self.statement.problem.parameters(self.point)
        return columns(simulate(self.statement.problem.model, record, theta)[0], [*record.units.values()])


def _parameter(name: str, item: Mapping[str, Any]) -> Parameter:
    error = item.get("standard_error")
    return Parameter(
        name,
        float(item["value"]),
        None if error is None or not np.isfinite(error) else float(error),
        item["unit"],
        (float(item["lower"]), float(item["upper"])) if "lower" in item else None,
        item.get("verdict", "fixed"),
        item.get("note", ""),
    )


def columns(signals: Array, units: Sequence[str]) -> Array:
    """(axes, samples) in SI units as (samples, axes) in the user's, (samples,) of one axis."""
    columns = np.array([row / factor(unit) for row, unit in zip(signals, units, strict=True)]).T
    return columns[:, 0] if len(units) == 1 else columns
