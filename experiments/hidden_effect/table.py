"""`python -m experiments.hidden_effect.table FOLDER` prints the table of a folder that `score` wrote."""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from experiments.tables import table

COUNTS = ("false_alarms", "missed")
SHARES = ("exact", "inside", "adequate", "unexplained")


def text(rows: list[Mapping[str, Any]]) -> str:
    header = (
        "kind",
        "cases",
        "exactly right",
        "inside the class",
        "wrong effects",
        "missed",
        "adequate",
        "unexplained",
        "validate RMSE, floors: median / 90 %",
        "proposed drives that separate",
        "s a case, median",
    )
    return table(header, [_row(row) for row in rows])


def _row(row: Mapping[str, Any]) -> tuple[object, ...]:
    exact, inside, adequate, unexplained = (f"{100 * row[key]:.0f} %" for key in SHARES)
    floors = f"{row['validate_median']:.2f} / {row['validate_90']:.2f}" if row["validate_median"] else ""
    seconds = f"{row['seconds_median']:.0f}" if row["seconds_median"] else ""
    counts = [row[key] for key in COUNTS]
    separated, proposed = (round(row[key] * row["cases"]) for key in ("separated", "proposed"))
    drives = f"{separated} of {proposed}" if proposed else ""
    return row["kind"], row["cases"], exact, inside, *counts, adequate, unexplained, floors, drives, seconds


if __name__ == "__main__":
    print(text(json.loads((Path(sys.argv[1]) / "score.json").read_text(encoding="utf-8"))["kinds"]))
