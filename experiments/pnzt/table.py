"""What the homogenized energy model reaches on bulk PNZT without and with thermal activation, and what it misses."""

from __future__ import annotations

from collections.abc import Mapping

from experiments.tables import Result, command, number, parameters, staircase, table
from pzt_ident.run.events import step_name

JOBS = {"homogenized_energy": "without activation", "thermal_homogenized_energy": "with activation"}
AMPLITUDES = {"amplitudes": "turned at each end", "partial": "poled one way"}
UNITS = {"p": "uC/cm2", "d": "nm"}


def text(results: Mapping[str, Result]) -> str:
    parts = [by_model(results)]
    for job, said in JOBS.items():
        parts += [f"**{said}**", parameters(results[job])]
    parts += ["**Amplitudes left out**", by_amplitude(results)]
    missing = results["missing"]
    parts += ["**What is missing, loops of four amplitudes and two rates**", staircase(missing), by_record(missing)]
    parts += ["**What is missing, holds**", results["holds"]["reason"], refitted(results["holds"])]
    return "\n\n".join(parts)


def by_model(results: Mapping[str, Result]) -> str:
    rows = [
        [f"{record['name']} ({record['use']})", said, *(number(record["rmse"][axis], 3) for axis in UNITS)]
        for job, said in JOBS.items()
        for record in results[job]["records"]
    ]
    return table(["record", "model", *(f"RMSE {axis} [{unit}]" for axis, unit in UNITS.items())], rows)


def by_amplitude(results: Mapping[str, Result]) -> str:
    """Displacement alone, of a model without rate."""
    rows = [
        [said, f"{record['name']} ({record['use']})", number(record["rmse"]["d"], 3)]
        for job, said in AMPLITUDES.items()
        for record in results[job]["records"]
    ]
    return table(["sample", "record", f"RMSE d [{UNITS['d']}]"], rows)


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


def refitted(diagnosis: Result) -> str:
    """What the model as given and each effect of the short list leave of each record."""
    models = {"as given": diagnosis} | {f"+ {item['effect']}": item for item in diagnosis["candidates"] if item["rmse"]}
    header = [
        "model",
        "validate [1]",
        *(f"{r['name']} ({r['use']}): {axis} [{UNITS[axis]}]" for r in diagnosis["records"] for axis in UNITS),
    ]
    rows = [
        [
            said,
            number(item["rmse"]["validate"], 3),
            *(number(r["rmse"][axis], 3) for r in item["records"] for axis in UNITS),
        ]
        for said, item in models.items()
    ]
    return table(header, rows)


if __name__ == "__main__":
    command(text)
