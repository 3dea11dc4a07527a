"""What Bouc-Wen, eight plays and the homogenized energy model reach on the stack, and what is missing in Bouc-Wen."""

from __future__ import annotations

from collections.abc import Mapping

from experiments.tables import Result, command, league, number, parameters, records, staircase, table

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
    parts += ["**What the first and the last model leave of each record**", by_record(results)]
    return "\n\n".join(parts)


def by_record(results: Mapping[str, Result]) -> str:
    """RMSE of each record with the model as given and with the last one of a staircase."""
    rows = []
    for job, start in STAIRCASES.items():
        first, last = (results[job]["steps"][step]["records"] for step in (0, -1))
        rows += [
            (start, record["name"], record["use"], *(number(each["rmse"]["x"]) for each in (record, after)))
            for record, after in zip(first, last, strict=True)
        ]
    return table(("staircase", "record", "use", "as given [um]", "last [um]"), rows)


if __name__ == "__main__":
    command(text)
