"""A measurement before there is a job: its signals to be drawn, and what can be guessed from them."""

from __future__ import annotations

import base64
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.faults import fault_phrases
from pzt_ident.data.noise import noise_floor
from pzt_ident.data.notation import unit as printed_unit
from pzt_ident.data.record import Record
from pzt_ident.data.stretches import rests
from pzt_ident.data.units import factor
from pzt_ident.errors import InputError
from pzt_ident.report.decimation import decimate
from pzt_ident.workbench.columns import columns_of, hertz, values_of
from pzt_ident.workbench.wording import in_page_words

Array = NDArray[np.float64]
Files = Sequence[tuple[Path, str | None]]
Roles = Mapping[str, Mapping[str, Any]]


class Clock(NamedTuple):
    """The first time stamp and the sample time, s."""

    start: float
    dt: float


WHOLE = 20_000  # samples of a channel that are sent as they are; of a longer one its extremes
SHORTEST_REST = 0.02  # of a record
PERIODS = 1.5  # of a drive, from which on it has a frequency
SHORTEST = 8  # samples


def measured(records: Sequence[Files], columns: Roles | None = None) -> dict[str, Any]:
    """The channels of each record, and the guess. columns: by role (`time`, `x.drive`, `x.response`), each with its
    `number` and, among several files, `of`, and its `unit`; as guessed from all records unless given."""
    facts_of_records = [columns_of(*files) for files in records]
    roles = dict(columns) if columns else guessed(facts_of_records)
    signals = [signals_of(files, facts, roles) for files, facts in zip(records, facts_of_records, strict=True)]
    return {
        "records": [sent(name, channels, clock) for name, channels, clock, _ in signals],
        "guess": guess_of([record for *_, record in signals], roles),
    }


def guessed(facts_of_records: Sequence[dict[str, Any]]) -> dict[str, dict[str, Any]]:
    """The columns by role: those of the record in which most roles are found, since a signal may rest in one."""
    by_record = [
        {column["role"]: column for column in facts["columns"] if column["role"]} for facts in facts_of_records
    ]
    return max(by_record, key=len)


def signals_of(files: Files, facts: dict[str, Any], roles: Roles) -> tuple[str, dict[str, Array], Clock, Record | None]:
    """Name, channels by role in the user's units, their times, and the record that they make in SI units, if they make
    one."""
    columns = values_of(*files)
    channels = {
        role: columns[int(column.get("of", 0)), int(column["number"])]
        for role, column in roles.items()
        if (int(column.get("of", 0)), int(column["number"])) in columns
    }
    name = files[0][0].stem + (f" {files[0][1]}" if files[0][1] else "")
    clock = clock_of(channels.get("time"), roles.get("time", {}).get("unit") or "s", facts["rate"])
    return name, channels, clock, record_of(name, channels, roles, clock)


def clock_of(time: Array | None, unit: str, rate: str) -> Clock:
    """Of a column of time or a sample rate; sample times of 1 s where neither is there."""
    if time is None:
        return Clock(0.0, 1 / hertz(rate) if rate else 1.0)
    scale, span = scale_of(unit, "time"), float(np.nanmax(time) - np.nanmin(time)) / max(1, time.size - 1)
    return Clock(float(bridged(time)[0]) * scale, span * scale or 1.0)


def scale_of(unit: str, signal: str) -> float:
    """The factor of a unit. Raises InputError that names the signal."""
    try:
        return factor(unit)
    except InputError as error:
        raise InputError(error.message, where=f"unit of the {signal}", remedy=error.remedy) from None


def record_of(name: str, channels: dict[str, Array], roles: Roles, clock: Clock) -> Record | None:
    """The record of channels, gaps bridged by lines; None without a drive, or with hardly any samples."""
    axes = [role.partition(".")[0] for role in channels if role.endswith(".drive")]
    samples = next((values.size for values in channels.values()), 0)
    if not axes or samples < SHORTEST:
        return None
    units = {role: roles[role].get("unit") or ("um" if role.endswith("response") else "V") for role in channels}
    unmeasured = np.full(samples, np.nan)

    def rows(side: str) -> Array:
        names = {f"{axis}.{side}": f"{side} of {axis}" for axis in axes}
        scales = {n: scale_of(units[n], said) for n, said in names.items() if n in channels}
        return np.array([bridged(channels[n]) * scales[n] if n in channels else unmeasured for n in names])

    return Record(
        name,
        "identify",
        clock.dt,
        rows("drive"),
        rows("response"),
        start=clock.start,
        axes=tuple(axes),
        drive_units=tuple(units[f"{axis}.drive"] for axis in axes),
        response_units=tuple(units.get(f"{axis}.response") for axis in axes),
    )


def bridged(values: Array) -> Array:
    """A signal with its missing values on lines between their neighbours."""
    finite = np.isfinite(values)
    samples = np.arange(values.size)
    return values if finite.all() else np.interp(samples, samples[finite], values[finite])


def sent(name: str, channels: dict[str, Array], clock: Clock) -> dict[str, Any]:
    """Channels as 32-bit floats: `positions` are the samples that were kept, None where all were."""
    samples = max((values.size for values in channels.values()), default=0)
    positions = None
    if samples > WHOLE:
        curves = [values for role, values in channels.items() if role != "time"]
        positions = np.unique(
            np.concatenate([decimate(values, WHOLE // (2 * max(1, len(curves)))) for values in curves])
        )
    return {
        "name": name,
        "t0": clock.start,
        "dt": clock.dt,
        "samples": samples,
        "positions": None if positions is None else encoded(positions.astype("<i4")),
        "channels": {
            role: {"data": encoded((values if positions is None else values[positions]).astype("<f4"))}
            for role, values in channels.items()
        },
    }


def encoded(values: NDArray[Any]) -> str:
    return base64.b64encode(values.tobytes()).decode()


def guess_of(records: Sequence[Record | None], roles: Roles) -> dict[str, Any]:
    """What the page says of the measurement at the drop: by axis the largest amplitude and frequency of the drive and
    the noise floor; of each record its rests, and what looks wrong with its readings."""
    complete = [record for record in records if record is not None]
    columns = {
        role: {key: column.get(key) for key in ("number", "of", "name", "unit")} for role, column in roles.items()
    }
    guess: dict[str, Any] = {"columns": columns, "rate": 1 / complete[0].dt if complete else None}
    guess["rests"] = [long_rests(record) if record else [] for record in records]
    axes = list(enumerate(complete[0].axes)) if complete and len({record.axes for record in complete}) == 1 else []
    guess["amplitude"] = {axis: amplitude_of(complete, number) for number, axis in axes}
    guess["frequency"] = {axis: max(main_frequency(r.drive[number], r.dt) for r in complete) for number, axis in axes}
    measured_axes = [(number, axis) for number, axis in axes if number in complete[0].measured]
    guess["noise_floor"] = {axis: floor_of(complete, number) for number, axis in measured_axes}
    guess["faults"] = [
        {"record": r.name, "said": in_page_words(phrase)} for r in complete for phrase in fault_phrases(r)
    ]
    return guess


def main_frequency(drive: Array, dt: float) -> float:
    """The strongest line of a drive, Hz; 0 where it goes through fewer than one and a half of its periods."""
    size = 1 << (2 * drive.size).bit_length()
    lines = np.abs(np.fft.rfft((drive - drive.mean()) * np.hanning(drive.size), size))
    strongest = float(np.argmax(lines)) / (size * dt)
    return strongest if strongest * drive.size * dt >= PERIODS else 0.0


def amplitude_of(records: Sequence[Record], axis: int) -> dict[str, Any]:
    """The largest span of a drive."""
    unit = records[0].drive_units[axis]
    span = max(record.spans[axis] for record in records)
    return {"value": span / factor(unit), "unit": printed_unit(unit)}


def floor_of(records: Sequence[Record], axis: int) -> dict[str, Any]:
    unit, floor = str(records[0].response_units[axis]), noise_floor(list(records), axis)
    return {"value": floor.value / factor(unit), "unit": printed_unit(unit), "source": floor.source}


def long_rests(record: Record) -> list[list[float]]:
    """Begin and end of the intervals in which no drive moves, s, the longer ones."""
    long = [part for part in rests(record.drive) if part[1] - part[0] >= SHORTEST_REST * record.samples]
    return [[record.start + first * record.dt, record.start + last * record.dt] for first, last in long]
