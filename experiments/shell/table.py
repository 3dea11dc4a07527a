"""The virtual tube identified as a shell behind the homogenized energy model."""

from __future__ import annotations

from collections.abc import Mapping

from experiments.tables import Result, command, number, records, table

DENSITY = {"gain": 4e-3, "remanence": 90.0, "coercive": 30.0, "spread": 0.8, "interaction": 60.0}
TRUTH = {f"homogenized_energy.{word}": value for word, value in DENSITY.items()}
TRUTH |= {"shell.viscosity": 1e5, "shell.end_mass": 0.02}


def text(results: Mapping[str, Result]) -> str:
    found = results["tube"]["best"]["parameters"]
    rows = [
        [
            f"{name} [{found[name]['unit']}]",
            number(truth),
            *map(number, (found[name]["value"], found[name]["standard_error"])),
        ]
        for name, truth in TRUTH.items()
    ]
    identified = table(["parameter", "tube", "identified", "standard error"], rows)
    return "\n\n".join(["**Identified values**", identified, "**RMSE**", records(results["tube"])])


if __name__ == "__main__":
    command(text)
