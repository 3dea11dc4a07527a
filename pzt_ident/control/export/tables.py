"""The identified model as tables and as JSON."""

from __future__ import annotations

import csv
import io
import json
from typing import Any

import numpy as np

from pzt_ident.control.identified import Identified
from pzt_ident.files import plain

FORMAT = "pzt-ident model 1"


def csv_files(identified: Identified) -> dict[str, str]:
    """A table of the parameters and one of a response, by name of file."""
    word, names = identified.word, identified.chain.axes
    head = ["parameter", "value", "unit", "standard error", "value in SI units", "meaning"]
    rows: list[list[Any]] = [
        [entry.name, identified.value(i), identified.units[i], identified.errors[i], float(value), entry.parameter.doc]
        for i, (entry, value) in enumerate(zip(identified.chain.entries, identified.theta, strict=True))
    ]
    drive, response = identified.test_vector
    time = identified.dt * np.arange(drive.shape[1])
    signals = ["time [s]", *(f"u_{axis} [{unit}]" for axis, unit in zip(names, identified.drive_units, strict=True))]
    signals += [f"{names[axis]} [{identified.response_units[axis]}]" for axis in identified.outputs]
    loop = np.vstack([time, drive, response]).T.tolist()
    return {f"{word}_parameters.csv": table(head, rows), f"{word}_response.csv": table(signals, loop)}


def table(head: list[str], rows: list[list[Any]]) -> str:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(head)
    writer.writerows([["" if item is None else item for item in row] for row in rows])
    return text.getvalue()


def json_files(identified: Identified) -> dict[str, str]:
    """All that makes the model again: `pzt_ident.load` reads it."""
    axes = zip(identified.chain.axes, identified.drive_units, identified.response_units, strict=True)
    content = {
        "format": FORMAT,
        "name": identified.name,
        "origin": identified.origin,
        **identified.words,
        "axes": {axis: {"drive": drive, "response": response} for axis, drive, response in axes},
        "sample_time": {"value": identified.dt, "unit": "s"},
        "range": {axis: list(ends) for axis, ends in zip(identified.chain.axes, identified.ends, strict=True)},
        "frequency": dict(zip(identified.chain.axes, identified.frequencies, strict=True)),
        "limits": {"drive": identified.limits[0], "slew": identified.limits[1]},
        "parameters": {
            entry.name: {
                "value": identified.value(i),
                "unit": identified.units[i],
                "standard_error": identified.errors[i],
                "meaning": entry.parameter.doc,
            }
            for i, entry in enumerate(identified.chain.entries)
        },
    }
    return {f"{identified.word}.json": json.dumps(plain(content), indent=2, allow_nan=False) + "\n"}
