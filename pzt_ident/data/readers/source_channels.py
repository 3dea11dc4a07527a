"""From the channels of a job to the signals of one record."""

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
from pzt_ident.data.readers.select import pick
from pzt_ident.data.readers.signal import Signal, signal
from pzt_ident.data.readers.table import Column, Table
from pzt_ident.data.readers.timebase import Grid, check_rate, grid_of, rate_of
from pzt_ident.data.record import Axis, Channel, Source
from pzt_ident.data.units import FREQUENCY, MASS, TIME, dimension
from pzt_ident.errors import InputError, nearest


@dataclass
class Finder:
    """Finds the channels of one source; `tables` are the files already open, `used` the ones that this source needs."""

    source: Source
    folder: Path
    tables: dict[object, Table]
    used: dict[Path, Table] = field(default_factory=dict)

    @property
    def where(self) -> str:
        return str(self.folder / self.source.file)

    def signal(self, label: str, channel: Channel | None) -> Signal | None:
        """The drive or response `x.drive`, `x.response`; None where it is in no file."""
        channel = self._here(label, channel)
        if channel is None:
            return None
        column, values, where = self._column(label, channel)
        found = signal(column, values, self.source.rows, channel.unit, where)
        if dimension(found.unit) in (TIME, FREQUENCY, MASS):
            problem = f"a {label.rpartition('.')[2]} cannot have the unit {found.unit!r}"
            raise InputError(problem, where=where, remedy="is it the right column?")
        return found

    def grid(self, channel: Channel | None, samples: int) -> Grid:
        """The time grid by a column of stamps, by one value (s: sample time, Hz: sample rate) or by `sample_rate`."""
        channel, rate = self._here("time", channel), self.source.sample_rate
        if channel is None:
            if rate is None:
                remedy = "give the record a `sample_rate: 1 kHz`, or the job a `time` channel"
                raise InputError("has no time", where=self.where, remedy=remedy)
            return rate_of(rate, self.where)
        column, values, where = self._column("time", channel)
        alone = values.size == 1
        stamps = signal(column, values, None if alone else self.source.rows, channel.unit, where).complete()
        kind = dimension(stamps.unit)
        if kind not in ((TIME, FREQUENCY) if alone else (TIME,)):
            problem = f"time cannot have the unit {stamps.unit!r}"
            raise InputError(problem, where=where, remedy="give it in s, or one sample rate in Hz")
        if alone:
            value = float(stamps.values[0])
            grid = rate_of(value if kind == FREQUENCY or value == 0 else 1 / value, where)
        elif stamps.values.size == samples:
            grid = grid_of(stamps)
        else:
            problem = f"has {stamps.values.size} rows, the signals have {samples}"
            raise InputError(problem, where=where, remedy="take all channels over the same rows")
        check_rate(grid, rate, where)
        return grid

    def hash(self) -> str:
        """SHA-256 of the files used, one after the other."""
        digest = sha256()
        for path, table in self.used.items():
            digest.update(path.read_bytes() if table.content is None else table.content)
        return digest.hexdigest()

    def check(self, axes: Mapping[str, Axis]) -> None:
        """Raises InputError where `channels` of the source speaks of one that no axis has."""
        known = ["time", "drive", "response", *(f"{axis}.{role}" for axis in axes for role in ("drive", "response"))]
        for key in self.source.channels:
            if key not in known:
                raise InputError(f"unknown channel {key!r}", where=self.where, remedy=nearest(key, known))

    def _here(self, label: str, channel: Channel | None) -> Channel | None:
        """The channel as this record has it: what the source says of its role, then of it alone, wins."""
        role = label.rpartition(".")[2]
        if channel and role in self.source.channels:
            channel = _merged(channel, self.source.channels[role])
        if label in self.source.channels:
            channel = _merged(channel or Channel(), self.source.channels[label])
        return channel

    def _column(self, label: str, channel: Channel) -> tuple[Column, NDArray[Any], str]:
        path = self.folder / _expanded(channel.file or self.source.file, self.where)
        key = (path, self.source.table, self.source.sheet)
        if key not in self.tables:
            self.tables[key] = open_table(path, self.source)
        self.used[path] = self.tables[key]
        where = f"{path}: {label}"
        return *pick(self.tables[key], self.source, channel, where), where


def _merged(channel: Channel, over: Channel) -> Channel:
    if over.name or over.column is not None or over.dataset:
        channel = replace(channel, name=over.name, column=over.column, dataset=over.dataset)
    return replace(
        channel,
        unit=over.unit or channel.unit,
        index=over.index or channel.index,
        file=over.file or channel.file,
    )


def _expanded(name: str, where: str) -> str:
    """The path with the values of the environment variables `${VAR}` in it."""

    def value(found: re.Match[str]) -> str:
        if found[1] not in os.environ:
            remedy = f"set it, for example `export {found[1]}=/path/to/data`"
            raise InputError(f"the environment variable {found[1]} is not set", where=where, remedy=remedy)
        return os.environ[found[1]]

    return re.sub(r"\$\{(\w+)\}", value, name)
