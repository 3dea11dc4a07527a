"""A stage with one hidden effect follows a reference: by a line, by the inverse of plain Bouc-Wen, and by the inverse
of the model that `pzt-ident improve` made of it."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np
from numpy.typing import NDArray

from experiments.hidden_effect import cases
from experiments.hidden_effect.campaign import Drive
from experiments.hidden_effect.follow import read_drive
from experiments.hidden_effect.solve import run

Array = NDArray[np.float64]
Row = dict[str, Any]

EFFECTS = ("creep", "amplifier_lag", "cross_coupling", "quadratic_gain")
RATE = 2000.0  # Hz
LATER = 9  # the record's number, after all others
WAYS = {"line": "a line", "as_given": "plain Bouc-Wen", "improved": "improved"}


def reference() -> tuple[Array, Array, Array]:
    """Time in s, displacement of x in um and voltage of y in V: steps with holds, then scans of 1, 5 and 20 Hz from
    rest, while y is scanned slowly."""
    levels = [(0, 0), (0.5, 0), (0.7, 6), (2.2, 6), (2.4, 3), (3.9, 3), (4.1, 0), (4.5, 0)]
    start, knots = 4.5, levels
    for frequency, top, cycles in ((1.0, 7.0, 2), (5.0, 4.0, 5), (20.0, 1.5, 10)):
        for half in range(1, 2 * cycles + 1):
            knots = [*knots, (start + half / (2 * frequency), top * (half % 2))]
        start += cycles / frequency
    end = start + 0.5
    time = np.arange(round(end * RATE)) / RATE
    x = np.interp(time, *np.transpose([*knots, (end, 0)]))
    smooth = np.hanning(41) / np.hanning(41).sum()
    x = np.convolve(np.pad(x, 20, "edge"), smooth, "valid")
    return time, x, 40 * (1 - np.cos(2 * np.pi * 0.7 * time)) / 2


def solve(effect: str, seed: int, out: Path, on: str) -> None:
    """Everything of one case, each step once. on: the place where the model is improved."""
    folder = out / f"{effect}-{seed}"
    if (folder / "tracking.json").exists():
        return
    name = f"single-{seed}"
    if not (folder / "sealed" / f"{name}.json").exists():
        cases.write(*cases.draw("single", seed, effect), folder)
    run("improve", folder / "cases" / name / "job.yaml", folder / "solved", retry=False, on=on)
    case = cases.opened(folder / "sealed" / f"{name}.json")
    time, x, u_y = reference()
    np.savetxt(folder / "reference.csv", np.transpose([time, x, u_y]), "%.10g", ",", header=HEADER, comments="")
    drives = {way: drive(folder, way) for way in ("as_given", "improved")}
    slope = np.polyfit(drives["as_given"].u_x, x, 1)[0]
    drives["line"] = Drive("line", "validate", RATE, x / slope, u_y)
    followed = {way: case.response(each, LATER) for way, each in drives.items()}
    improvement = json.loads((folder / "solved" / "improve" / "improvement.json").read_text(encoding="utf-8"))
    floor = json.loads((folder / "sealed" / f"{name}.json").read_text(encoding="utf-8"))["noise_floor"]
    errors = {way: displacement - displacement[0] - x for way, displacement in followed.items()}
    np.savetxt(
        folder / "errors.csv",
        np.transpose([time, x, *(errors[way] for way in WAYS)])[::4],
        "%.6g",
        ",",
        header=",".join(["time [s]", "x [um]", *(f"{way} [um]" for way in WAYS)]),
        comments="",
    )
    facts = {"effect": effect, "seed": seed, "named": improvement["effects"], "noise": floor}
    facts |= {way: {"rmse": float(np.sqrt(np.mean(e**2))), "peak": float(np.abs(e).max())} for way, e in errors.items()}
    (folder / "tracking.json").write_text(json.dumps(facts, indent=1) + "\n", encoding="utf-8")


HEADER = "time [s],x [um],u_y [V]"


def drive(folder: Path, way: str) -> Drive:
    """The drive of x that the command writes, beside that of y."""
    program, out = Path(sys.executable).with_name("pzt-ident"), folder / f"{way}.csv"
    line = [program, "drive", folder / "solved" / "improve", "--reference", folder / "reference.csv", "-o", out]
    subprocess.run([*line, *(["--as-given"] if way == "as_given" else [])], check=True, capture_output=True)
    made = read_drive(out)
    return Drive(way, "validate", RATE, made.u_x, reference()[2])


def rows(out: Path) -> list[Row]:
    rows = [json.loads(path.read_text(encoding="utf-8")) for path in sorted(out.glob("*/tracking.json"))]
    return sorted(rows, key=lambda row: EFFECTS.index(row["effect"]))


def table(rows: Sequence[Mapping[str, Any]]) -> str:
    """Medians over the seeds, the range in parentheses, nm."""
    header = ["hidden effect", "cases", "named", *(f"{way}, RMSE [nm]" for way in WAYS.values()), "won", "noise [nm]"]
    lines = ["| " + " | ".join(header) + " |", "| --- " + "| ---: " * (len(header) - 1) + "|"]
    for effect in dict.fromkeys(row["effect"] for row in rows):
        chosen = [row for row in rows if row["effect"] == effect]
        named = sum(row["named"] == [effect] for row in chosen)
        spreads = [spread([1e3 * row[way]["rmse"] for row in chosen]) for way in WAYS]
        won = spread([row["as_given"]["rmse"] / row["improved"]["rmse"] for row in chosen])
        noise = spread([1e3 * row["noise"] for row in chosen])
        lines.append("| " + " | ".join([effect, str(len(chosen)), str(named), *spreads, f"{won} times", noise]) + " |")
    return "\n".join(lines)


def spread(values: Sequence[float]) -> str:
    return f"{median(values):.3g} ({min(values):.3g} to {max(values):.3g})"
