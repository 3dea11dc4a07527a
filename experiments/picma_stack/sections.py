"""What three memories leave of the parts of the record that was not fitted: python -m experiments.picma_stack.sections
FOLDER prints a table of the finished jobs in FOLDER."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np

from experiments.tables import number, table
from pzt_ident.job.schema import load_job
from pzt_ident.run.statement import Statement

HERE = Path(__file__).parent
JOBS = {
    "bouc_wen": ("Bouc-Wen", HERE.parents[1] / "configs" / "picma.yaml"),
    "plays": ("eight plays", HERE / "plays.yaml"),
    "homogenized_energy": ("homogenized energy", HERE / "homogenized_energy.yaml"),
    "homogenized_energy_late": ("the same, one sample late", HERE / "homogenized_energy_late.yaml"),
}
PARTS = {"one amplitude": (200, 3000), "minor loops": (3000, 3880), "hold": (3880, 5070)}


def row(folder: Path, name: str) -> list[str]:
    """RMSE of the whole record and of its parts, the offset of the whole record removed from all."""
    said, path = JOBS[name]
    job = load_job(path)
    problem = Statement(job).problem
    best = json.loads((folder / name / "result.json").read_text(encoding="utf-8"))["best"]["parameters"]
    point = problem.unit_point({word: entry["value"] for word, entry in best.items()})
    (simulator,) = problem.simulators["validate"]
    error = 1e6 * simulator.errors(problem.parameters(point))[0, 0]
    parts = [error[200:], *(error[first:last] for first, last in PARTS.values())]
    return [said, *(number(float(np.sqrt(np.mean(part**2))), 3) for part in parts)]


def main(folder: Path) -> None:
    print(table(["validate [um]", "whole record", *PARTS], [row(folder, name) for name in JOBS]))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
