"""A model fitted to records, and what can be done with it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from pzt_ident.api.arguments import path_of, writable
from pzt_ident.api.drawing import loop_figure, time_figure
from pzt_ident.api.fitted import Fitted
from pzt_ident.api.model import Model
from pzt_ident.api.printed import html, table_text
from pzt_ident.api.record import Record
from pzt_ident.api.refit import with_effect
from pzt_ident.api.statement import file_of, has_stamps, statement_of
from pzt_ident.api.wording import as_arguments
from pzt_ident.data.notation import listed, number, quantity, unit, with_error
from pzt_ident.data.over_axes import over_uses, together
from pzt_ident.files import write_json, write_sealed
from pzt_ident.job.schema import Job
from pzt_ident.run.collect import collect
from pzt_ident.run.folder import begin, environment
from pzt_ident.run.identify import tasks_of
from pzt_ident.run.start import starts_of
from pzt_ident.run.statement import Statement

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]
Records = Mapping[str, Sequence[Record]]


class Fit(Fitted):
    """The best of the runs of an identification, with its model, its records and what the data determine."""

    def add(self, effect: str) -> Fit:
        """A fit of the model with an effect more, from the parameters of this one.

        Raises InputError where the effect is unknown, there already, or does not fit the model.
        """
        return Fit(*with_effect(self, effect))

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
        starts = starts_of([run for run, _ in self.runs])
        starts.keep(folder)
        tasks = tasks_of(statement, folder, starts)
        for task, (run, checkpoint) in zip(tasks, self.runs, strict=True):
            checkpoint.save(task.losses)
            write_sealed(task.result, run)
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
        return time_figure(self, record, axis, width)

    def plot_loops(self, axis: str | None = None, width: float = 180) -> Figure:
        """Measured and modelled response against the drive, a panel a record."""
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
        errors = f"RMSE{together(self.noise['units'])}: " + over_uses(rmse)
        return f"{self.model}\n{errors}{ratio}\nnoise floor: {listed(floors)}"

    def _table(self) -> tuple[list[str], list[list[str]]]:
        rows = [
            [item.name, with_error(item.value, item.stderr), unit(item.unit), item.verdict]
            for item in self.parameters.values()
        ]
        return ["parameter", "value", "unit", "verdict"], rows


def _again(text: str, model: Model, records: Records, *more: Any) -> Fit:
    """A fit from another process."""
    return Fit(statement_of(text, records), model, records, *more)
