"""A measurement as a user of the library has it: arrays, a pandas frame, or a file."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from copy import copy
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pzt_ident.data import record as data
from pzt_ident.data.readers import read_records
from pzt_ident.data.readers.table import Column, Table
from pzt_ident.data.units import FREQUENCY, dimension, factor, split_header
from pzt_ident.errors import InputError

if TYPE_CHECKING:
    import pandas as pd

Array = NDArray[Any]
Signals = Any  # an array, or one by axis
Units = str | Mapping[str, str]
AXES = "xyzabc"
QUANTITY = re.compile(r"^([\d.]+(?:[eE][-+]?\d+)?)\s*(\D.*)$")


class Record:
    """Drive and response of one or more axes over time.

    t: time stamps (samples,) in s, or the sample rate: a number in Hz, or text such as `"5 kHz"`.
    u: the drive of one axis (samples,), of several as (samples, axes) or as `{"x": ..., "y": ...}`.
    y: the response likewise; an axis without one is driven but not measured. Without any y the record is a drive.
    drive, response: their units, for all axes or by axis.
    settle: s at the start that are simulated but not scored. run_in: how often the drive is simulated before the first
    sample, for a periodic record in steady state. steps: of the simulation in a sample.
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
        name: str = "record",
        settle: float = 0.0,
        run_in: int = 0,
        steps: int = 1,
    ) -> None:
        self.name, self.settle, self.run_in, self.steps = name, float(settle), run_in, steps
        self.rate, self.t = _rate_or_stamps(t, name)
        samples = None if self.t is None else self.t.size
        self.u = _by_axis(u, samples, f"{name}: u")
        self.y = {} if y is None else _by_axis(y, samples, f"{name}: y", list(self.u))
        self.drive = _units(drive, self.u, f"{name}: drive")
        self.response = _units(response, self.y, f"{name}: response")

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
        drives, responses = (
            {"x": columns} if isinstance(columns, str) else dict(columns or {}) for columns in (drive, response)
        )
        stamps: Any = time
        if isinstance(time, str) and time in frame.columns:
            stamps = _column(frame, time) * factor(_header_unit(time, "s"))
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
        sample_rate: float | None = None,
        rows: tuple[int, int] | None = None,
        **more: Any,
    ) -> Record:
        """A record of a file, of any format that a job takes. drive, response, time: a header such as `"u_x [V]"`, or
        what a job says of a channel, `{"column": 3, "unit": "V"}`, by axis where there are several. sample_rate: Hz.
        rows: the first, counted from 0, and the one behind the last. more: as for a record, and `table`, `sheet`,
        `dataset`, `index`, `decimate` as in a job. Raises InputError on whatever is wrong with the file.
        """
        path = Path(path)
        settings = {key: more.pop(key) for key in ("table", "sheet", "dataset", "index", "decimate") if key in more}
        source = data.Source(path.name, name=path.stem, sample_rate=sample_rate, rows=rows, **settings)
        drives, responses = _channels(drive), _channels(response) if response is not None else {}
        axes = {axis: data.Axis(channel, responses.get(axis)) for axis, channel in drives.items()}
        (found,) = read_records([source], axes, None if time is None else _channel(time), path.parent)
        return cls.of(found, **({"name": found.name} | more))

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
        known |= {"name": record.name, "drive": drives, "response": record.units}
        return cls(record.time, signals, responses or None, **(known | more))

    def with_steps(self, steps: int) -> Record:
        """The same record, simulated in so many steps a sample."""
        if steps == self.steps:
            return self
        changed = copy(self)
        changed.steps = steps
        return changed

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
        """Drive and response of each axis by their headers, as a job has them."""
        return {
            axis: {"drive": f"u_{axis} [{self.drive[axis]}]"}
            | ({"response": f"{axis} [{self.response[axis]}]"} if axis in self.y else {})
            for axis in self.u
        }

    def write_csv(self, path: Path, stamps: bool = True) -> None:
        """The record as a CSV file that gives the same numbers again."""
        from pzt_ident.files import write_text

        columns = {column.header: column.load().tolist() for column in self.table(stamps).columns}
        rows = zip(*columns.values(), strict=True)
        write_text(path, "\n".join([",".join(columns), *(",".join(map(repr, row)) for row in rows)]) + "\n")

    def __repr__(self) -> str:
        axes = ", ".join(
            f"{axis}: {self.drive[axis]}" + (f" -> {self.response[axis]}" if axis in self.y else " (not measured)")
            for axis in self.u
        )
        return f"Record {self.name!r}: {self.samples} samples; {axes}"


def _rate_or_stamps(t: Any, name: str) -> tuple[float | None, Array | None]:
    """Sample rate, Hz, or time stamps, s: one of the two."""
    if isinstance(t, str):
        quantity = QUANTITY.match(t.strip())
        if not quantity or dimension(quantity[2]) != FREQUENCY:
            remedy = "give time stamps in s, a rate in Hz, or text such as '5 kHz'"
            raise InputError(f"{t!r} is no sample rate", where=f"{name}: t", remedy=remedy)
        return float(quantity[1]) * factor(quantity[2]), None
    values = _numbers(t, f"{name}: t")
    return (float(values), None) if values.ndim == 0 else (None, values)


def _by_axis(
    signals: Signals, samples: int | None, where: str, axes: Sequence[str] = AXES
) -> dict[str, NDArray[np.float64]]:
    """Each axis' signal (samples,). Raises InputError where lengths or axes do not fit."""
    if isinstance(signals, Mapping):
        by_axis = {str(axis): _numbers(values, where) for axis, values in signals.items()}
    elif hasattr(signals, "columns"):
        by_axis = {str(axis): _numbers(signals[axis], where) for axis in signals.columns}
    else:
        by_axis = dict(zip(axes, _columns(_numbers(signals, where), samples, len(axes), where), strict=False))
    for axis, values in by_axis.items():
        length = samples if samples is not None else next(iter(by_axis.values())).size
        if values.ndim != 1 or values.size != length:
            problem = f"axis {axis} has the shape {values.shape}, not ({length},)"
            raise InputError(problem, where=where, remedy="give time, drive and response over the same samples")
        if axes is not AXES and axis not in axes:
            remedy = f"there are {', '.join(axes)}"
            raise InputError(f"axis {axis!r} has no drive", where=where, remedy=remedy)
    return by_axis


def _columns(values: NDArray[np.float64], samples: int | None, most: int, where: str) -> NDArray[np.float64]:
    """(axes, samples) of an array (samples,), (samples, axes) or, where only that fits, (axes, samples)."""
    rows = np.atleast_2d(values)
    if values.ndim == 2 and samples != values.shape[1]:
        rows = values.T
    if values.ndim not in (1, 2) or len(rows) > most:
        remedy = "give (samples,) for one axis, (samples, axes) for more, or a dict by axis"
        raise InputError(f"an array of shape {values.shape}", where=where, remedy=remedy)
    return rows


def _numbers(values: Any, where: str) -> NDArray[np.float64]:
    try:
        return np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError):
        raise InputError("holds something that is no number", where=where, remedy="give plain numbers") from None


def _units(units: Units, signals: Mapping[str, Array], where: str) -> dict[str, str]:
    """The unit of each axis. Raises InputError for one that is missing or unknown."""
    by_axis = dict(units) if isinstance(units, Mapping) else dict.fromkeys(signals, units)
    for axis in signals:
        if axis not in by_axis:
            raise InputError(f"no unit of axis {axis}", where=where, remedy=f"give {{{axis!r}: 'um'}}")
        try:
            factor(by_axis[axis])
        except InputError as error:
            raise InputError(error.message, where=where, remedy=error.remedy) from None
    return {axis: by_axis[axis] for axis in signals}


def _column(frame: pd.DataFrame, name: str) -> Array:
    from pzt_ident.errors import nearest

    if name not in frame.columns:
        raise InputError(f"has no column {name!r}", where="frame", remedy=nearest(name, map(str, frame.columns)))
    return frame[name].to_numpy()


def _header_unit(header: str, usual: str | None = None) -> str:
    unit = split_header(header)[1] or usual
    if unit is None:
        raise InputError(f"column {header!r} has no unit", where="frame", remedy=f"rename it, as in `{header} [um]`")
    return unit


def _channels(channels: Any) -> dict[str, data.Channel]:
    """By axis; one channel alone is that of x."""
    alone = isinstance(channels, str) or {"column", "name", "dataset", "unit", "file", "index"} & set(channels)
    return {"x": _channel(channels)} if alone else {axis: _channel(channel) for axis, channel in channels.items()}


def _channel(channel: Any) -> data.Channel:
    return data.Channel(name=channel) if isinstance(channel, str) else data.Channel(**channel)
