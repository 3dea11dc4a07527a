"""Play the drive that an answer proposes on the sealed stage, and let the tool answer again with its record."""

import csv
import json
import shutil
from pathlib import Path

import numpy as np

from . import cases, jobs
from .campaign import Record, read
from .score import tied
from .solve import solve
from .visibility import Rig


def follow(home, limit, on="", budget=""):
    """The second answer, in home/followed; None where there is no tie or no drive was proposed."""
    home = Path(home)
    improvement = json.loads((home / "solved.json").read_text())["improvement"]
    following = (improvement or {}).get("next_experiment")
    if not improvement or not tied(improvement) or not following:
        return None
    job = home / "followed" / "rig" / "job.yaml"
    if not job.exists():
        kind, _, seed = home.name.rpartition("-")
        case = cases.draw(kind, int(seed))
        record = proposed(case, home / "answer" / following["file"])
        shutil.copytree(home / "rig", job.parent, dirs_exist_ok=True)
        last = len(case["records"])
        jobs.write_record(job.parent, case, last, record, play(case, record))
        added = f"records:\n{jobs.record_line(case, last, record)}\n"
        job.write_text(job.read_text().replace("records:\n", added, 1))
    return solve(home / "followed", limit, on, budget)


def proposed(case, path):
    """The record of a drive in a CSV with `time [s]`, `u_x [V]` and `u_y [V]`; an axis without a column rests."""
    with open(path, newline="") as file:
        rows = list(csv.reader(line for line in file if not line.startswith("#")))
    columns = dict(zip((name.strip() for name in rows[0]), np.array(rows[1:], float).T, strict=True))
    time = columns["time [s]"]
    rate = (len(time) - 1) / (time[-1] - time[0])
    still = np.zeros(len(time))
    drives = {axis: columns.get(f"u_{axis} [V]", still) for axis in case["axes"]}
    return Record("proposed", "identify", float(f"{rate:.9g}"), drives)


def play(case, record):
    """Noisy readings of the sealed stage, {axis: reading}; the record comes after all others."""
    number = len(case["records"])
    clean = Rig(case).settled_reading(number, record)
    rng = np.random.default_rng([case["noise_seed"], number])
    return {axis: read(clean[axis], rng, case["sensor"]) for axis in ["x"] + ["y"] * case["y_measured"]}
