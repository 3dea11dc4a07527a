"""What the commands measured, kept: rows as JSON, and `table.md` of all of them."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from experiments.tables import number, table

Rows = Sequence[Mapping[str, Any]]
OUT = Path("results/reference/fleet")


def keep(name: str, rows: Rows, out: Path) -> str:
    """Write the rows of a command, and the tables of all that were kept before; returns its own table."""
    out.mkdir(parents=True, exist_ok=True)
    (out / f"{name}.json").write_text(json.dumps(rows, indent=1) + "\n", encoding="utf-8")
    kept = {path.stem: json.loads(path.read_text(encoding="utf-8")) for path in sorted(out.glob("*.json"))}
    sections = (f"## {word}\n\n{table_of(found)}" for word, found in kept.items())
    (out / "table.md").write_text("\n\n".join(sections) + "\n", encoding="utf-8")
    return table_of(rows)


def table_of(rows: Rows) -> str:
    header = list(dict.fromkeys(name for row in rows for name in row))
    return table(header, ([cell(row.get(name)) for name in header] for row in rows))


def cell(value: Any) -> str:
    return number(value) if isinstance(value, float) or value is None else str(value)
