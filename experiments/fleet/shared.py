"""Devices as the axes of one job, so that they share parameters: what that takes by their number."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from experiments.coverage.stage import MASS

JOB = """\
name: shared
records: [{{file: loops.csv}}]
channels:
  time: "time [s]"
  axes:
{axes}
model: [bouc_wen, lumped]
shared: [bouc_wen.alpha, bouc_wen.beta, bouc_wen.gamma, lumped.mass, lumped.stiffness, lumped.damping]
parameters:
  lumped.mass: {{value: {mass}}}
  lumped.stiffness: {{bounds: [1e5, 1e6]}}
  lumped.damping: {{bounds: [0, 100]}}
optimizers: [{{name: pso, population: 50}}]
stop: {{evaluations: {evaluations}}}
seed: 1
"""
RUN = """\
import sys
from pathlib import Path
from experiments.trust.bench import InThisProcess
from pzt_ident.job.schema import load_job
from pzt_ident.run.identify import run
run(load_job(Path(sys.argv[1])), Path(sys.argv[2]), place=InThisProcess())
"""


def grown(lot: Path, devices: int, evaluations: int) -> dict[str, float]:
    """CPU time and the most memory of a process that identifies so many devices of a lot in one job."""
    with TemporaryDirectory(prefix="shared-") as scratch:
        samples = write_job(lot, devices, evaluations, Path(scratch))
        line = [sys.executable, "-c", RUN, f"{scratch}/job.yaml", f"{scratch}/out"]
        status, usage = os.wait4(subprocess.Popen(line).pid, 0)[1:]
        assert status == 0
        result = json.loads(Path(scratch, "out", "result.json").read_text())
    return {
        "devices": devices,
        "samples each": samples,
        "free parameters": len(result["best"]["parameters"]),
        "evaluations": result["best"]["evaluations"],
        "CPU [s]": usage.ru_utime + usage.ru_stime,
        "of the search [s]": result["best"]["cpu_seconds"],
        "most memory [MiB]": usage.ru_maxrss / 1024,
    }


def write_job(lot: Path, devices: int, evaluations: int, folder: Path) -> int:
    """Write the job of the first sound devices of a lot and its data, a drive and a response a device; returns the
    number of samples."""
    truth = json.loads((lot / "truth.json").read_text())
    names = [name for name, facts in truth.items() if facts["kind"] == "plain"][:devices]
    assert len(names) == devices, f"the lot has {len(names)} devices without a fault"
    tables = [np.loadtxt(lot / "lot" / name / "loops.csv", delimiter=",", skiprows=1) for name in names]
    columns = np.column_stack([tables[0][:, :1], *(table[:, 1:] for table in tables)])
    header = ",".join(["time [s]", *(f"u_{name} [V],x_{name} [um]" for name in names)])
    np.savetxt(folder / "loops.csv", columns, "%.9g", ",", header=header, comments="")
    axes = "\n".join(f'    {name}: {{drive: "u_{name} [V]", response: "x_{name} [um]"}}' for name in names)
    (folder / "job.yaml").write_text(JOB.format(axes=axes, mass=MASS, evaluations=evaluations))
    return len(columns)
