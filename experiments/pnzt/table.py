"""What the homogenized energy model reaches on bulk PNZT without and with thermal activation, and what it misses."""

from __future__ import annotations

from collections.abc import Mapping

from experiments.tables import Result, command, number, parameters, staircase, table
from pzt_ident.report.words import step_name

JOBS = {"homogenized_energy": "without activation", "thermal_homogenized_energy": "with activation"}
STAIRS = {"missing": "loops of four amplitudes and two rates", "holds": "holds at constant field"}
UNITS = {"p": "uC/cm2", "d": "nm"}


def text(results: Mapping[str, Result]) -> str:
    rows = [
        [f"{record['name']} ({record['use']})", said, *(number(record["rmse"][axis], 3) for axis in UNITS)]
        for job, said in JOBS.items()
        for record in results[job]["records"]
    ]
    parts = [table(["record", "model", *(f"RMSE {axis} [{unit}]" for axis, unit in UNITS.items())], rows)]
    for job, said in JOBS.items():
        parts += [f"**{said}**", parameters(results[job])]
    for job, said in STAIRS.items():
        parts += [f"**What is missing, {said}**", staircase(results[job]), by_record(results[job])]
    return "\n\n".join(parts)


def by_record(improvement: Result) -> str:
    """What each of the first stairs leaves of each record, each axis in its own unit."""
    steps = improvement["steps"][:3]
    header = ["record", *(f"{step_name(step)}: {axis} [{unit}]" for axis, unit in UNITS.items() for step in steps)]
    rows = [
        [
            f"{record['name']} ({record['use']})",
            *(number(step["records"][i]["rmse"][axis], 3) for axis in UNITS for step in steps),
        ]
        for i, record in enumerate(steps[0]["records"])
    ]
    return table(header, rows)


if __name__ == "__main__":
    command(text)
