"""Where the model of a folder of results fails: `residuals.json`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from pzt_ident.data.noise import Floor
from pzt_ident.data.record import Record
from pzt_ident.data.signals import read_signals
from pzt_ident.data.units import factor
from pzt_ident.diagnosis.locate import locate
from pzt_ident.files import write_sealed
from pzt_ident.run.results import read_folder


def compare(folder: Path, out: Path) -> dict[str, Any]:
    """Where the best run of a finished run's folder misfits, or the model of a diagnosis, the last one of an
    improvement; written to `residuals.json` in the folder `out`.

    Raises InputError where the folder holds none.
    """
    results = read_folder(folder)
    names = list(dict.fromkeys(trace.record for trace in results.traces))
    residuals = misfits(folder, results.name, results.result or results.diagnosis, names)
    return write_sealed(out / "residuals.json", residuals)


def write_misfits(folder: Path, facts: dict[str, Any]) -> None:
    """`residuals.json` of the signals in a folder, from the facts of its `result.json` or `diagnosis.json`."""
    names = [record["name"] for record in facts["records"]]
    write_sealed(folder / "residuals.json", misfits(folder, facts["name"], facts, names))


def misfits(folder: Path, job: str, facts: dict[str, Any], names: Sequence[str]) -> dict[str, Any]:
    """The content of `residuals.json`: by axis, what `locate` finds. names: the records in their order."""
    records, residuals = read_signals(folder / "signals.nc", names)
    return {
        "job": job,
        "run": facts["best"]["run"] if "best" in facts else None,
        "unit": facts["unit"],
        "units": records[0].units,
        "axes": {misfit.axis: asdict(misfit) for misfit in locate(records, residuals, floors(facts, records[0]))},
    }


def floors(facts: dict[str, Any], record: Record) -> list[Floor]:
    """The noise floor of each measured axis, SI units, 0 where none is known."""
    values, sources = facts["noise_floor"], facts.get("noise_floor_source", {})
    return [
        Floor(
            (values.get(record.axes[a]) or 0.0) * factor(str(record.response_units[a])),
            sources.get(record.axes[a], "not known"),
        )
        for a in record.measured
    ]
