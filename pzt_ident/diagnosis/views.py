"""The quantities by which the samples of an axis are sorted into bins."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pzt_ident.data.record import Record
from pzt_ident.data.units import factor
from pzt_ident.diagnosis.binning import (
    Array,
    Binning,
    doubling_binning,
    linear_binning,
    logarithmic_binning,
    unordered_binning,
)
from pzt_ident.diagnosis.drive_history import DriveHistory, drive_history

MOVING = ("rising", "falling")
BRANCHES = (*MOVING, "holding")


def binnings(records: Sequence[Record], axis: int) -> list[Binning]:
    """Scored samples by record, by the history of the axis' drive, by position, and by the drives of other axes."""
    histories = drive_histories(records, axis)
    unit = records[0].drive_units[axis]
    position_unit = str(records[0].response_units[axis])
    amplitudes = [history.amplitude / factor(unit) for history in histories]
    rates = [history.rate / factor(unit) for history in histories]
    times = [history.since for history in histories]
    positions = [r.response[axis, r.settle :] / factor(position_unit) for r in records]
    highest_rate, longest_time = max(map(np.max, rates)), max(map(np.max, times))
    shortest_time = max(min(r.dt for r in records), 1e-4 * longest_time)
    places = [np.broadcast_to(number, history.direction.shape) for number, history in enumerate(histories)]
    others = [other for other in range(len(records[0].axes)) if other != axis]
    return [
        unordered_binning("record", [record.name for record in records], places),
        branch_binning("branch", histories),
        linear_binning("amplitude", unit, amplitudes, from_zero=True),
        logarithmic_binning("rate", f"{unit}/s", rates, 1e-3 * highest_rate, "holding"),
        logarithmic_binning("time since reversal", "s", times, shortest_time),
        doubling_binning("cycle", [history.cycle for history in histories]),
        linear_binning("position", position_unit, positions),
        *(binning for other in others for binning in other_drive_binnings(records, other)),
    ]


def other_drive_binnings(records: Sequence[Record], axis: int) -> list[Binning]:
    """Level and branch of another axis' drive, where it moves in any record."""
    name, unit = records[0].axes[axis], records[0].drive_units[axis]
    levels: list[Array] = [record.drive[axis, record.settle :] / factor(unit) for record in records]
    if not max(map(np.max, levels)) > min(map(np.min, levels)):
        return []
    branches = branch_binning(f"branch of {name}", drive_histories(records, axis))
    return [linear_binning(f"drive of {name}", unit, levels), branches]


def branch_binning(name: str, histories: list[DriveHistory]) -> Binning:
    places = (np.where(history.direction == 0, 2, (1 - history.direction) // 2) for history in histories)
    return unordered_binning(name, BRANCHES, places)


def drive_histories(records: Sequence[Record], axis: int) -> list[DriveHistory]:
    """History of an axis' drive over the scored samples of each record."""
    return [drive_history(record.drive[axis], record.dt).scored(record.settle) for record in records]
