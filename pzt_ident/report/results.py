"""A run folder, read once: what every table, figure and page of the report is made from."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from pzt_ident.errors import InputError

if TYPE_CHECKING:
    import h5py
    import pandas as pd

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Trace:
    """One measured axis of one record beside the best model, arrays of shape (samples,) in the user's units;
    the residual is model less response.

    The first `settle` seconds are simulated but not scored.
    """

    record: str
    use: str
    axis: str
    time: Floats
    drive: Floats
    response: Floats
    model: Floats
    residual: Floats
    drive_unit: str
    unit: str
    settle: float = 0.0

    @property
    def scored(self) -> NDArray[np.bool_]:
        return self.time > self.time[0] + self.settle - 0.5 * float(np.diff(self.time[:2]).sum())


@dataclass(frozen=True, eq=False)
class Results:
    """What a run wrote: `result` is result.json, `history` has one row a generation, `job` is the job's text, `misfit`
    is residuals.json, empty where the run was not compared."""

    folder: Path
    result: dict[str, Any]
    history: pd.DataFrame
    traces: tuple[Trace, ...]
    environment: dict[str, Any]
    job: str
    misfit: dict[str, Any] = field(default_factory=dict)

    @property
    def unit(self) -> str:
        return self.result["unit"]

    @property
    def best(self) -> dict[str, Any]:
        return self.result["best"]

    @property
    def axes(self) -> tuple[str, ...]:
        return tuple(dict.fromkeys(trace.axis for trace in self.traces))


def read_results(folder: Path) -> Results:
    """Read a finished run's folder.

    Raises InputError where a file is missing, cannot be read, or holds no finished run.
    """
    import pandas as pd

    folder = Path(folder)
    result = _json(folder / "result.json")
    if not result.get("best"):
        raise InputError("no run finished", where=str(folder / "result.json"), remedy="see `failed_runs` in it")
    return Results(
        folder,
        result,
        pd.read_csv(_there(folder / "history.csv")),
        _traces(_there(folder / "signals.nc"), [record["name"] for record in result["records"]]),
        _json(folder / "environment.json"),
        _there(folder / "job.yaml").read_text(encoding="utf-8"),
        _json(folder / "residuals.json") if (folder / "residuals.json").exists() else {},
    )


def _there(path: Path) -> Path:
    if not path.is_file():
        raise InputError("file is missing", where=str(path), remedy="give the folder of a finished run")
    return path


def _json(path: Path) -> dict[str, Any]:
    text = _there(path).read_text(encoding="utf-8")
    try:
        return json.loads(text)
    except ValueError as error:
        raise InputError(f"not JSON: {error}", where=str(path), remedy="run the job again") from error


def _traces(path: Path, order: list[str]) -> tuple[Trace, ...]:
    import h5py

    try:
        with h5py.File(path) as file:
            groups: list[h5py.Group] = []
            file.visititems(lambda _, item: groups.append(item) if "use" in item.attrs else None)
            found = [trace for group in groups for trace in _group(group)]
    except OSError as error:
        raise InputError(f"not netCDF4: {error}", where=str(path), remedy="run the job again") from error
    places = {name: place for place, name in reversed(list(enumerate(order)))}
    return tuple(sorted(found, key=lambda trace: (places.get(trace.record, len(order)), trace.axis)))


def _group(group: h5py.Group) -> list[Trace]:
    axes = [name.removeprefix("response_") for name in group if name.startswith("response_")]
    return [
        Trace(
            record=str(group.attrs["name"]),
            use=str(group.attrs["use"]),
            axis=axis,
            time=group["time"][:],
            **{kind: group[f"{kind}_{axis}"][:] for kind in ("drive", "response", "model", "residual")},
            drive_unit=str(group[f"drive_{axis}"].attrs["units"]),
            unit=str(group[f"response_{axis}"].attrs["units"]),
            settle=float(np.ravel(group.attrs["settle"])[0]),
        )
        for axis in axes
    ]
