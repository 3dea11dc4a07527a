"""A folder of results, read once: what every table, figure and page of the report is made from."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from pzt_ident.data.signals import Trace, read_traces
from pzt_ident.errors import DamagedError, InputError
from pzt_ident.files import damaged, digest_of, read_sealed

if TYPE_CHECKING:
    import pandas as pd


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
    are the JSON files of these names, `misfit` is residuals.json. `history` has one row a generation, `job` is the
    job's text, `before` are the traces of the model as given where that was improved. `damaged` says of each file that
    could not be read why."""

    folder: Path
    result: dict[str, Any]
    history: pd.DataFrame
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
        found = [1.0 if floor is None else floor / (spans.get(axis) or 1.0) for axis, floor in self.floors.items()]
        return max(found, default=1.0)

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


def read_results(folder: Path) -> Results:
    """Read a finished run's folder. Raises InputError where it holds none, or a file is missing or cannot be read."""
    results = read_folder(folder)
    _there(results.folder / "result.json")
    return results


def read_folder(folder: Path) -> Results:
    """Read the folder of a finished run, diagnosis or improvement. What is damaged of it is left out, and named in
    `damaged`; without its signals, or what they are the model of, there is nothing to read.

    Raises InputError where a file is missing, cannot be read, or holds no finished run.
    """
    import pandas as pd

    folder, lost = Path(folder), list[str]()

    def content(name: str) -> dict[str, Any]:
        """The content of a file that is there; nothing where it is damaged."""
        try:
            return read_sealed(folder / name, *KEYS.get(name, ())) if (folder / name).exists() else {}
        except DamagedError as error:
            lost.append(str(error).replace("\n ", ";"))
            return {}

    diagnosis = content("diagnosis.json")
    result = content("result.json") if diagnosis else read_sealed(_there(folder / "result.json"), *KEYS["result.json"])
    if result and not result.get("best"):
        raise InputError("no run finished", where=str(folder / "result.json"), remedy="see `failed_runs` in it")
    _there(folder / "environment.json")
    environment = content("environment.json")
    order = [record["name"] for record in result["records"]] if result else list(environment.get("data", ()))
    before = folder / "signals_as_given.nc"
    digests = result.get("files", {})
    history = _history(folder, digests, lost) if result else pd.DataFrame()
    try:
        job = _there(folder / "job.yaml").read_text(encoding="utf-8")
    except UnicodeDecodeError:
        job = ""
        lost.append(f"{folder / 'job.yaml'} is damaged: it is no text")
    signals = _there(folder / "signals.nc")
    if digests and digest_of(signals) != digests.get(signals.name):
        raise damaged(signals, "is not as it was written")
    return Results(
        folder,
        result,
        history,
        read_traces(signals, order),
        environment,
        job,
        content("residuals.json"),
        diagnosis,
        content("improvement.json"),
        read_traces(before, order) if before.exists() else (),
        tuple(lost),
    )


def _history(folder: Path, digests: dict[str, str], lost: list[str]) -> pd.DataFrame:
    """The losses generation by generation; none where the file is damaged, which is noted."""
    import pandas as pd

    path = _there(folder / "history.csv")
    try:
        if digests and digest_of(path) != digests.get(path.name):
            raise damaged(path, "is not as it was written")
        return pd.read_csv(path)
    except ValueError as error:
        lost.append(str(error).replace("\n ", ";") if isinstance(error, DamagedError) else f"{path} is damaged")
        return pd.DataFrame()


def _there(path: Path) -> Path:
    if not path.is_file():
        raise InputError("file is missing", where=str(path), remedy="give the folder of a finished run")
    return path
