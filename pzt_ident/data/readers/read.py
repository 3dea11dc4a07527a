"""From the records that a job names to signals on uniform time grids, in SI units."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import count
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.faults import fault_phrases
from pzt_ident.data.notation import listed
from pzt_ident.data.readers.decimate import decimated
from pzt_ident.data.readers.signal import Signal
from pzt_ident.data.readers.source_channels import SourceChannels
from pzt_ident.data.readers.table import Table
from pzt_ident.data.readers.timebase import Grid, time_slice
from pzt_ident.data.record import Axis, Channel, Level, Record, Source
from pzt_ident.data.start_step import start_step
from pzt_ident.data.units import factor, is_unit, same_kind, unscaled
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
    """The records of a job, in its order. Paths are relative to `folder`; `${VAR}` in them is an environment variable.

    A record has the name that the job gives it, else that of its file; a name that occurs twice is numbered. A
    validation record that holds samples of an identification record has a note of it. Raises InputError with file,
    channel and row for whatever is wrong with a file. arrays: tables that stand in the place of files, by the file's
    name in the source.
    """
    tables: dict[object, Table] = {(folder / file, None, None): table for file, table in (arrays or {}).items()}
    records = _with_names([_record(SourceChannels(source, folder, tables), axes, time) for source in sources])
    _check_unit_kinds(records)
    records = [_in_units_of(records[0], record) for record in records]
    by_file: dict[str, list[Record]] = {}
    for record in records:
        if record.use == "identify":
            by_file.setdefault(record.sha256, []).append(record)
    return [_with_leakage_notes(record, by_file.get(record.sha256, ())) for record in records]


def _with_names(records: Sequence[Record]) -> list[Record]:
    total = Counter(record.name for record in records)
    taken, renamed = set(total), []
    numbers = {name: count(1) for name in total}
    for record in records:
        if total[record.name] > 1:
            free = (f"{record.name}_{number}" for number in numbers[record.name])
            record = replace(record, name=next(name for name in free if name not in taken))
            taken.add(record.name)
        renamed.append(record)
    return renamed


def _with_leakage_notes(record: Record, identification: Sequence[Record]) -> Record:
    """A validation record with a note for every identification record of the same file that holds some of the same
    scored samples."""
    if record.use != "validate":
        return record
    notes = list(record.notes)
    for other in identification:
        first, last = max(_first_scored_row(record), _first_scored_row(other)), min(record.rows[1], other.rows[1])
        if first < last:
            mine, its = (item.response[:, first - item.rows[0] : last - item.rows[0]] for item in (record, other))
            if np.array_equal(mine, its, equal_nan=True):
                notes.append(f"rows {first} to {last} are fitted in {other.name!r}, so they validate nothing")
    return replace(record, notes=tuple(notes))


def _first_scored_row(record: Record) -> int:
    first, last = record.rows
    return first + record.settle * (last - first) // record.samples


def _record(channels: SourceChannels, axes: Mapping[str, Axis], time: Channel | None) -> Record:
    channels.check(axes)
    source, where = channels.source, channels.where
    drives = [channels.signal(f"{name}.drive", axis.drive) for name, axis in axes.items()]
    responses = [channels.signal(f"{name}.response", axis.response) for name, axis in axes.items()]
    rows = _rows([*drives, *responses], where)
    grid = channels.grid(time, rows)
    part = time_slice(grid, rows, source.time, where)
    first = drives[0].first if drives[0] else 0
    _check_length(part, source, grid.dt, where)
    moves = [drive is None or _moves(drive, part) for drive in drives]
    for moved, response in zip(moves, responses, strict=True):
        if response and (moved or not any(moves)):
            _check_not_constant(response.cut(part).complete())
    record = Record(
        name=source.name or Path(source.file).stem,
        use=source.use,
        dt=grid.dt * source.decimate,
        drive=_quiet(_sampled(drives, part, source)) if source.denoise_drive else _sampled(drives, part, source),
        response=_sampled(responses, part, source),
        start=grid.start + grid.dt * part.start,
        settle=round(source.settle / (grid.dt * source.decimate)),
        run_in=source.run_in,
        rest_at=_rest(source, axes, drives, where),
        denoise_drive=source.denoise_drive,
        smooth_drive=source.smooth_drive,
        steps=source.steps,
        file=source.file,
        sha256=channels.hash(),
        rows=(first + part.start, first + part.stop),
        axes=tuple(axes),
        drive_units=tuple(unscaled(drive.unit) for drive in drives if drive),
        response_units=tuple(unscaled(response.unit) if response else None for response in responses),
        notes=(*_notes(source, grid), *filter(None, map(unit_note, [*drives, *responses]))),
    )
    return replace(record, notes=(*record.notes, *_start(record), *fault_phrases(record)))


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


def _moves(drive: Signal, part: slice) -> bool:
    return bool(np.ptp(drive.cut(part).complete().values))


def _check_not_constant(response: Signal) -> None:
    if np.ptp(response.values) == 0:
        value = response.values[0] / factor(response.unit) + 0.0
        problem = f"the response is constant ({value:g} {response.unit} in all {response.values.size} samples)"
        raise InputError(problem, where=response.where, remedy="is it the right column, and was the sensor connected?")


def _sampled(signals: Sequence[Signal | None], part: slice, source: Source) -> NDArray[np.float64]:
    """(axes, samples), decimated; NaN for a signal that is not measured.

    A record with `run_in` is periodic, and stays so where its length is a multiple of the decimation.
    """
    step = source.decimate
    periodic = source.run_in > 0 and (part.stop - part.start) % step == 0
    missing = np.full(len(range(part.start, part.stop, step)), np.nan)
    cut = [item.cut(part).complete().values if item else None for item in signals]
    return np.array([missing if values is None else decimated(values, step, periodic) for values in cut])


def _rest(
    source: Source, axes: Mapping[str, Axis], drives: Sequence[Signal | None], where: str
) -> tuple[float | None, ...]:
    """The drives at which a record begins at rest, SI units, as of `Record`."""
    levels = source.rest_at or {}
    each = zip(axes, drives, strict=True)
    return tuple(_level(levels.get(axis), drive, where) for axis, drive in each) if levels else ()


def _level(level: Level | None, drive: Signal | None, where: str) -> float | None:
    if level is None or drive is None:
        return None
    if level.unit and not same_kind(level.unit, drive.unit):
        problem = f"rest_at: {level.value:g} {level.unit} cannot be a drive in {drive.unit}"
        raise InputError(problem, where=where, remedy=f"give it in a unit such as {drive.unit}")
    return level.value * factor(level.unit or drive.unit)


def _quiet(drives: NDArray[np.float64]) -> NDArray[np.float64]:
    """Drives without the noise of their recording: (axes, samples)."""
    from pzt_ident.data.drive_noise import without_noise

    return np.array([without_noise(drive) for drive in drives])


def _notes(source: Source, grid: Grid) -> tuple[str, ...]:
    rounded = f"time stamps are rounded to {grid.rounded:g} s: the samples are taken as every {grid.dt:.6g} s"
    thinned = f"decimated by {source.decimate} after a zero-phase low-pass, which rounds the corners of the drive"
    return (*([rounded] if grid.rounded else []), *([thinned] if source.decimate > 1 else []))


def unit_note(signal: Signal | None) -> str:
    """That a signal is taken in another unit than its file says, scales aside; else empty."""
    stated = signal.column.unit if signal else None
    if signal is None or not stated or not is_unit(stated) or factor(stated) == factor(unscaled(signal.unit)):
        return ""
    role = signal.where.rpartition(": ")[2]
    return f"{role} is taken in {signal.unit}, as the job says, where the file says {stated}"


def _start(record: Record) -> list[str]:
    """What the record was at before its first sample, or may have been."""
    if record.run_in:
        times = "once" if record.run_in == 1 else f"{record.run_in} times"
        return [f"the drive is run {times} ahead of the first sample"]
    each = zip(record.axes, record.rest_at, record.drive_units, strict=False)
    levels = [f"{level / factor(unit):g} {unit} on {axis}" for axis, level, unit in each if level is not None]
    if levels:
        return [f"the stage rested at {listed(levels)} until one sample before the first"]
    if moved := start_step(record):
        advice = "if the stage rested at another drive until then, say so, as by `rest_at: 0 V`"
        return [f"{moved}, as after a step; {advice}"]
    return []


def _in_units_of(first: Record, record: Record) -> Record:
    """The record with the units of the first one, so that an axis has one unit throughout."""
    return replace(record, drive_units=first.drive_units, response_units=first.response_units)


def _check_unit_kinds(records: Sequence[Record]) -> None:
    """Raises InputError where the unit of an axis is of another kind than in the first record."""
    for record in records[1:]:
        for units, first in (
            (record.drive_units, records[0].drive_units),
            (record.response_units, records[0].response_units),
        ):
            for axis, unit, unit_of_first in zip(record.axes, units, first, strict=True):
                if unit and unit_of_first and not same_kind(unit, unit_of_first):
                    problem = f"axis {axis} is in {unit}, in the record {records[0].name!r} it is in {unit_of_first}"
                    raise InputError(problem, where=record.file, remedy="identify such records in separate jobs")
