"""Signals as the page holds them: 16 bit numbers, deflated, and so many points of a long record as a page can carry."""

from __future__ import annotations

import base64
import zlib
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.notation import unit
from pzt_ident.data.signals import Array, Trace
from pzt_ident.report.style import decimate

LEVELS = 65535


def packed(models: Mapping[str, Sequence[Trace]], points: int | None) -> list[dict[str, Any]]:
    """Every record and axis once, with the residual of each model (name: its traces) that has these samples.

    `points` are shared out by length, None keeps every sample.
    """
    groups: list[list[tuple[str, Trace]]] = []
    for name, trace in ((name, trace) for name, traces in models.items() for trace in traces):
        mates = next((group for group in groups if _same(group[0][1], trace)), None)
        if mates is None:
            groups.append([(name, trace)])
        else:
            mates.append((name, trace))
    total = sum(group[0][1].time.size for group in groups)
    shares = [points and max(points * group[0][1].time.size // total, 400) for group in groups]
    return [_record(group[0][1], group, share) for group, share in zip(groups, shares, strict=True)]


def _same(one: Trace, other: Trace) -> bool:
    return (one.record, one.axis, one.unit) == (other.record, other.axis, other.unit) and np.array_equal(
        one.response, other.response
    )


def _record(trace: Trace, models: list[tuple[str, Trace]], points: int | None) -> dict[str, Any]:
    size = trace.time.size
    kept = np.arange(size) if points is None or size <= points else shown(trace, models, points)
    whole = kept.size == size
    return {
        "name": trace.record,
        "use": trace.use,
        "axis": trace.axis,
        "unit": unit(trace.unit),
        "driveUnit": unit(trace.drive_unit),
        "start": float(trace.time[0]),
        "dt": float((trace.time[-1] - trace.time[0]) / (size - 1)),
        "samples": size,
        "settle": int(np.count_nonzero(~trace.scored)),
        "kept": None if whole else deflated(np.diff(kept, prepend=0).astype("<u2")),
        "drive": quantised(trace.drive[kept]),
        "response": quantised(trace.response[kept]),
        "models": [
            {
                "name": name,
                "residual": quantised(own.residual[kept]),
                "sizes": None if whole else quantised(left_out(own, kept)),
            }
            for name, own in models
        ],
    }


def shown(trace: Trace, models: list[tuple[str, Trace]], points: int) -> NDArray[np.intp]:
    """Indices of the points that are kept: the extremes of every curve, and none too far from the next."""
    curves = [trace.response, trace.drive, *(own.residual for _, own in models)]
    bins = max(points // (2 * len(curves)), 2)
    even = np.linspace(0, trace.time.size - 1, max(bins, trace.time.size // 60000 + 2)).astype(int)
    return np.unique(np.concatenate([even, *(decimate(values, bins) for values in curves)]))


def left_out(trace: Trace, kept: NDArray[np.intp]) -> Array:
    """Root of the squared scored residuals of each kept point and of the samples left out before it, summed."""
    own = np.where(trace.scored & np.isfinite(trace.residual), trace.residual, 0.0) ** 2
    return np.sqrt(np.diff(np.cumsum(own)[kept], prepend=0.0))


def quantised(values: Array) -> dict[str, Any]:
    known = np.nan_to_num(values, nan=0.0, posinf=0.0, neginf=0.0)
    low = float(known.min())
    step = float(np.ptp(known)) / LEVELS or 1.0
    return {"data": deflated(np.round((known - low) / step).astype("<u2")), "low": low, "step": step}


def deflated(values: NDArray[Any]) -> str:
    return base64.b64encode(zlib.compress(values.tobytes(), 9)).decode()
