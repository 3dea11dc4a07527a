"""What `pzt-ident run` takes for one long record, from the file to the figures."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import psutil

from experiments.long_records.measure import GENERATIONS, POPULATION
from experiments.long_records.stage import BOUNDS, RATE, write

BETWEEN = 0.25  # s between two looks at the memory
JOB = """\
name: long
records:
  - {{file: {file}, use: identify}}
channels:
  time: "time [s]"
  axes:
    x: {{drive: "u [V]", response: "x [um]"}}
model: [bouc_wen, lumped]
parameters:
{parameters}
optimizers:
  - {{name: pso, population: {population}, generations: {generations}}}
seed: 1
"""
FORMS = ("npy", "csv")


def prepare(folder: Path, samples: int, form: str) -> Path:
    """The measurement of a virtual stage as one file, and the job; returns the job."""
    folder.mkdir(parents=True, exist_ok=True)
    job, file = folder / "job.yaml", folder / f"loops.{form}"
    if not job.exists():
        write(folder, samples, 1, 1)
        u, y = (np.load(folder / f"{name}0.npy", mmap_mode="r")[0] for name in "uy")
        columns = {"time [s]": np.arange(samples) / RATE, "u [V]": u, "x [um]": 1e6 * y}
        if form == "npy":
            table = np.empty(samples, [(name, float) for name in columns])
            for name, values in columns.items():
                table[name] = values
            np.save(file, table)
        else:
            rows = np.column_stack(list(columns.values()))
            np.savetxt(file, rows, "%.3f,%.6g,%.8g", header=",".join(columns), comments="")
        for name in "uy":
            (folder / f"{name}0.npy").unlink()
        parameters = "\n".join(f"  {name}: {{bounds: [{low}, {high}]}}" for name, (low, high) in BOUNDS.items())
        facts = {"file": file.name, "population": POPULATION, "generations": GENERATIONS, "parameters": parameters}
        job.write_text(JOB.format(**facts))
    return job


def measured(folder: Path, samples: int, form: str) -> str:
    """Wall and CPU seconds of the command, and the most memory that its processes had together, in a sentence."""
    job, out = prepare(folder, samples, form), folder / "out"
    shutil.rmtree(out, ignore_errors=True)
    line = [sys.executable, "-m", "pzt_ident", "run", str(job), "--out", str(out), "--json"]
    start, peak, cpu = time.perf_counter(), 0.0, dict[int, float]()
    command = psutil.Popen(line, stdout=subprocess.DEVNULL)
    while command.poll() is None:
        processes = [command, *children(command)]
        peak = max(peak, sum(map(memory, processes)))
        cpu |= {process.pid: seconds(process) for process in processes}
        time.sleep(BETWEEN)
    wall, best = time.perf_counter() - start, json.loads((out / "result.json").read_text())["best"]
    sizes = [path.stat().st_size / 1e6 for path in (folder / f"loops.{form}", out / "signals.nc", out / "report.html")]
    return (
        f"{samples:,} samples, {sizes[0]:.0f} MB of {form}: {wall:.0f} s, {sum(cpu.values()):.0f} s of CPU,"
        f" {peak:.0f} MiB at most; search {best['cpu_seconds']:.0f} s of CPU, polish {best['polish_seconds']:.0f} s,"
        f" RMSE {1000 * best['rmse']['identify']:.4f} nm; signals.nc {sizes[1]:.0f} MB, report.html {sizes[2]:.2f} MB"
    )


def children(process: psutil.Process) -> list[psutil.Process]:
    try:
        return process.children(recursive=True)
    except psutil.Error:
        return []


def memory(process: psutil.Process) -> float:
    """A page that several processes share counts in parts."""
    try:
        return process.memory_full_info().pss / 2**20
    except psutil.Error:
        return 0.0


def seconds(process: psutil.Process) -> float:
    try:
        times = process.cpu_times()
    except psutil.Error:
        return 0.0
    return times.user + times.system
