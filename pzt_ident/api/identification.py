"""Identify a model from records, and read a fit again."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from pzt_ident.api.arguments import of_kind, path_of
from pzt_ident.api.fit import Fit
from pzt_ident.api.model import Model
from pzt_ident.api.record import Record
from pzt_ident.api.simulation import load_simulation
from pzt_ident.api.statement import job_text, named_apart, sections_of, statement_of
from pzt_ident.errors import InputError
from pzt_ident.files import read_sealed
from pzt_ident.job.schema import Job
from pzt_ident.run.checkpoint import Checkpoint
from pzt_ident.run.computing import computing
from pzt_ident.run.events import nobody
from pzt_ident.run.folder import check_unchanged, read_environment
from pzt_ident.run.identify import tasks_of
from pzt_ident.run.results import read_results
from pzt_ident.run.start import Starts
from pzt_ident.run.statement import Statement
from pzt_ident.run.task import identification

Bounds = Mapping[str, tuple[float, float]]


def identify(
    model: Model | str,
    train: Record | Sequence[Record],
    *,
    validate: Record | Sequence[Record] | None = None,
    bounds: Bounds | None = None,
    fixed: Mapping[str, float] | None = None,
    optimizer: str | Mapping[str, Any] = "pso",
    seed: int = 0,
    evaluations: int | None = None,
    repeats: int = 1,
    polish: bool = True,
    name: str = "fit",
) -> Fit:
    """Find the parameters of a model that leave the least RMSE of the records `train`.

    validate: records that the fit never sees, to judge it on. bounds, fixed: (low, high) or value of parameters by
    name, such as `bouc_wen.alpha`, with the axis in front where there are several, in the units of the data.
    optimizer: its word, or `{"name": "pso", "population": 40}`. evaluations: its budget, by default its own. repeats:
    searches, of which the best is taken; the fit is a function of the seed. polish: least squares at the end.

    Raises InputError with the sentences of the command line, RunError where every simulation failed.
    """
    chain = Model(model) if isinstance(model, str) else model
    of_kind(chain, Model, "model", "give pzt_ident.Model('bouc_wen', 'lumped')")
    records = named_apart({"identify": _listed(train, "train"), "validate": _listed(validate, "validate")})
    sections = {
        "parameters": _parameters(bounds or {}, fixed or {}),
        "optimizers": [_optimizer(optimizer)],
        "repeats": repeats,
        "seed": seed,
        "polish": polish,
        "stop": {"evaluations": evaluations} if evaluations is not None else {},
    }
    statement = statement_of(job_text(name, chain, records, sections), records)
    runs = []
    with computing():
        for task in tasks_of(statement, Path()):
            checkpoint = Checkpoint()
            runs.append((identification(task, statement, checkpoint, nobody), checkpoint))
    return Fit(statement, chain, records, sections, runs)


def load(folder: str | Path, *, plugins: bool = False) -> Any:
    """Read the fit of a folder that `Fit.save` or `pzt-ident run` wrote; or, as a `Simulation`, the last model of an
    improvement or a file that was exported to JSON. plugins: load the files of code that its job names.

    Raises InputError where the folder holds no finished run, or its data have changed.
    """
    folder = path_of(folder, "load")
    try:
        if (folder.suffix == ".json" and folder.is_file()) or (folder / "improvement.json").is_file():
            return load_simulation(folder, plugins)
        return _read(folder, plugins)
    except (OSError, UnicodeDecodeError) as error:
        remedy = "give the folder of a finished run"
        raise InputError(f"cannot be read: {error}", where=str(folder), remedy=remedy) from None


def _read(folder: Path, plugins: bool) -> Fit:
    results, environment = read_results(folder), read_environment(folder)
    for sentence in results.damaged:
        raise InputError(sentence.partition(";")[0], remedy=f"`pzt-ident resume {folder}` makes it again where it can")
    home = folder if (folder / "data").is_dir() else Path(environment["job_folder"])
    job = Job.from_text(results.job, home, str(folder / "job.yaml"), plugins)
    statement = Statement(job)
    check_unchanged(job, statement.records, environment, folder)
    records = {
        use: tuple(Record.of(record) for record in statement.records if record.use == use)
        for use in ("identify", "validate")
    }
    tasks = {task.run: task for task in tasks_of(statement, folder, Starts.kept(folder))}
    finished = [read_sealed(tasks[run["run"]].result) for run in results.result["runs"]]
    runs = [(run, Checkpoint(tasks[run["run"]].losses)) for run in finished]
    chain, sections = Model.of(job), sections_of(job)
    return Fit(statement_of(job_text(job.name, chain, records, sections), records), chain, records, sections, runs)


def _listed(records: Record | Sequence[Record] | None, where: str) -> tuple[Record, ...]:
    listed = (records,) if isinstance(records, Record) else records
    remedy = "give pzt_ident.Record(t, u, y), or a list of them"
    if where == "train" and (listed is None or (isinstance(listed, Sequence) and not listed)):
        raise InputError("no record to identify from", where=where, remedy=remedy)
    for record in listed if isinstance(listed, list | tuple) else [] if listed is None else [listed]:
        of_kind(record, Record, where, remedy)
    return tuple(listed or ())


def _optimizer(optimizer: str | Mapping[str, Any]) -> dict[str, Any]:
    choice = {"name": optimizer} if isinstance(optimizer, str) else optimizer
    of_kind(choice, Mapping, "optimizer", "give a word, or {'name': 'pso', 'population': 40}")
    return dict(choice)


def _parameters(bounds: Bounds, fixed: Mapping[str, float]) -> dict[str, Any]:
    """The section `parameters` of a job. Raises InputError where one is both bounded and fixed."""
    of_kind(bounds, Mapping, "bounds", "give {'bouc_wen.alpha': (0, 1)}")
    of_kind(fixed, Mapping, "fixed", "give {'lumped.mass': 0.157}")
    if both := sorted(set(bounds) & set(fixed)):
        raise InputError(f"{both[0]!r} has bounds and a value", where="fixed", remedy="keep one of the two")
    limits: dict[str, Any] = {}
    for name, ends in bounds.items():
        if isinstance(ends, str | Mapping) or np.ndim(ends) != 1 or np.size(ends) != 2:
            raise InputError(f"{ends!r} is no pair", where=f"bounds: {name}", remedy="give (low, high)")
        limits[name] = {"bounds": [_number(end) for end in ends]}
    for name, value in fixed.items():
        if value is None:
            raise InputError("None is no value", where=f"fixed: {name}", remedy="give a number, or leave it out")
        limits[name] = {"value": _number(value)}
    return limits


def _number(value: Any) -> Any:
    return float(value) if isinstance(value, int | float | np.number) and not isinstance(value, bool) else value
