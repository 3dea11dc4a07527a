"""Measurement and model as netCDF4."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path

import numpy as np

from pzt_ident.data.units import factor
from pzt_ident.files import replaced
from pzt_ident.search.problem import Problem


def write_signals(path: Path, problem: Problem, point: np.ndarray) -> None:
    """One group a record: time, and for each axis the drive and, where measured, response, model and residual.

    The model carries the record's free offset and additions; residual is model minus response. Units are the user's.
    """
    import h5netcdf

    theta = problem.parameters(point)
    content = BytesIO()  # HDF5 does not survive a full disk
    with h5netcdf.File(content, "w") as file:
        for simulator in (simulator for simulators in problem.simulators.values() for simulator in simulators):
            record = simulator.record
            group = file.create_group(record.name)
            group.attrs.update(use=record.use, name=record.name, settle=record.settle * record.dt, file=record.file)
            group.dimensions = {"time": record.samples}
            put(group, "time", record.time, "s", "time")
            for axis, name in enumerate(record.axes):
                unit = record.drive_units[axis]
                put(group, f"drive_{name}", record.drive[axis] / factor(unit), unit, f"drive of {name}")
            errors = simulator.errors(theta)[0]
            for i, axis in enumerate(record.measured):
                name, unit = record.axes[axis], str(record.response_units[axis])
                residual = errors[i]
                put(group, f"response_{name}", record.response[axis] / factor(unit), unit, f"measured {name}")
                put(group, f"model_{name}", (record.response[axis] + residual) / factor(unit), unit, f"model of {name}")
                put(group, f"residual_{name}", residual / factor(unit), unit, f"model minus measured {name}")
    with replaced(path) as beside:
        beside.write_bytes(content.getbuffer())


def put(group: object, name: str, values: np.ndarray, unit: str, meaning: str) -> None:
    variable = group.create_variable(name, ("time",), data=values, compression="gzip")  # type: ignore[attr-defined]
    variable.attrs.update(units=unit, long_name=meaning)
