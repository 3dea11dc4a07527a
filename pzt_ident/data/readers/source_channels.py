"""The signals and the time grid of one record, taken from the files by the channels of the job."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from hashlib import sha256
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from pzt_ident.data.readers.open import open_table
from pzt_ident.data.readers.select import select_column
from pzt_ident.data.readers.signal import Signal, signal_of
from pzt_ident.data.readers.table import Column, Table
from pzt_ident.data.readers.timebase import Grid, check_rate, grid_of_rate, grid_of_sample_times, grid_of_stamps
from pzt_ident.data.record import Axis, Channel, Source
from pzt_ident.data.units import FREQUENCY, MASS, TIME, dimension
from pzt_ident.errors import InputError, nearest


@dataclass
class SourceChannels:
    """The channels of one source. `tables`: the files already open. `used`: the files that this source needs.
    `sample_times`: s, that these state for its signals."""

    source: Source
    folder: Path
    tables: dict[object, Table]
    used: dict[Path, Table] = field(default_factory=dict)
    sample_times: list[float] = field(default_factory=list)

    @property
    def where(self) -> str:
        return str(self.folder / self.source.file)

    def signal(self, label: str, channel: Channel | None) -> Signal | None:
        """The drive or response `x.drive`, `x.response`; None where it is in no file."""
        channel = self._channel_here(label, channel)
        if channel is None:
            return None
        column, values, where = self._column(label, channel)
        self.sample_times += [column.sample_time] if column.sample_time else []
        signal = signal_of(column, values, self.source.rows, channel.unit, where)
        if dimension(signal.unit) in (TIME, FREQUENCY, MASS):
            problem = f"a {label.rpartition('.')[2]} cannot have the unit {signal.unit!r}"
            raise InputError(problem, where=where, remedy="is it the right column?")
        return signal

    def grid(self, channel: Channel | None, samples: int) -> Grid:
        """The time grid by a column of time stamps, one value (s: sample time, Hz: sample rate), `sample_rate`, or what
        the file states for its signals.

        samples: rows of the signals. Raises InputError where they have no time, or one that does not fit.
        """
        channel, rate = self._channel_here("time", channel), self.source.sample_rate
        if channel is None:
            stated = grid_of_sample_times(self.sample_times, self.where)
            if stated:
                check_rate(stated, rate, self.where)
            if grid := stated if rate is None else grid_of_rate(rate, self.where):
                return grid
            remedy = "give the record a `sample_rate: 1 kHz`, or the job a `time` channel"
            raise InputError("has no time", where=self.where, remedy=remedy)
        column, values, where = self._column("time", channel)
        single = values.size == 1
        stamps = signal_of(column, values, None if single else self.source.rows, channel.unit, where).complete()
        kind = dimension(stamps.unit)
        if kind not in ((TIME, FREQUENCY) if single else (TIME,)):
            problem = f"time cannot have the unit {stamps.unit!r}"
            raise InputError(problem, where=where, remedy="give it in s, or one sample rate in Hz")
        if single:
            value = float(stamps.values[0])
            grid = grid_of_rate(value if kind == FREQUENCY or value == 0 else 1 / value, where)
        elif stamps.values.size == samples:
            grid = grid_of_stamps(stamps)
        else:
            problem = f"has {stamps.values.size} rows, the signals have {samples}"
            raise InputError(problem, where=where, remedy="take all channels override the same rows")
        check_rate(grid, rate, where)
        return grid

    def hash(self) -> str:
        """SHA-256 of the files used, one after another."""
        digest = sha256()
        for path, table in self.used.items():
            digest.update(path.read_bytes() if table.content is None else table.content)
        return digest.hexdigest()

    def check(self, axes: Mapping[str, Axis]) -> None:
        """Raises InputError where `channels` of the source names one that no axis has."""
        known = ["time", "drive", "response", *(f"{axis}.{role}" for axis in axes for role in ("drive", "response"))]
        for key in self.source.channels:
            if key not in known:
                raise InputError(f"unknown channel {key!r}", where=self.where, remedy=nearest(key, known))

    def _channel_here(self, label: str, channel: Channel | None) -> Channel | None:
        """The channel as this record has it: what the source says of its role, and above all of itself, overrides."""
        role = label.rpartition(".")[2]
        if channel and role in self.source.channels:
            channel = _overridden(channel, self.source.channels[role])
        if label in self.source.channels:
            channel = _overridden(channel or Channel(), self.source.channels[label])
        return channel

    def _column(self, label: str, channel: Channel) -> tuple[Column, NDArray[Any], str]:
        path = self.folder / _expanded(channel.file or self.source.file, self.where)
        key = (path, self.source.table, self.source.sheet)
        if key not in self.tables:
            self.tables[key] = open_table(path, self.source)
        self.used[path] = self.tables[key]
        where = f"{path}: {label}"
        return *select_column(self.tables[key], self.source, channel, where), where


def _overridden(channel: Channel, override: Channel) -> Channel:
    if override.name or override.column is not None or override.dataset:
        channel = replace(channel, name=override.name, column=override.column, dataset=override.dataset)
    return replace(
        channel,
        unit=override.unit or channel.unit,
        index=override.index or channel.index,
        file=override.file or channel.file,
    )


def _expanded(name: str, where: str) -> str:
    """The path with the values of the environment variables `${VAR}` in it."""

    def value(match: re.Match[str]) -> str:
        if match[1] not in os.environ:
            remedy = f"set it, for example `export {match[1]}=/path/to/data`"
            raise InputError(f"the environment variable {match[1]} is not set", where=where, remedy=remedy)
        return os.environ[match[1]]

    return re.sub(r"\$\{(\w+)\}", value, name)
