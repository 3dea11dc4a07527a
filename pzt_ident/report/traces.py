"""Signals as the page stores them: thinned, quantised to 16 bits and compressed (zlib)."""

from __future__ import annotations

import base64
import zlib
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.notation import unit
from pzt_ident.data.signals import Array, Trace
from pzt_ident.report.decimation import decimate

LEVELS = 65535  # of a 16-bit number


def packed(models: Mapping[str, Sequence[Trace]], points: int | None) -> list[dict[str, Any]]:
    """Every record and axis once, with the residuals of all `models` (traces by name) of these samples.

    `points`: how many samples to keep in all, divided among the records by length; None keeps all.
    """
    groups: list[list[tuple[str, Trace]]] = []
    for name, trace in ((name, trace) for name, traces in models.items() for trace in traces):
        group = next((group for group in groups if _same_samples(group[0][1], trace)), None)
        if group is None:
            groups.append([(name, trace)])
        else:
            group.append((name, trace))
    total = sum(group[0][1].time.size for group in groups)
    shares = [points and max(points * group[0][1].time.size // total, 400) for group in groups]
    return [_record(group[0][1], group, share) for group, share in zip(groups, shares, strict=True)]


def _same_samples(first: Trace, second: Trace) -> bool:
    return (first.record, first.axis, first.unit) == (second.record, second.axis, second.unit) and np.array_equal(
        first.response, second.response
    )


def _record(trace: Trace, models: list[tuple[str, Trace]], points: int | None) -> dict[str, Any]:
    size = trace.time.size
    kept = np.arange(size) if points is None or size <= points else kept_samples(trace, models, points)
    complete = kept.size == size
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
        "kept": None if complete else deflated(np.diff(kept, prepend=0).astype("<u2")),
        "drive": quantised(trace.drive[kept]),
        "response": quantised(trace.response[kept]),
        "models": [
            {
                "name": name,
                "residual": quantised(model.residual[kept]),
                "sizes": None if complete else quantised(grouped_residual(model, kept)),
            }
            for name, model in models
        ],
    }


def kept_samples(trace: Trace, models: list[tuple[str, Trace]], points: int) -> NDArray[np.intp]:
    """Indices of the samples to keep: the extremes of every curve, and at most 60 000 samples between neighbours."""
    curves = [trace.response, trace.drive, *(model.residual for _, model in models)]
    bins = max(points // (2 * len(curves)), 2)
    evenly = np.linspace(0, trace.time.size - 1, max(bins, trace.time.size // 60000 + 2)).astype(int)
    return np.unique(np.concatenate([evenly, *(decimate(values, bins) for values in curves)]))


def grouped_residual(trace: Trace, kept: NDArray[np.intp]) -> Array:
    """Root of the sum of squared scored residuals over each kept sample and the omitted ones before it."""
    squares = np.where(trace.scored & np.isfinite(trace.residual), trace.residual, 0.0) ** 2
    return np.sqrt(np.diff(np.cumsum(squares)[kept], prepend=0.0))


def quantised(values: Array) -> dict[str, Any]:
    finite = np.nan_to_num(values, nan=0.0, posinf=0.0, neginf=0.0)
    low = float(finite.min())
    step = float(np.ptp(finite)) / LEVELS or 1.0
    return {"data": deflated(np.round((finite - low) / step).astype("<u2")), "low": low, "step": step}


def deflated(values: NDArray[Any]) -> str:
    return base64.b64encode(zlib.compress(values.tobytes(), 9)).decode()
