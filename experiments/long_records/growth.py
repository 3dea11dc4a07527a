"""Cost and memory against samples, records, axes and parameters: each point in a process of its own."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from pzt_ident.files import write_text

Json = dict[str, Any]
STEPS = {"search": "search", "polish": "polish", "errors": "standard errors"}
LENGTHS = (100_000, 300_000, 1_000_000, 3_000_000, 10_000_000)
COLOURS = ("#0072B2", "#D55E00", "#009E73")


def cases(most: int) -> dict[str, list[tuple[int, int, int, int]]]:
    """(samples of all records, records, axes, free parameters or 0 for a free density)"""
    return {
        "samples": [(count, 1, 1, 7) for count in LENGTHS if count <= most],
        "records": [(100_000, count, 1, 7) for count in (1, 10, 50)],
        "axes": [(30_000, 1, count, 7 * count) for count in (1, 2, 3)],
        "parameters": [(30_000, 1, 3, count) for count in (2, 7, 14, 21)],
        "samples, with a free density": [
            (count, 1, 1, 0) for count in (10_000, 100_000, 300_000, 1_000_000) if count <= most
        ],
    }


def measure(samples: int, records: int, axes: int, free: int) -> Json:
    """What `measure.py` says of one of them."""
    tool = [sys.executable, "-m", "experiments.long_records.measure"]
    with TemporaryDirectory() as folder:
        subprocess.run([*tool, "write", folder, str(samples), str(records), str(axes)], check=True)
        run = [*tool, "run", folder, str(records), str(axes), str(free)]
        return json.loads(subprocess.run(run, check=True, capture_output=True, text=True).stdout)


def measure_all(out: Path, most: int) -> str:
    """Write the tables and the picture into a folder; returns the tables. Goes on where it was stopped."""
    path = out / "growth.json"
    known = json.loads(path.read_text()) if path.exists() else {}
    found: dict[str, list[tuple[int, Json]]] = {}
    for place, (what, numbers) in enumerate(cases(most).items()):
        for case in numbers:
            word = " ".join(map(str, case))
            if word not in known:
                known[word] = measure(*case)
                write_text(path, json.dumps(known, indent=1))
            found.setdefault(what, []).append((case[place % len(case)], known[word]))
    text = "\n\n".join(table(what, rows) for what, rows in found.items()) + "\n"
    write_text(out / "tables.md", text)
    draw(found, out)
    return text


def table(what: str, rows: list[tuple[int, Json]]) -> str:
    candidates = rows[0][1].get("candidates", 3500)
    spent = [f"{word} [s CPU]" for word in (f"{candidates:,} candidates", "polish", "standard errors")]
    head = [what, *spent, "steps of the polish", "peak memory [MiB]", "RMSE [nm]"]
    lines = [f"| {' | '.join(head)} |", f"|{'---|' * len(head)}"]
    for size, row in rows:
        numbers = [f"{row[step]:.3g}" for step in STEPS]
        cells = [f"{size:,}", *numbers, str(row["steps"]), f"{row['peak']:.0f}", f"{1e9 * row['rmse']:.4f}"]
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def draw(found: dict[str, list[tuple[int, Json]]], out: Path) -> None:
    """CPU of each part and the peak memory, against what grows."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    from matplotlib.ticker import LogFormatterMathtext, NullFormatter, ScalarFormatter

    fig, panels = plt.subplots(2, len(found), figsize=(180 / 25.4, 95 / 25.4), layout="constrained", sharey="row")
    for (what, rows), (above, below) in zip(found.items(), panels.T, strict=True):
        sizes = [size for size, _ in rows]
        for (step, label), colour in zip(STEPS.items(), COLOURS, strict=True):
            polish = step == "polish"
            spent = [row[step] / (max(row["steps"], 1) if polish else 1) for _, row in rows]
            above.plot(sizes, spent, "o-", ms=3, lw=1, color=colour, label=label + ", a step" * polish)
        below.plot(sizes, [row["peak"] for _, row in rows], "o-", ms=3, lw=1, color="black")
        for panel in (above, below):
            panel.set(xscale="log", yscale="log")
            panel.grid(alpha=0.25, lw=0.5)
            panel.tick_params(which="both", labelsize=7)
            few = len(sizes) < 5 and max(sizes) < 100
            panel.set_xticks(sizes if few else [10 ** round(np.log10(size)) for size in (sizes[0], sizes[-1])])
            panel.xaxis.set_major_formatter(ScalarFormatter() if few else LogFormatterMathtext())
            panel.xaxis.set_minor_formatter(NullFormatter())
        below.set_xlabel(what.replace(", ", ",\n"), fontsize=8, va="top")
    panels[0, 0].set_ylabel("CPU (s)", fontsize=8)
    panels[1, 0].set_ylabel("peak memory (MiB)", fontsize=8)
    panels[1, 0].set_yticks([200, 500, 1000], ["200", "500", "1000"])
    panels[1, 0].yaxis.set_minor_formatter(NullFormatter())
    fig.legend(
        *panels[0, 0].get_legend_handles_labels(), loc="outside upper center", ncols=3, fontsize=7, frameon=False
    )
    for kind in ("svg", "png"):
        fig.savefig(out / f"growth.{kind}", dpi=200)
