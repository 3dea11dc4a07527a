"""A measurement as a user of the library has it: arrays, a pandas frame, or a file."""

from __future__ import annotations

from collections.abc import Mapping
from copy import copy
from dataclasses import fields
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from pzt_ident.api.arguments import (
    QUANTITY,
    Array,
    Signals,
    Units,
    by_axis,
    by_level,
    by_unit,
    check_indices,
    path_of,
    rate_or_stamps,
    seconds,
)
from pzt_ident.api.wording import as_arguments
from pzt_ident.data import record as data
from pzt_ident.data.notation import short
from pzt_ident.data.readers import read_records
from pzt_ident.data.readers.read import SHORTEST
from pzt_ident.data.readers.table import Column, Table
from pzt_ident.data.units import factor, same_kind, split_header
from pzt_ident.errors import InputError, nearest

if TYPE_CHECKING:
    import pandas as pd


class Record:
    """Drive and response of one or more axes over time.

    t: time stamps (samples,) in s, or the sample rate: a number in Hz, or text such as `"5 kHz"`.
    u: the drive of one axis (samples,), of several as (samples, axes) or as `{"x": ..., "y": ...}`.
    y: the response likewise; an axis without one is driven but not measured. Without any y the record is a drive.
    drive, response: their units, for all axes or by axis. name: without one it is called train or test, by its use.
    settle: s, or text such as `"20 ms"`, at the start that are simulated but not scored. run_in: how often the drive is
    simulated before the first sample, for a periodic record in steady state. rest_at: the drive at which the stage
    rested until one sample before the first, a number or text such as `"0 V"`, of all axes or by axis.
    denoise_drive: whether noise of the drive, as of a monitor output, is left out. smooth_drive: whether the drive is
    smooth between its samples, and not linear, by default as the model takes it. steps: of the simulation in a sample.
    Raises InputError where shapes or units do not fit; gaps, time stamps and constant responses are looked at when the
    record is identified from.
    """

    def __init__(
        self,
        t: ArrayLike | str,
        u: Signals,
        y: Signals | None = None,
        *,
        drive: Units = "V",
        response: Units = "um",
        name: str = "",
        settle: float | str = 0.0,
        run_in: int = 0,
        rest_at: float | str | Mapping[str, float | str] | None = None,
        denoise_drive: bool = False,
        smooth_drive: bool | None = None,
        steps: int = 1,
    ) -> None:
        if not isinstance(name, str):
            raise InputError(f"{name!r} is no text", where="name", remedy="give text such as 'slow'")
        title = name or "record"
        self.name, self.run_in, self.steps = name, run_in, steps
        self.denoise_drive, self.smooth_drive = denoise_drive, smooth_drive
        check_indices(t, u, y, where=title)
        self.settle = seconds(settle, f"{title}: settle")
        self.rate, self.t = rate_or_stamps(t, f"{title}: t")
        samples = None if self.t is None else self.t.size
        self.u = by_axis(u, samples, f"{title}: u")
        self.y = {} if y is None else by_axis(y, self.samples, f"{title}: y", list(self.u))
        self.drive = by_unit(drive, list(self.u), f"{title}: drive", "V")
        self.response = by_unit(response, list(self.y), f"{title}: response", "um")
        self.rest_at = by_level(rest_at, self.drive, f"{title}: rest_at")
        if self.rest_at and run_in:
            problem = "a record of a steady state, which `run_in` says this is, does not begin at rest"
            raise InputError(problem, where=f"{title}: rest_at", remedy="keep one of the two")
        if self.samples < SHORTEST:
            problem = f"has {self.samples} samples, at least {SHORTEST} are needed"
            raise InputError(problem, where=title, remedy="give more")

    @classmethod
    def from_frame(
        cls,
        frame: pd.DataFrame,
        *,
        time: str | float,
        drive: str | Mapping[str, str],
        response: str | Mapping[str, str] | None = None,
        **more: Any,
    ) -> Record:
        """The columns of a pandas frame, their units in their names: `Record.from_frame(frame, time="t [s]",
        drive="u [V]", response="x [um]")`. time: the column of the stamps, or a sample rate. drive, response: a column,
        or a column by axis. more: as for a record. Raises InputError for a column that is not there, or has no unit.
        """
        if not hasattr(frame, "columns"):
            raise InputError(f"{type(frame).__name__} is no frame", where="frame", remedy="give a pandas.DataFrame")
        drives, responses = (
            dict(columns or {}) if columns is None or isinstance(columns, Mapping) else {"x": columns}
            for columns in (drive, response)
        )
        stamps: Any = time
        if isinstance(time, str) and (time in frame.columns or not QUANTITY.match(time)):
            stamps = _column(frame, time)
            if np.asarray(stamps).dtype.kind in "iuf":
                stamps = stamps * _seconds_in(_header_unit(time, "s"))
        signals = [{axis: _column(frame, column) for axis, column in side.items()} for side in (drives, responses)]
        units = [{axis: _header_unit(column) for axis, column in side.items()} for side in (drives, responses)]
        return cls(stamps, signals[0], signals[1] or None, drive=units[0], response=units[1], **more)

    @classmethod
    def read(
        cls,
        path: str | Path,
        *,
        drive: Any,
        response: Any = None,
        time: Any = None,
        sample_rate: float | str | None = None,
        rows: tuple[int, int] | None = None,
        **more: Any,
    ) -> Record:
        """A record of a file, of any format that a job takes. drive, response, time: a header such as `"u_x [V]"`, or
        what a job says of a channel, `{"column": 3, "unit": "V"}`, by axis where there are several. sample_rate: Hz.
        rows: the first, counted from 0, and the one behind the last. more: as for a record, and `table`, `sheet`,
        `dataset`, `index`, `decimate` as in a job. Raises InputError on whatever is wrong with the file.
        """
        path = path_of(path, "path")
        settings: dict[str, Any] = {
            key: more.pop(key) for key in ("table", "sheet", "dataset", "index", "decimate") if key in more
        }
        settings |= {"rows": _rows(rows), "sample_rate": None if sample_rate is None else _rate(sample_rate)}
        source = data.Source(path.name, name=path.stem, **settings)
        drives, responses = _channels(drive), _channels(response) if response is not None else {}
        axes = {axis: data.Axis(channel, responses.get(axis)) for axis, channel in drives.items()}
        with as_arguments():
            (record,) = read_records([source], axes, None if time is None else _channel(time), path.parent)
        return cls.of(record, **({"name": record.name} | more))

    @classmethod
    def of(cls, record: data.Record, **more: Any) -> Record:
        """A record of signals in SI units, in the user's units again."""
        drives = dict(zip(record.axes, record.drive_units, strict=True))
        signals = {axis: row / factor(drives[axis]) for axis, row in zip(record.axes, record.drive, strict=True)}
        responses = {
            record.axes[a]: record.response[a] / factor(unit)
            for a, unit in zip(record.measured, record.units.values(), strict=True)
        }
        known: dict[str, Any] = {"settle": record.settle * record.dt, "run_in": record.run_in, "steps": record.steps}
        known |= {"denoise_drive": record.denoise_drive, "smooth_drive": record.smooth_drive}
        known["rest_at"] = {
            axis: level / factor(drives[axis])
            for axis, level in zip(record.axes, record.rest_at, strict=False)
            if level is not None
        }
        known |= {"name": record.name, "drive": drives, "response": record.units}
        return cls(record.time, signals, responses or None, **(known | more))

    def with_steps(self, steps: int) -> Record:
        """The same record, simulated in so many steps a sample."""
        return self._with("steps", steps)

    def with_name(self, name: str) -> Record:
        """The same record under a name."""
        return self._with("name", name)

    @property
    def axes(self) -> tuple[str, ...]:
        return tuple(self.u)

    @property
    def samples(self) -> int:
        return next(iter(self.u.values())).size

    def table(self, stamps: bool = True) -> Table:
        """The record as the readers see a file: its columns with units in their headers. Without `stamps` the time is
        left to the sample rate."""
        time = {"time [s]": self.stamps} if stamps else {}
        signals = {f"u_{axis} [{self.drive[axis]}]": values for axis, values in self.u.items()}
        signals |= {f"{axis} [{self.response[axis]}]": values for axis, values in self.y.items()}
        columns = {**time, **signals}
        content = b"".join(np.ascontiguousarray(values).tobytes() for values in columns.values())
        loads = [Column(header, partial(np.asarray, values)) for header, values in columns.items()]
        return Table(Path(self.name), loads, content=content)

    @property
    def stamps(self) -> Array:
        """Time, s."""
        return self.t if self.t is not None else np.arange(self.samples) / float(self.rate or 1)

    def channels(self) -> dict[str, dict[str, str]]:
        """Drive and response of each axis by the names of their columns, as a job has them; each record has its own
        units in its headers."""
        return {axis: {"drive": f"u_{axis}"} | ({"response": axis} if axis in self.y else {}) for axis in self.u}

    def write_csv(self, path: Path, stamps: bool = True) -> None:
        """The record as a CSV file that gives the same numbers again."""
        from pzt_ident.files import write_columns

        write_columns(path, {column.header: column.load() for column in self.table(stamps).columns})

    def _with(self, attribute: str, value: Any) -> Record:
        if value == getattr(self, attribute):
            return self
        changed = copy(self)
        setattr(changed, attribute, value)
        return changed

    def __repr__(self) -> str:
        step = float(self.stamps[-1] - self.stamps[0]) / (self.samples - 1)
        rate = f" ({short(1 / step)} Hz)" if step else ""
        length = f"{self.samples} samples in {short(self.samples * step)} s{rate}"
        axes = ", ".join(
            f"{axis}: {self.drive[axis]}" + (f" -> {self.response[axis]}" if axis in self.y else " (not measured)")
            for axis in self.u
        )
        return f"Record{f' {self.name!r}' if self.name else ''}: {length}; {axes}"


def _column(frame: pd.DataFrame, name: str) -> Array:
    if name not in frame.columns:
        raise InputError(f"has no column {name!r}", where="frame", remedy=nearest(str(name), map(str, frame.columns)))
    return frame[name].to_numpy()


def _seconds_in(unit: str) -> float:
    if not same_kind(unit, "s"):
        raise InputError(f"{unit} is no unit of time", where="frame: time", remedy="name the column of the stamps")
    return factor(unit)


def _header_unit(header: str, usual: str | None = None) -> str:
    unit = split_header(str(header))[1] or usual
    if unit is None:
        raise InputError(f"column {header!r} has no unit", where="frame", remedy=f"rename it, as in `{header} [um]`")
    return unit


def _rate(rate: float | str) -> float | None:
    return rate_or_stamps(rate, "sample_rate")[0]


def _rows(rows: Any) -> tuple[int, int] | None:
    if rows is not None and (np.shape(rows) != (2,) or not np.issubdtype(np.asarray(rows).dtype, np.integer)):
        raise InputError(f"{rows!r} is no pair of rows", where="rows", remedy="give (first, behind the last)")
    return None if rows is None else (int(rows[0]), int(rows[1]))


def _channels(channels: Any) -> dict[str, data.Channel]:
    """By axis; one channel alone is that of x."""
    alone = not isinstance(channels, Mapping) or {item.name for item in fields(data.Channel)} & set(channels)
    return {"x": _channel(channels)} if alone else {axis: _channel(channel) for axis, channel in channels.items()}


def _channel(channel: Any) -> data.Channel:
    known = {item.name for item in fields(data.Channel)}
    if isinstance(channel, Mapping) and set(channel) <= known:
        return data.Channel(**channel)
    if not isinstance(channel, str):
        remedy = "give a header such as 'u_x [V]', or {'column': 3, 'unit': 'V'}"
        raise InputError(f"{channel!r} is no channel", where="read", remedy=remedy)
    return data.Channel(name=channel)
