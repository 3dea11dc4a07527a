"""How each device was measured, and which of them unlike the others: in another unit, or by another recorder."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from pzt_ident.data.notation import quantity
from pzt_ident.data.record import Record
from pzt_ident.data.units import factor
from pzt_ident.lot.statistics import FEWEST

Facts = dict[str, Any]

TENFOLD = 10.0  # times what is usual, or as much less: no lot is spread so far


def measured(records: Sequence[Record]) -> list[Facts]:
    """What was measured of a device: sample rate, time, and the largest ranges of drive and response of each axis, each
    with its unit; values in SI units."""
    first = records[0]
    facts: list[Facts] = [
        {"what": "sample rate", "value": 1 / first.dt, "unit": "Hz"},
        {"what": "time measured", "value": sum(record.samples * record.dt for record in records), "unit": "s"},
    ]
    for axis, name in enumerate(first.axes):
        for channel in ("drive", "response"):
            unit = getattr(first, f"{channel}_units")[axis]
            if unit is not None:
                span = max(float(np.ptp(getattr(record, channel)[axis])) for record in records)
                facts.append({"what": f"range of the {channel} of {name}", "value": span, "unit": unit})
    return facts


def unlike_others(devices: dict[str, list[Facts]]) -> dict[str, list[str]]:
    """What is TENFOLD more or less than usual of each device of which anything is, where there are FEWEST at least."""
    values: dict[str, list[float]] = {}
    for facts in devices.values():
        for fact in facts:
            values.setdefault(fact["what"], []).append(fact["value"])
    usual = {what: float(np.median(sizes)) for what, sizes in values.items() if len(sizes) >= FEWEST}
    phrases = {
        device: [phrase(fact, usual[fact["what"]]) for fact in facts if is_far(fact, usual.get(fact["what"]))]
        for device, facts in devices.items()
    }
    return {device: far for device, far in phrases.items() if far}


def is_far(fact: Facts, usual: float | None) -> bool:
    return bool(usual) and not 1 / TENFOLD < fact["value"] / usual < TENFOLD


def phrase(fact: Facts, usual: float) -> str:
    unit = fact["unit"]
    size, median = (quantity(value / factor(unit), unit) for value in (fact["value"], usual))
    return f"{fact['what']} {size}, usually {median}"
