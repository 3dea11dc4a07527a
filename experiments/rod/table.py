"""The virtual rod identified as a distributed one and as one mass."""

from __future__ import annotations

from collections.abc import Mapping

from experiments.tables import Result, command, number, records, table

TRUTH = {"bouc_wen.gain": 0.6, "bouc_wen.alpha": 0.5, "bouc_wen.beta": 0.02, "bouc_wen.gamma": 0.01}
ENDS = {"viscosity": 1e5, "end_mass": 0.05}


def found(results: Mapping[str, Result]) -> str:
    """Identified values beside those of the virtual rod."""
    distributed, lumped = (results[name]["best"]["parameters"] for name in ("distributed", "lumped"))
    rows = []
    for name, truth in (TRUTH | {f"rod.{word}": value for word, value in ENDS.items()}).items():
        other = lumped[name.replace("rod.", "lumped_rod.")]
        cells = [
            f"{number(entry['value'])} ± {number(entry['standard_error'], 2)}" for entry in (distributed[name], other)
        ]
        rows.append([f"{name} [{other['unit']}]", number(truth), *cells])
    return table(["parameter", "stage", "distributed", "lumped"], rows)


def text(results: Mapping[str, Result]) -> str:
    parts = ["**Identified values**", found(results)]
    for name in ("distributed", "lumped"):
        parts += [f"**RMSE, {name}**", records(results[name])]
    return "\n\n".join(parts)


if __name__ == "__main__":
    command(text)
