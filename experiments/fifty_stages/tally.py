"""Tables of the count: by kind, and a row for each case."""

import math
from collections import Counter

KINDS = ("single", "pair", "none", "outside")


def _quantile(values, share):
    values = sorted(values)
    return values[min(int(share * len(values)), len(values) - 1)] if values else math.nan


def _line(name, rows):
    counts = [f"{sum(bool(row[key]) for row in rows)}/{len(rows)}" for key in ("exact", "in_class")]
    cpu = [row["cpu"] for row in rows]
    verdicts = Counter(row["verdict"] for row in rows).most_common()
    cells = [name, len(rows), *counts, sum(bool(row["extra"]) for row in rows)]
    cells += [f"{_quantile(cpu, 0.5):.0f} / {_quantile(cpu, 0.95):.0f}"]
    cells += [", ".join(f"{count} {verdict}" for verdict, count in verdicts)]
    return _cells(cells)


def _cells(cells):
    return "| " + " | ".join(str(cell).replace("|", "\\|") for cell in cells) + " |"


def _head(*names):
    return [_cells(names), "|" + "---|" * len(names)]


def _case(row):
    truth = row["truth"] or [f"({effect})" for effect in row["outside"]]
    marks = [] if row["exact"] or not row["truth"] else ["in class" if row["in_class"] else "missed"]
    marks += ["wrong: " + " ".join(row["extra"])] * bool(row["extra"])
    sizes = ", ".join(f"{size:.1f}" for size in row["sizes"].values())
    left = "" if row["floors_left"] is None else f"{row['floors_left']:.2f}"
    cells = [row["name"], ", ".join(truth), "; ".join(row["words"]), sizes, row["base"], ", ".join(row["named"])]
    return _cells([*cells, ", ".join(marks), row["verdict"], left, f"{row['cpu']:.0f}"])


def markdown(rows):
    """Both tables."""
    lines = _head("kind", "cases", "exact", "in class", "with a wrong name", "CPU s, median / 95 %", "verdicts")
    lines += [_line(kind, some) for kind in KINDS if (some := [row for row in rows if row["kind"] == kind])]
    lines += ["", *_head(
        "case", "truth", "form", "size in floors", "base", "named", "not exact", "verdict", "floors left", "CPU s"
    )]  # fmt: skip
    return "\n".join([*lines, *map(_case, rows)]) + "\n"
