"""What a folder of results says, less the clock: two of them are the same where this is, bit for bit."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

CLOCK = ("seconds", "cpu", "created", "command", "digest", "written", "history.csv", "environment.json")
STATEMENTS = ("result.json", "improvement.json", "diagnosis.json", "device.json", "residuals.json")


def essence(folder: Path) -> dict[str, Any]:
    """By the path of each file of results in the folder: JSON, signals, and the table of a fleet as text."""
    readers = dict.fromkeys(STATEMENTS, statement) | {"signals.nc": arrays, "devices.csv": table}
    files = sorted(path for path in folder.rglob("*") if path.name in readers)
    return {str(path.relative_to(folder)): readers[path.name](path) for path in files}


def differences(true: dict[str, Any], other: dict[str, Any]) -> list[str]:
    return [f"{file} differs" for file in sorted({*true, *other}) if true.get(file) != other.get(file)]


def statement(path: Path) -> Any:
    return timeless(json.loads(path.read_text(encoding="utf-8")))


def table(path: Path) -> Any:
    with path.open(encoding="utf-8", newline="") as file:
        return timeless(list(csv.DictReader(file)))


def timeless(content: Any) -> Any:
    if isinstance(content, dict):
        return {key: timeless(value) for key, value in content.items() if not any(c in key for c in CLOCK)}
    return [timeless(value) for value in content] if isinstance(content, list) else content


def arrays(path: Path) -> dict[str, bytes]:
    import h5py

    values: dict[str, bytes] = {}
    with h5py.File(path) as file:
        file.visititems(lambda name, item: values.update({name: item[()].tobytes()} if hasattr(item, "shape") else {}))
    return values
