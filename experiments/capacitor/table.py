"""What is missing in the models of a linear capacitor, and the lag that is found."""

from __future__ import annotations

from collections.abc import Mapping

from experiments.tables import Result, command, number, staircase, table


def lag(improvement: Result) -> str:
    """The dead time once it is in the model, before anything is added to it."""
    step = next(step for step in improvement["steps"] if step["added"] == "delay")
    late = 1e6 * step["parameters"]["delay.time"]["value"]
    return table(["lag [us]", "here", "from the loop's width"], [["400 to 1000 Hz", number(late), "13.0"]])


def text(results: Mapping[str, Result]) -> str:
    parts = ["**No hysteresis in the model**", lag(results["linear"]), staircase(results["linear"])]
    return "\n\n".join([*parts, "**Bouc-Wen in the model**", staircase(results["lag"])])


if __name__ == "__main__":
    command(text)
