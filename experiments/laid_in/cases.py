"""A case: `rig/` with the job and its data, all that the tool is given, and `truth.json` beside it."""

from __future__ import annotations

import json
from pathlib import Path

from experiments.laid_in.effects import lay, scale
from experiments.laid_in.records import RECORDS

AS_IT_IS = "as_it_is"
NO_GRATING = "rule_out: [encoder_cyclic_error]\n"


def names(records: list[str]) -> list[tuple[str, str, int]]:
    """(record, effect, size) of all cases, the records as they are first."""
    first = [(record, AS_IT_IS, 0) for record in records]
    laid = [(r, effect, size) for r in records for effect in RECORDS[r].hints for size in RECORDS[r].sizes]
    return first + laid


def write(record: str, effect: str, units: int, seed: int, out: Path) -> Path | None:
    """The folder of a case; None where no plausible size of the effect is seen so large."""
    home, chosen = out / f"{record}-{effect}-{units}", RECORDS[record]
    if (home / "truth.json").exists():
        return home
    responses = chosen.read()
    laid, size = [response.values for response in responses], 0.0
    if effect != AS_IT_IS:
        hint = chosen.hints[effect]
        found = scale(effect, units * chosen.unit, responses, seed, hint)
        if found is None:
            return None
        laid, size = lay(effect, found, responses, seed, hint), found
    chosen.write(home / "rig", laid)
    text = chosen.text()
    if effect == "encoder":
        text = text.replace(NO_GRATING, "")
    (home / "rig" / "job.yaml").write_text(text, encoding="utf-8")
    truth = {"record": record, "effect": effect, "units": units, "size": size, "seed": seed, "unit": chosen.unit}
    (home / "truth.json").write_text(json.dumps(truth, indent=1))
    return home
