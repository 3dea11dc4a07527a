"""A model fitted to records, and what can be done with it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pzt_ident.api.arguments import Signals, path_of, writable
from pzt_ident.api.model import Model
from pzt_ident.api.printed import html, table_text
from pzt_ident.api.record import Record
from pzt_ident.api.statement import drive_record, file_of, has_stamps, statement_of
from pzt_ident.api.wording import as_arguments
from pzt_ident.data.noise import units_and_floors
from pzt_ident.data.notation import listed, number, quantity, unit, with_error
from pzt_ident.data.over_axes import together
from pzt_ident.data.units import factor
from pzt_ident.engine.simulator import simulate
from pzt_ident.errors import InputError, nearest
from pzt_ident.files import write_json
from pzt_ident.job.schema import Job
from pzt_ident.run.checkpoint import Checkpoint
from pzt_ident.run.collect import collect
from pzt_ident.run.folder import begin, environment
from pzt_ident.run.identify import tasks_of
from pzt_ident.run.statement import Statement
from pzt_ident.search.uncertainty import covariance

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

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


class Fit:
    """The best of the runs of an identification, with its model, its records and what the data determine.

    sections: what the job says beside model and records. runs: as in `result.json`, one an optimizer and repeat, each
    with its checkpoint.
    """

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
        self.best = min((run for run, _ in self.runs), key=lambda run: run["rmse"]["identify"])
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
            record.name: _columns(error, list(record.units.values()))
            for record, error in self.statement.problem.errors(self.point)
        }

    def simulate(self, t: ArrayLike | str | Record, u: Signals | None = None) -> Array:
        """The model's response to a drive, in the units of the responses: (samples,), of several axes (samples, axes).
        t and u are those of a `Record`, or t is one. The offset is the record's own, so that the response has none.

        Raises InputError where an axis is missing, in another kind of unit, or a shape does not fit.
        """
        record = drive_record(t, u, self.statement.records[0])
        theta = self.statement.problem.parameters(self.point)
        return _columns(simulate(self.statement.problem.model, record, theta)[0], [*record.units.values()])

    def add(self, effect: str) -> Fit:
        """A fit of the model with an effect more, from the parameters of this one.

        Raises InputError where the effect is unknown, there already, or does not fit the model.
        """
        from pzt_ident.api.refit import with_effect

        return with_effect(self, effect)

    def save(self, folder: str | Path) -> Path:
        """Write what `pzt-ident run` writes, and the data, into an empty folder; `pzt_ident.load` reads it again, and
        every command works on it. Raises InputError where something is in it."""
        folder = path_of(folder, "save")
        with as_arguments(), writable(folder):
            self._write(folder)
        return folder

    def _write(self, folder: Path) -> None:
        text = self.statement.job.text
        job = Job.from_text(text, folder, "job.yaml")
        begin(folder, job, text, self.statement.records)
        stamps = has_stamps(self.records)
        for record in (record for each in self.records.values() for record in each):
            record.write_csv(folder / file_of(record), stamps)
        statement = Statement(job)
        write_json(folder / "environment.json", environment(job, statement.records))
        tasks = tasks_of(statement, folder)
        for task, (run, checkpoint) in zip(tasks, self.runs, strict=True):
            checkpoint.save(task.losses)
            write_json(task.result, run)
        collect(statement, folder, tasks, {})

    def report(self, path: str | Path) -> Path:
        """Write the report as one HTML file that needs nothing else."""
        from pzt_ident.files import write_text
        from pzt_ident.report.page import write_report

        path = path_of(path, "report")
        with TemporaryDirectory() as scratch:
            page = write_report(self.save(Path(scratch) / "fit"))
            with writable(path):
                write_text(path, page.read_text(encoding="utf-8"))
        return path

    def plot(self, record: str | None = None, axis: str | None = None, width: float = 180) -> Figure:
        """Measured and modelled response of a record over time, and the residual; of the first record and axis unless
        they are named. width: mm. Raises InputError for an unknown name."""
        from pzt_ident.api.drawing import time_figure

        return time_figure(self, record, axis, width)

    def plot_loops(self, axis: str | None = None, width: float = 180) -> Figure:
        """Measured and modelled response against the drive, a panel a record."""
        from pzt_ident.api.drawing import loop_figure

        return loop_figure(self, axis, width)

    def __reduce__(self) -> tuple[Any, ...]:
        return _again, (self.statement.job.text, self.model, self.records, self.sections, self.runs)

    def __str__(self) -> str:
        return f"{self._headline()}\n\n{table_text(*self._table())}"

    __repr__ = __str__

    def _repr_html_(self) -> str:
        return html(self._headline(), *self._table())

    def _headline(self) -> str:
        rmse = {use: quantity(error, self.unit) for use, error in self.rmse.items() if error is not None}
        floors = [f"{quantity(floor, self.noise['units'][axis])} ({axis})" for axis, floor in self.noise_floor.items()]
        over = self.noise["floor"]
        ratio = f", {number(self.rmse['identify'] / over, 3)} noise floors" if over and self.rmse["identify"] else ""
        errors = f"RMSE{together(self.noise['units'])}: " + ", ".join(f"{error} {use}" for use, error in rmse.items())
        return f"{self.model}\n{errors}{ratio}\nnoise floor: {listed(floors)}"

    def _table(self) -> tuple[list[str], list[list[str]]]:
        rows = [
            [item.name, with_error(item.value, item.stderr), unit(item.unit), item.verdict]
            for item in self.parameters.values()
        ]
        return ["parameter", "value", "unit", "verdict"], rows


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


def _again(text: str, model: Model, records: Records, *more: Any) -> Fit:
    """A fit from another process."""
    return Fit(statement_of(text, records), model, records, *more)


def _columns(signals: Array, units: Sequence[str]) -> Array:
    """(axes, samples) in SI units as (samples, axes) in the user's, (samples,) of one axis."""
    columns = np.array([row / factor(unit) for row, unit in zip(signals, units, strict=True)]).T
    return columns[:, 0] if len(units) == 1 else columns
