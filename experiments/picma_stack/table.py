"""What Bouc-Wen and what eight plays reach on the stack."""

from __future__ import annotations

from collections.abc import Mapping

from experiments.tables import Result, command, league, parameters, records


def text(results: Mapping[str, Result]) -> str:
    parts = []
    for job, model in (("bouc_wen", "Bouc-Wen"), ("plays", "eight plays")):
        result = results[job]
        parts += [f"**{model}**", records(result), league(result), parameters(result)]
    return "\n\n".join(parts)


if __name__ == "__main__":
    command(text)
