"""Does what is missing on PNZT hang on which rate is left out and on which response is fitted?

python -m experiments.pnzt.splits FOLDER diagnoses `missing.yaml` nine times and prints what is named each time.
"""

from __future__ import annotations

import json
import sys
from io import StringIO
from itertools import product
from pathlib import Path
from typing import Any

from ruamel.yaml import YAML

from experiments.pnzt.table import UNITS
from experiments.tables import Result, number, table
from pzt_ident.job.schema import Job
from pzt_ident.run.improve import diagnose

JOB = Path(__file__).parent / "missing.yaml"
RATES = ("0.01 Hz", "0.1 Hz", "1 Hz")
MODELS = ("as given", "thermal_relaxation", "creep")
DENSITY = ("coercive", "spread", "interaction")
FITTED = {
    "P": ("p", ()),
    "P and D": ("pd", ()),
    "P and D, each with densities of its own": ("pd", DENSITY),
}


def split(axes: str, own: tuple[str, ...], rate: str) -> Job:
    """`missing.yaml` with some of its responses, parameters that each of them has for itself, and a rate left out."""
    yaml = YAML()
    job: Any = yaml.load(JOB)
    for record in job["records"]:
        record["use"] = "validate" if record["name"].endswith(f" V {rate}") else "identify"
    job["channels"]["axes"] = {axis: job["channels"]["axes"][axis] for axis in axes}
    job["shared"] = [name for name in job["shared"] if len(axes) > 1 and name.partition(".")[2] not in own]
    stripped = {name.removeprefix("p.") if len(axes) == 1 else name: each for name, each in job["parameters"].items()}
    job["parameters"] = {name: each for name, each in stripped.items() if len(axes) > 1 or not name.startswith("d.")}
    text = StringIO()
    yaml.dump(job, text)
    return Job.from_text(text.getvalue(), JOB.parent)


def left_out(records: list[Any] | None, axis: str) -> float | None:
    """RMSE over the records that were left out, all of one length."""
    found = [record["rmse"].get(axis) for record in records or [] if record["use"] == "validate"]
    return sum(each**2 / len(found) for each in found) ** 0.5 if found and None not in found else None


def row(said: str, rate: str, found: Result) -> list[str]:
    models = {item["effect"]: item["records"] for item in found["candidates"]} | {"as given": found["records"]}
    named = [item["effect"] for item in found["candidates"] if item["decision"] == "missing"]
    errors = [number(left_out(models.get(model), axis), 3) for axis in UNITS for model in MODELS]
    return [said, rate, " or ".join(named) or found["verdict"], *errors]


def main(folder: Path) -> None:
    rows = []
    for (said, (axes, own)), rate in product(FITTED.items(), RATES):
        out = folder / f"{axes}{'_own' * bool(own)}_without_{rate.replace(' ', '_')}"
        if not (out / "diagnosis.json").exists():
            diagnose(split(axes, own, rate), out)
        rows.append(row(said, rate, json.loads((out / "diagnosis.json").read_text(encoding="utf-8"))))
    errors = [f"{axis}, {model} [{unit}]" for axis, unit in UNITS.items() for model in MODELS]
    print(table(["fitted", "rate left out", "missing", *errors], rows))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
