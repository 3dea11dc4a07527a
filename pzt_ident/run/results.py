"""A folder of results, read once: what every table, figure and page of the report is made from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.signals import Trace, read_traces
from pzt_ident.errors import DamagedError, InputError
from pzt_ident.files import check_digest, read_sealed

History = dict[str, NDArray[Any]]

KEYS = {
    "result.json": ("records", "runs", "league", "unit", "noise_floor"),
    "residuals.json": ("axes",),
    "diagnosis.json": ("verdict", "reason", "rmse", "candidates", "unit", "noise_floor"),
    "improvement.json": ("verdict", "reason", "steps", "unit", "noise_floor"),
}
"""What each file must have."""


@dataclass(frozen=True, eq=False)
class Results:
    """What a run, a diagnosis or an improvement wrote, empty where it did not: `result`, `diagnosis` and `improvement`
    are the JSON files of these names, `misfit` is residuals.json. `history` has columns with a row a generation, `job`
    is the job's text, `before` are the traces of the model as given where that was improved. `damaged` says of each
    file that could not be read why."""

    folder: Path
    result: dict[str, Any]
    history: History
    traces: tuple[Trace, ...]
    environment: dict[str, Any]
    job: str
    misfit: dict[str, Any] = field(default_factory=dict)
    diagnosis: dict[str, Any] = field(default_factory=dict)
    improvement: dict[str, Any] = field(default_factory=dict)
    before: tuple[Trace, ...] = ()
    damaged: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        return self.result.get("name") or self.environment.get("job_name") or self.folder.name

    @property
    def command(self) -> str:
        return self.result.get("command") or self.environment.get("command", "")

    @property
    def facts(self) -> dict[str, Any]:
        """What a run and a diagnosis both have."""
        return self.result or self.diagnosis

    @property
    def unit(self) -> str:
        """That of numbers over all axes together."""
        return self.facts["unit"]

    @property
    def units(self) -> dict[str, str]:
        """That of each axis, of older results as their signals have it."""
        return self.facts.get("units") or {trace.axis: trace.unit for trace in self.traces}

    @property
    def floors(self) -> dict[str, float | None]:
        """The noise floor of each axis, in the axis' own unit."""
        return self.facts["noise_floor"]

    @property
    def floor(self) -> float | None:
        """The noise floor of all axes together; of older results that of an axis alone."""
        alone = [*self.floors.values()] if len(self.floors) == 1 else [None]
        return self.facts.get("floor", *alone)

    @property
    def noise_sources(self) -> dict[str, str]:
        """What the noise floor of each axis was taken from."""
        return self.facts.get("noise_floor_source", {})

    @property
    def records(self) -> list[dict[str, Any]]:
        """Of each record the RMSE that the last model leaves of each axis, in the axis' own unit."""
        last = self.improvement["steps"][-1] if self.improvement else {}
        return last.get("records") or self.facts.get("records", [])

    @property
    def next_experiment(self) -> dict[str, Any] | None:
        """The drive that would tell apart what these data cannot."""
        return (self.improvement or self.diagnosis).get("next_experiment")

    @property
    def share_of_noise(self) -> float:
        """The largest noise floor over the span of its response; 1 where a floor is not known."""
        spans = {trace.axis: 0.0 for trace in self.traces}
        for trace in self.traces:
            spans[trace.axis] = max(spans[trace.axis], float(np.ptp(trace.response)))
        shares = [1.0 if floor is None else floor / (spans.get(axis) or 1.0) for axis, floor in self.floors.items()]
        return max(shares, default=1.0)

    @property
    def rmse(self) -> dict[str, float | None]:
        """Of the last model, on the records of each use."""
        if self.improvement:
            return self.improvement["steps"][-1]["rmse"]
        return (self.best if self.result else self.diagnosis)["rmse"]

    @property
    def best(self) -> dict[str, Any]:
        return self.result["best"]

    @property
    def parameters(self) -> dict[str, Any]:
        """Of the last model; none where only a diagnosis was written."""
        if self.improvement:
            return self.improvement["steps"][-1]["parameters"]
        return self.best["parameters"] if self.result else {}

    @property
    def models(self) -> dict[str, tuple[Trace, ...]]:
        """The traces of each model to be seen, the last one first."""
        return {"improved": self.traces, "as given": self.before} if self.before else {"model": self.traces}

    @property
    def axes(self) -> tuple[str, ...]:
        return tuple(dict.fromkeys(trace.axis for trace in self.traces))


@dataclass(frozen=True)
class Files:
    """The files of a folder of results. `damages` says of each that could not be read why, as far as it was read."""

    folder: Path
    damages: list[str] = field(default_factory=list)

    def path(self, name: str) -> Path:
        """Raises InputError where there is no such file."""
        path = self.folder / name
        if not path.is_file():
            raise InputError("file is missing", where=str(path), remedy="give the folder of a finished run")
        return path

    def content(self, name: str) -> dict[str, Any]:
        """The content of a JSON file; nothing where it is not there, or damaged."""
        try:
            return read_sealed(self.folder / name, *KEYS.get(name, ())) if (self.folder / name).exists() else {}
        except DamagedError as error:
            self.damages.append(str(error).replace("\n ", ";"))
            return {}

    def result(self, needed: bool) -> dict[str, Any]:
        """That of a run. Raises InputError where no run finished and, if it is `needed`, where it cannot be read."""
        name = "result.json"
        result = read_sealed(self.path(name), *KEYS[name]) if needed else self.content(name)
        if result and not result.get("best"):
            raise InputError("no run finished", where=str(self.folder / name), remedy="see `failed_runs` in it")
        return result

    def history(self, digests: Mapping[str, str]) -> History:
        """The losses generation by generation; none where the file is damaged."""
        path = self.path("history.csv")
        try:
            _check(path, digests)
            return read_history(path)
        except ValueError as error:
            self.damages.append(
                str(error).replace("\n ", ";") if isinstance(error, DamagedError) else f"{path} is damaged"
            )
            return {}

    def job(self) -> str:
        path = self.path("job.yaml")
        try:
            return path.read_text(encoding="utf-8")
        except UnicodeDecodeError:
            self.damages.append(f"{path} is damaged: it is no text")
            return ""

    def signals(self, digests: Mapping[str, str]) -> Path:
        """Raises InputError where there are none, DamagedError where they are not as they were written."""
        path = self.path("signals.nc")
        _check(path, digests)
        return path


def read_history(path: Path) -> History:
    """The columns of a file that `history_text` made. Raises ValueError where it is not as that makes it."""
    headings, *rows = (line.split(",") for line in path.read_text(encoding="utf-8").splitlines() or ("",))
    columns = dict(zip(headings, np.array(rows).reshape(-1, len(headings)).T, strict=True))
    return {name: values if name == "optimizer" else values.astype(float) for name, values in columns.items()}


def _check(path: Path, digests: Mapping[str, str]) -> None:
    if digests:
        check_digest(path, digests.get(path.name))


def read_results(folder: Path) -> Results:
    """Read a finished run's folder. Raises InputError where it holds none, or a file is missing or cannot be read."""
    results = read_folder(folder)
    Files(results.folder).path("result.json")
    return results


def read_folder(folder: Path) -> Results:
    """Read the folder of a finished run, diagnosis or improvement. What is damaged of it is left out, and named in
    `damaged`; without its signals, or what they are the model of, there is nothing to read.

    Raises InputError where a file is missing, cannot be read, or holds no finished run.
    """
    files = Files(Path(folder))
    diagnosis = files.content("diagnosis.json")
    result = files.result(needed=not diagnosis)
    environment = files.content(files.path("environment.json").name)
    digests = result.get("files", {})
    history = files.history(digests) if result else {}
    job, signals, before = files.job(), files.signals(digests), files.folder / "signals_as_given.nc"
    records = [record["name"] for record in result["records"]] if result else list(environment.get("data", ()))
    return Results(
        files.folder,
        result,
        history,
        read_traces(signals, records),
        environment,
        job,
        files.content("residuals.json"),
        diagnosis,
        files.content("improvement.json"),
        read_traces(before, records) if before.exists() else (),
        tuple(files.damages),
    )
