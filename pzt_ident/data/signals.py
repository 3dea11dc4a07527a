"""Write and read `signals.nc`: measurement, model and residual of each record as netCDF4."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.record import Record
from pzt_ident.data.units import factor
from pzt_ident.errors import InputError
from pzt_ident.files import replaced

if TYPE_CHECKING:
    import h5py

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Trace:
    """One measured axis of one record with its model, arrays of shape (samples,) in the user's units; the residual is
    model minus measurement.

    The first `settle` seconds are simulated but not scored.
    """

    record: str
    use: str
    axis: str
    time: Array
    drive: Array
    response: Array
    model: Array
    residual: Array
    drive_unit: str
    unit: str
    settle: float = 0.0

    @property
    def scored(self) -> NDArray[np.bool_]:
        return self.time > self.time[0] + self.settle - 0.5 * float(np.diff(self.time[:2]).sum())


def write_signals(path: Path, residuals: Iterable[tuple[Record, Array]]) -> None:
    """One group per record: time, and for each axis the drive and, where measured, response, model and residual.

    residuals: each record with model minus measurement, (measured axes, samples), SI units. The model includes the
    record's free offset and additions. Units in the file are the user's.
    """
    import h5py

    content = BytesIO()  # HDF5 does not survive a full disk
    with h5py.File(content, "w", track_order=True, rdcc_nbytes=0) as file:
        # HDF5 puts a part of an object into the file as soon as nobody has it open: a thread that looks at this one's
        # frames, as Dask's profiler does, would decide where
        opened = [item for record, residual in residuals for item in _write_group(file, record, residual)]
        file.flush()
        del opened
    with replaced(path) as beside:
        beside.write_bytes(content.getbuffer())


def _write_group(file: h5py.File, record: Record, residuals: Array) -> list[h5py.Group | h5py.Dataset]:
    """What was opened: the record's group and its variables, all along the dimension of time."""
    group = file.create_group(record.name, track_order=True)
    group.attrs.update(use=record.use, name=record.name, settle=record.settle * record.dt, file=_readable(record.file))
    time = _put(group, "time", record.time, "s", "time")
    time.make_scale("time")
    channels = []
    for axis, name in enumerate(record.axes):
        unit = record.drive_units[axis]
        channels.append(_put(group, f"drive_{name}", record.drive[axis] / factor(unit), unit, f"drive of {name}"))
    for axis, residual in zip(record.measured, residuals, strict=True):
        name, unit, response = record.axes[axis], str(record.response_units[axis]), record.response[axis]
        for kind, values, meaning in (
            ("response", response, f"measured {name}"),
            ("model", response + residual, f"model of {name}"),
            ("residual", residual, f"model minus measured {name}"),
        ):
            channels.append(_put(group, f"{kind}_{name}", values / factor(unit), unit, meaning))
    for channel in channels:
        channel.dims[0].attach_scale(time)
    return [group, time, *channels]


def _readable(path: str) -> str:
    """A path need not be UTF-8."""
    return path.encode("utf-8", "backslashreplace").decode()


def _put(group: h5py.Group, name: str, values: Array, unit: str, meaning: str) -> h5py.Dataset:
    variable = group.create_dataset(name, data=values, compression="gzip", track_order=True)
    variable.attrs.update(units=unit, long_name=meaning)
    return variable


def read_signals(path: Path, order: Sequence[str]) -> tuple[list[Record], list[Array]]:
    """The records of the file in the given order of names, and the residuals of each, (measured axes, samples), in SI
    units."""
    import h5py

    with h5py.File(path) as file:
        groups = sorted(_groups(file), key=lambda group: order.index(str(group.attrs["name"])))
        pairs = [_record(group) for group in groups]
    return [record for record, _ in pairs], [residual for _, residual in pairs]


def read_traces(path: Path, order: Sequence[str]) -> tuple[Trace, ...]:
    """Every measured axis of every record, in the given order of names. Raises InputError where the file is not
    netCDF4."""
    import h5py

    try:
        with h5py.File(path) as file:
            traces = [trace for group in _groups(file) for trace in _traces(group)]
    except (OSError, KeyError, RuntimeError, ValueError) as error:  # HDF5 raises any of them on a damaged file
        raise InputError(f"not netCDF4: {error}", where=str(path), remedy="run the job again") from error
    places = {name: place for place, name in reversed(list(enumerate(order)))}
    return tuple(sorted(traces, key=lambda trace: (places.get(trace.record, len(order)), trace.axis)))


def _groups(file: h5py.File) -> list[h5py.Group]:
    """The groups of records, at any depth: a record's name may contain a slash."""
    groups: list[h5py.Group] = []
    file.visititems(lambda _, item: groups.append(item) if "use" in item.attrs else None)
    return groups


def _settle(group: h5py.Group) -> float:
    return float(np.ravel(group.attrs["settle"])[0])


def _record(group: h5py.Group) -> tuple[Record, Array]:
    axes = tuple(name.removeprefix("drive_") for name in group if name.startswith("drive_"))
    time = group["time"][:]
    dt = float((time[-1] - time[0]) / (time.size - 1))
    unmeasured = np.full(time.size, np.nan)
    record = Record(
        name=str(group.attrs["name"]),
        use=str(group.attrs["use"]),  # type: ignore[arg-type]
        dt=dt,
        drive=np.array([_channel(group, f"drive_{axis}") for axis in axes]),
        response=np.array([_channel(group, f"response_{a}") if f"response_{a}" in group else unmeasured for a in axes]),
        start=float(time[0]),
        settle=round(_settle(group) / dt),
        axes=axes,
        drive_units=tuple(_unit(group, f"drive_{axis}") or "" for axis in axes),
        response_units=tuple(_unit(group, f"response_{axis}") for axis in axes),
    )
    return record, np.array([_channel(group, f"residual_{axes[a]}") for a in record.measured])


def _channel(group: h5py.Group, name: str) -> Array:
    return group[name][:] * factor(_unit(group, name) or "1")


def _unit(group: h5py.Group, name: str) -> str | None:
    return str(group[name].attrs["units"]) if name in group else None


def _traces(group: h5py.Group) -> list[Trace]:
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
            settle=_settle(group),
        )
        for axis in axes
    ]
