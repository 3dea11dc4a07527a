"""What Bouc-Wen reaches on the bender, what it misses, and what its ring-down says."""

from __future__ import annotations

import math
from collections.abc import Mapping

from experiments.tables import Result, command, league, number, parameters, records, staircase, table

PUBLISHED = {"straight line": 1.875, "sparse regression, published equation": 0.0915}  # um, fitted where scored


def scores(result: Result) -> str:
    """The validated RMSE beside those of the data's own README, which are for rows 35000 to 45000."""
    own = result["best"]["rmse"]["validate"]
    rows = [["Bouc-Wen, cycles not used in the fit", number(own)]]
    return table(["model", "RMSE [um]"], [*rows, *([name, number(value)] for name, value in PUBLISHED.items())])


def resonance(result: Result) -> str:
    """Natural frequency and damping ratio, for which the mass does not matter."""
    found = {name: entry["value"] for name, entry in result["best"]["parameters"].items()}
    mass = result["best"]["fixed"]["lumped.mass"]["value"]
    stiffness, damping = found["lumped.stiffness"], found["lumped.damping"]
    ratio = damping / (2 * math.sqrt(stiffness * mass))
    return table(
        ["ring-down", "here", "a decaying sine"],
        [
            ["natural frequency [Hz]", number(math.sqrt(stiffness / mass) / (2 * math.pi)), "955"],
            ["damping ratio", number(ratio, 2), "0.04 to 0.05"],
        ],
    )


def text(results: Mapping[str, Result]) -> str:
    loops, ring = results["bouc_wen"], results["ring_down"]
    parts = ["**Loops**", scores(loops), records(loops), league(loops), parameters(loops)]
    parts += ["**What is missing**", staircase(results["missing"])]
    return "\n\n".join([*parts, "**Ring-down**", resonance(ring), records(ring)])


if __name__ == "__main__":
    command(text)
