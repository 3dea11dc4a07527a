"""Markdown tables out of the result.json, improvement.json or diagnosis.json of finished jobs;
`python -m experiments.NAME.table FOLDER` prints those of the jobs in FOLDER, one folder each."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from statistics import median
from typing import Any

from pzt_ident.run.events import step_name

Result = Mapping[str, Any]
NAMES = {
    "rga": "RGA",
    "pso": "PSO, constriction",
    "pso_vmax": "PSO, Vmax",
    "csa": "CSA",
    "differential_evolution": "differential evolution",
    "cma_es": "CMA-ES",
    "least_squares": "least squares, multi-start",
}


def command(text: Callable[[Mapping[str, Result]], str]) -> None:
    if len(sys.argv) != 2 or not (found := finished(Path(sys.argv[1]))):
        sys.exit("give the folder in which each finished job has a folder")
    print(text({path.parent.name: json.loads(path.read_text(encoding="utf-8")) for path in found}))


def finished(folder: Path) -> list[Path]:
    """Of a folder with several of them the last in the alphabet counts: an improvement's diagnosis is of its end."""
    kinds = ("diagnosis", "improvement", "result")
    return sorted(path for kind in kinds for path in folder.glob(f"*/{kind}.json"))


def table(header: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    lines = [header, ["---", *["---:"] * (len(header) - 1)], *rows]
    return "\n".join("| " + " | ".join(str(cell) for cell in line) + " |" for line in lines)


def number(value: float | None, digits: int = 4) -> str:
    """Significant digits without trailing noise; a dash for what is not there."""
    return "–" if value is None else f"{value:.{digits}g}"


def runs_of(result: Result, optimizer: str) -> list[Any]:
    """Finished runs of an optimizer, its own best first."""
    chosen = [run for run in result["runs"] if run["optimizer"] == optimizer]
    return sorted(chosen, key=lambda run: run["rmse_before_polish"]["identify"])


def league(result: Result) -> str:
    """One row an optimizer, best first: its own results, and after the polish where the job has one."""
    polished = any(run["polish_evaluations"] for run in result["runs"])
    header = ["optimizer", "runs", f"RMSE median [{result['unit']}]", "best", "worst"]
    header += ["polished, median"] if polished else []
    header += ["validated, median", "evaluations", "to 1 %", "success", "CPU [s]"]
    rows = []
    for row in result["league"]:
        runs = runs_of(result, row["optimizer"])
        own = [run["rmse_before_polish"]["identify"] for run in runs]
        after = [row["polished_rmse_median"]] if polished else []
        cells = map(number, (row["rmse_median"], own[0], own[-1], *after, validated(runs)))
        near = number(row["evaluations_to_1_percent_median"], 6)
        cost = number(row["cpu_seconds_median"], 2)
        success = f"{row['success']:.0%}"
        rows.append([NAMES[row["optimizer"]], len(runs), *cells, row["evaluations"], near, success, cost])
    return table(header, rows)


def validated(runs: Iterable[Any]) -> float | None:
    found = [run["rmse"]["validate"] for run in runs if run["rmse"]["validate"] is not None]
    return median(found) if found else None


def parameters(result: Result) -> str:
    """The free parameters of the best run."""
    rows = [
        [name, number(entry["value"]), number(entry["standard_error"], 2), entry["unit"], entry["verdict"]]
        for name, entry in result["best"]["parameters"].items()
    ]
    return table(["parameter", "value", "standard error", "unit", "verdict"], rows)


def records(result: Result) -> str:
    """RMSE of the best run, by record and axis, and the noise floor."""
    units, floors = result.get("units", {}), result["noise_floor"]
    several = len(set(units.values())) > 1
    rows = [
        [
            f"{record['name']} ({record['use']})",
            f"{axis} [{units[axis]}]" if several else axis,
            number(rmse),
            number(floors[axis], 3),
        ]
        for record in result["records"]
        for axis, rmse in record["rmse"].items()
    ]
    unit = "" if several else f" [{result['unit']}]"
    return table(["record", "axis", f"RMSE{unit}", f"noise floor{unit}"], rows)


def staircase(improvement: Result) -> str:
    """One row a step of `improve`, its verdict below."""
    unit, floor = improvement["unit"], improvement["floor"]
    header = ["step", f"identify [{unit}]", f"validate [{unit}]", "in noise floors", "these data cannot tell it from"]
    rows = []
    for step in improvement["steps"]:
        errors = step["rmse"]
        alike = ", ".join(rival for rival in step["class"] if rival != step["added"])
        cells = [number(errors["identify"]), number(errors["validate"]), number(errors["identify"] / floor, 3)]
        rows.append([step_name(step), *cells, alike])
    said = f"Noise floor {number(floor, 3)} {unit}. Verdict: {improvement['verdict']}. {improvement['reason']}"
    return f"{table(header, rows)}\n\n{said}"
