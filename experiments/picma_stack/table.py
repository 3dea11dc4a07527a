"""What Bouc-Wen, eight plays and the homogenized energy model reach on the stack, and what is missing in Bouc-Wen."""

from __future__ import annotations

from collections.abc import Mapping

from experiments.tables import Result, command, league, parameters, records, staircase

STAIRCASES = {
    "missing": "as identified above",
    "one_sample_late": "the sensor one sample late",
    "from_rest": "from the step at the start",
    "first_halves": "from the step at the start, the first parts of both records fitted",
}


def text(results: Mapping[str, Result]) -> str:
    parts = []
    for job, model in (("bouc_wen", "Bouc-Wen"), ("plays", "eight plays")):
        result = results[job]
        parts += [f"**{model}**", records(result), league(result), parameters(result)]
    for job, start in (("homogenized_energy", "as it is"), ("homogenized_energy_late", "the sensor one sample late")):
        parts += [f"**Homogenized energy, {start}**", records(results[job]), parameters(results[job])]
    for job, start in STAIRCASES.items():
        parts += [f"**What is missing, {start}**", staircase(results[job])]
    return "\n\n".join(parts)


if __name__ == "__main__":
    command(text)
