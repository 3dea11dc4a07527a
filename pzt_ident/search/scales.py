"""Units, bounds and typical sizes of parameters, declared in those of the data."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.notation import counted
from pzt_ident.data.record import Record, drive_correlation
from pzt_ident.data.units import factor
from pzt_ident.errors import InputError
from pzt_ident.model.block import Place
from pzt_ident.model.chain import Chain, Entry

Array = NDArray[np.float64]

CLEAR = 0.5  # correlation of drive and response above which the gain is taken as positive


def unit_of(model: Chain, entry: Entry, record: Record) -> str:
    """Unit of a parameter as the user writes it: that of the declaration with the units of the record."""
    first = record.response_units[model.measured[0]]
    response = record.response_units[entry.axis] or first
    units = {"drive": str(record.drive_units[entry.axis]), "response": str(response), "first": str(first)}
    divisors = {f"/{word}": f"/{unit}" if unit.isalpha() else f"/({unit})" for word, unit in units.items()}
    return re.sub(r"/?(drive|response|first)", lambda match: (units | divisors)[match[0]], entry.parameter.unit)


def bounds_of(model: Chain, entry: Entry, records: Sequence[Record]) -> Array:
    """Declared bounds in SI units; those of a gain, or of what an operator puts out at most, include the other sign,
    unless the response clearly rises with the drive: an inverting amplifier reverses the sign, and so does a drive
    above the resonance."""
    low, high = entry.parameter.bounds
    puts_out = entry.parameter.unit == "response" and entry.block.place == Place.OPERATOR
    turns = entry.parameter.unit == "response/drive" or puts_out
    if turns and drive_correlation(list(records), entry.axis) <= CLEAR:
        low, high = min(low, -high), max(high, -low)
    return np.array([low, high]) * size_of(model, entry, records)


def size_of(model: Chain, entry: Entry, records: Sequence[Record]) -> float:
    """The quantity in SI units that declared bounds are multiples of: spans of the data if the unit names them.

    Raises InputError where the unit names a drive that is constant.
    """
    spans = {
        "drive": max(record.spans[entry.axis] for record in records),
        "response": max(record.swings[entry.axis] for record in records),
        "first": max(record.swings[model.measured[0]] for record in records),
    }
    named = re.findall(r"drive|response|first", entry.parameter.unit)
    if not named:
        return factor(entry.parameter.unit)
    if "drive" in named and spans["drive"] == 0:
        samples = counted(sum(record.samples for record in records), "sample")
        axis = model.axes[entry.axis]
        message = f"the drive of axis {axis} is constant over all {samples}: nothing to scale {entry.name} by"
        remedy = "is it the right column? Otherwise give the parameter `bounds` or a `value`"
        raise InputError(message, where=records[0].file or records[0].name, remedy=remedy)
    size = 1.0
    for operation, token, power in re.findall(r"([*/]?)([\w.]+)(?:\^(\d+))?", entry.parameter.unit):
        base = spans[token] if token in spans else factor(token)
        size *= base ** ((-1 if operation == "/" else 1) * int(power or 1))
    return size
