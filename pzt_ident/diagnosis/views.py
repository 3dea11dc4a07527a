"""The ways in which the samples of an axis can be told apart."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pzt_ident.data.record import Record
from pzt_ident.data.units import factor
from pzt_ident.diagnosis.binning import Array, Binning, doubling, linear, logarithmic, named
from pzt_ident.diagnosis.drive_history import DriveHistory, drive_history

MOVING = ("rising", "falling")
WAYS = (*MOVING, "holding")


def binnings(records: Sequence[Record], axis: int) -> list[Binning]:
    """Scored samples by record, by the motion of the own drive, by position, and by the drives of the other axes."""
    own = drive_histories(records, axis)
    unit = records[0].drive_units[axis]
    position = str(records[0].response_units[axis])
    rates = [found.rate / factor(unit) for found in own]
    fastest, latest = max(map(np.max, rates)), max(np.max(found.since) for found in own)
    sizes = [np.full(found.way.size, place) for place, found in enumerate(own)]
    return [
        named("record", [record.name for record in records], sizes),
        by_way("branch", own),
        linear("amplitude", unit, [found.amplitude / factor(unit) for found in own], zero=True),
        logarithmic("rate", f"{unit}/s", rates, 1e-3 * fastest, WAYS[2]),
        logarithmic(
            "time since reversal", "s", [found.since for found in own], max(min(r.dt for r in records), 1e-4 * latest)
        ),
        doubling("cycle", [found.cycle for found in own]),
        linear("position", position, [r.response[axis, r.settle :] / factor(position) for r in records]),
        *(view for other in range(len(records[0].axes)) if other != axis for view in by_other(records, other)),
    ]


def by_other(records: Sequence[Record], axis: int) -> list[Binning]:
    """Level and way of another axis' drive, where it moves in any record."""
    name, unit = records[0].axes[axis], records[0].drive_units[axis]
    levels: list[Array] = [record.drive[axis, record.settle :] / factor(unit) for record in records]
    if not max(map(np.max, levels)) > min(map(np.min, levels)):
        return []
    return [linear(f"drive of {name}", unit, levels), by_way(f"branch of {name}", drive_histories(records, axis))]


def by_way(name: str, drive_histories: list[DriveHistory]) -> Binning:
    return named(name, WAYS, [np.where(found.way == 0, 2, (1 - found.way) // 2) for found in drive_histories])


def drive_histories(records: Sequence[Record], axis: int) -> list[DriveHistory]:
    """Motion of an axis' drive in the scored samples of each record."""
    return [drive_history(record.drive[axis], record.dt).behind(record.settle) for record in records]
