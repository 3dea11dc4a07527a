"""Run the drive that a diagnosis proposes on the sealed stage, and solve the case again with its record."""

from __future__ import annotations

import csv
import json
import shutil
from pathlib import Path

import numpy as np

from experiments.hidden_effect.campaign import Drive
from experiments.hidden_effect.cases import opened, write_record
from experiments.hidden_effect.solve import run

LATER = 7  # the record's number, after all others


def follow(folder: Path, name: str, on: str = "") -> Path | None:
    """The folder of the second solution, found at the place `on`; None where no drive was proposed."""
    proposed = _proposed(folder / "solved" / name / "diagnose")
    if proposed is None:
        return None
    job = folder / "followed" / name
    if not (job / "job.yaml").exists():
        case, drive = opened(folder / "sealed" / f"{name}.json"), read_drive(proposed)
        shutil.copytree(folder / "cases" / name, job, dirs_exist_ok=True)
        x = case.response(drive, LATER)
        write_record(job / "proposed.csv", drive, case.sensor.read(x, drive.rate, LATER))
        text = (job / "job.yaml").read_text(encoding="utf-8")
        more = "records:\n  - {file: proposed.csv, use: identify}\n"
        (job / "job.yaml").write_text(text.replace("records:\n", more, 1), encoding="utf-8")
    solved = folder / "followed" / name / "solved"
    run("improve", job / "job.yaml", solved, retry=False, on=on)
    return solved


def _proposed(diagnosed: Path) -> Path | None:
    path = diagnosed / "diagnosis.json"
    found = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
    following = found.get("next_experiment")
    return diagnosed / following["file"] if following and following.get("file") else None


def read_drive(path: Path) -> Drive:
    """A drive from a CSV with a time column and one or both voltages, `u_x [V]` and `u_y [V]`."""
    with path.open(encoding="utf-8", newline="") as file:
        rows = csv.reader(line for line in file if not line.startswith("#"))
        header = [cell.strip() for cell in next(rows)]
        values = np.array([[float(cell) for cell in row] for row in rows if row]).T
    columns = dict(zip(header, values, strict=True))
    time, u_x = columns["time [s]"], columns["u_x [V]"]
    rate = (len(time) - 1) / (time[-1] - time[0])
    return Drive("proposed", "identify", float(rate), u_x, columns.get("u_y [V]", np.zeros(len(u_x))))
