"""From the records that a job names to signals on uniform time grids, in SI units."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import count
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.readers.decimate import decimated
from pzt_ident.data.readers.signal import Signal
from pzt_ident.data.readers.source_channels import Finder
from pzt_ident.data.readers.table import Table
from pzt_ident.data.readers.timebase import stretch
from pzt_ident.data.record import Axis, Channel, Record, Source
from pzt_ident.data.units import same_kind, unscaled
from pzt_ident.errors import InputError

SHORTEST = 3
"""Samples that a record must have."""


def read_records(
    sources: Sequence[Source],
    axes: Mapping[str, Axis],
    time: Channel | None,
    folder: Path,
    arrays: Mapping[str, Table] | None = None,
) -> list[Record]:
    """The records of a job, in its order; paths are relative to `folder`, `${VAR}` in them is an environment variable.

    A record goes by its name, else by its file's; names that occur twice are numbered. A record to validate that
    holds samples of one to identify has a note of it. `arrays` are tables in the place of files, by the file's name in
    the source. Raises InputError on whatever is wrong with a file, naming file,
    channel and row.
    """
    tables: dict[object, Table] = {(folder / file, None, None): table for file, table in (arrays or {}).items()}
    records = _named([_record(Finder(source, folder, tables), axes, time) for source in sources])
    _check_kinds(records)
    records = [_as_first(record, records[0]) for record in records]
    fitted = [record for record in records if record.use == "identify"]
    return [replace(r, notes=r.notes + _leaks(r, fitted)) if r.use == "validate" else r for r in records]


def _named(records: Sequence[Record]) -> list[Record]:
    total = Counter(record.name for record in records)
    taken, named = set(total), []
    for record in records:
        if total[record.name] > 1:
            free = (f"{record.name}_{number}" for number in count(1))
            record = replace(record, name=next(name for name in free if name not in taken))
            taken.add(record.name)
        named.append(record)
    return named


def _leaks(record: Record, fitted: Sequence[Record]) -> tuple[str, ...]:
    """A note for each of the fitted records that holds some of the same scored samples of the same file."""
    notes = []
    for other in fitted:
        first, last = max(_scored(record), _scored(other)), min(record.rows[1], other.rows[1])
        if record.sha256 == other.sha256 and first < last:
            here, there = (r.response[:, first - r.rows[0] : last - r.rows[0]] for r in (record, other))
            if np.array_equal(here, there, equal_nan=True):
                notes.append(f"rows {first} to {last} are fitted in {other.name!r}, so they validate nothing")
    return tuple(notes)


def _scored(record: Record) -> int:
    """The first row that is scored."""
    first, last = record.rows
    return first + record.settle * (last - first) // record.samples


def _record(finder: Finder, axes: Mapping[str, Axis], time: Channel | None) -> Record:
    finder.check(axes)
    source, where = finder.source, finder.where
    drives = [finder.signal(f"{name}.drive", axis.drive) for name, axis in axes.items()]
    responses = [finder.signal(f"{name}.response", axis.response) for name, axis in axes.items()]
    rows = _rows([*drives, *responses], where)
    grid = finder.grid(time, rows)
    part = stretch(grid, rows, source.time, where)
    first = drives[0].first if drives[0] else 0
    _check_length(part, source, grid.dt, where)
    for response in filter(None, responses):
        _check_moving(response.cut(part).complete())
    return Record(
        name=source.name or Path(source.file).stem,
        use=source.use,
        dt=grid.dt * source.decimate,
        drive=_sampled(drives, part, source),
        response=_sampled(responses, part, source),
        start=grid.start + grid.dt * part.start,
        settle=round(source.settle / (grid.dt * source.decimate)),
        run_in=source.run_in,
        steps=source.steps,
        file=source.file,
        sha256=finder.hash(),
        rows=(first + part.start, first + part.stop),
        axes=tuple(axes),
        drive_units=tuple(unscaled(drive.unit) for drive in drives if drive),
        response_units=tuple(unscaled(response.unit) if response else None for response in responses),
        notes=_notes(source),
    )


def _rows(signals: Sequence[Signal | None], where: str) -> int:
    rows = {signal.where: len(signal.values) for signal in signals if signal}
    if len(set(rows.values())) > 1:
        counts = ", ".join(f"{name} {count}" for name, count in rows.items())
        raise InputError(f"the signals differ in length: {counts}", where=where, remedy="cut them with `rows`")
    return next(iter(rows.values()))


def _check_length(part: slice, source: Source, dt: float, where: str) -> None:
    samples = len(range(part.start, part.stop, source.decimate))
    if samples < SHORTEST:
        problem = f"the record has {samples} samples, at least {SHORTEST} are needed"
        raise InputError(problem, where=where, remedy="widen `rows` or `time`, or decimate less")
    if round(source.settle / (dt * source.decimate)) >= samples:
        problem = f"settle {source.settle:g} s leaves nothing of {samples * dt * source.decimate:g} s"
        raise InputError(problem, where=where, remedy="shorten it")


def _check_moving(response: Signal) -> None:
    if np.ptp(response.values) == 0:
        problem = f"the response is constant ({response.values[0]:g} in SI units)"
        raise InputError(problem, where=response.where, remedy="is it the right column, and was the sensor connected?")


def _sampled(signals: Sequence[Signal | None], part: slice, source: Source) -> NDArray[np.float64]:
    """(axes, samples); NaN for a signal that is not measured. A record that is run in is periodic, and stays so where
    its samples are a multiple of the step."""
    step = source.decimate
    periodic = source.run_in > 0 and (part.stop - part.start) % step == 0
    missing = np.full(len(range(part.start, part.stop, step)), np.nan)
    cut = [item.cut(part).complete().values if item else None for item in signals]
    return np.array([missing if values is None else decimated(values, step, periodic) for values in cut])


def _notes(source: Source) -> tuple[str, ...]:
    if source.decimate == 1:
        return ()
    return (f"decimated by {source.decimate} behind a zero-phase low-pass, which rounds the corners of the drive",)


def _as_first(record: Record, first: Record) -> Record:
    """The record with the units of the first one, so that every number of an axis is in one."""
    return replace(record, drive_units=first.drive_units, response_units=first.response_units)


def _check_kinds(records: Sequence[Record]) -> None:
    """Raises InputError where an axis has another kind of unit than in the first record."""
    for record in records[1:]:
        for units, first in (
            (record.drive_units, records[0].drive_units),
            (record.response_units, records[0].response_units),
        ):
            for axis, unit, usual in zip(record.axes, units, first, strict=True):
                if unit and usual and not same_kind(unit, usual):
                    problem = f"axis {axis} is in {unit}, in the record {records[0].name!r} it is in {usual}"
                    raise InputError(problem, where=record.file, remedy="identify such records in separate jobs")
