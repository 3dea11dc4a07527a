"""What the homogenized energy model reaches on bulk PNZT without and with thermal activation."""

from __future__ import annotations

from collections.abc import Mapping

from experiments.tables import Result, command, number, parameters, table

JOBS = {"homogenized_energy": "without activation", "thermal_homogenized_energy": "with activation"}
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
    return "\n\n".join(parts)


if __name__ == "__main__":
    command(text)
