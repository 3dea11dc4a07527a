"""Model beside measurement: where the model of a folder of results fails."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.noise import Floor
from pzt_ident.data.record import Record
from pzt_ident.data.units import factor
from pzt_ident.diagnosis.locate import locate
from pzt_ident.files import write_json
from pzt_ident.job.schema import load_job
from pzt_ident.run.identify import Listen, run
from pzt_ident.run.results import Results, read_folder

if TYPE_CHECKING:
    import h5py

Array = NDArray[np.float64]


def finished(source: Path, out: Path | None, listen: Listen, plugins: bool = False) -> Path:
    """The folder of results that `source` is, or else of the job that it is, which is run first, into `out`."""
    return source if source.is_dir() else run(load_job(source, plugins), out, report=False, listen=listen)


def compare(folder: Path, out: Path) -> dict[str, Any]:
    """Where the best run of a finished run's folder misfits, or the model of a diagnosis, the last one of an
    improvement; written to `residuals.json` in the folder `out`.

    Raises InputError where the folder holds none.
    """
    results = read_folder(folder)
    found = misfits(results)
    write_json(out / "residuals.json", found)
    return found


def draw(folder: Path, out: Path, found: dict[str, Any]) -> Iterator[object]:
    """Draw what `compare` found into `figures/` of the folder `out`, and the folder's report again where it has one.
    Yields what is done."""
    from pzt_ident.report.figures import write_misfit_figures

    yield from write_misfit_figures(replace(read_folder(folder), misfit=found), out / "figures")
    if out == folder and (folder / "report.html").exists():
        from pzt_ident.report.page import write_report

        yield write_report(folder)


def misfits(results: Results) -> dict[str, Any]:
    """The content of `residuals.json`: by axis, what `locate` finds."""
    names = list(dict.fromkeys(trace.record for trace in results.traces))
    records, residuals = read_signals(results.folder / "signals.nc", names)
    return {
        "job": results.name,
        "run": results.best["run"] if results.result else None,
        "unit": results.unit,
        "axes": {found.axis: asdict(found) for found in locate(records, residuals, floors(results, records[0]))},
    }


def floors(results: Results, record: Record) -> list[Floor]:
    """The noise floor of each measured axis, 0 where none is known."""
    values, sources = results.floors, results.noise_sources
    return [
        Floor(
            (values.get(record.axes[a]) or 0.0) * factor(str(record.response_units[a])),
            sources.get(record.axes[a], "not known"),
        )
        for a in record.measured
    ]


def read_signals(path: Path, order: list[str]) -> tuple[list[Record], list[Array]]:
    """The records of `signals.nc`, in order, and the residuals of each, (measured axes, samples), in SI units."""
    import h5py

    groups: list[h5py.Group] = []
    with h5py.File(path) as file:
        file.visititems(lambda _, item: groups.append(item) if "use" in item.attrs else None)
        groups.sort(key=lambda group: order.index(str(group.attrs["name"])))
        pairs = [read_group(group) for group in groups]
    return [record for record, _ in pairs], [residual for _, residual in pairs]


def read_group(group: h5py.Group) -> tuple[Record, Array]:
    axes = tuple(name.removeprefix("drive_") for name in group if name.startswith("drive_"))
    time = group["time"][:]
    dt = float((time[-1] - time[0]) / (time.size - 1))
    unmeasured = np.full(time.size, np.nan)
    record = Record(
        name=str(group.attrs["name"]),
        use=str(group.attrs["use"]),  # type: ignore[arg-type]
        dt=dt,
        drive=np.array([channel(group, f"drive_{axis}") for axis in axes]),
        response=np.array([channel(group, f"response_{a}") if f"response_{a}" in group else unmeasured for a in axes]),
        start=float(time[0]),
        settle=round(float(np.ravel(group.attrs["settle"])[0]) / dt),
        axes=axes,
        drive_units=tuple(unit_of(group, f"drive_{axis}") or "" for axis in axes),
        response_units=tuple(unit_of(group, f"response_{axis}") for axis in axes),
    )
    return record, np.array([channel(group, f"residual_{axes[a]}") for a in record.measured])


def channel(group: h5py.Group, name: str) -> Array:
    return group[name][:] * factor(unit_of(group, name) or "1")


def unit_of(group: h5py.Group, name: str) -> str | None:
    return str(group[name].attrs["units"]) if name in group else None
