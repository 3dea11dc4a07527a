"""What a session knows of a step, beside its run, so that the report has it: the diagnosis, and the staircase to it."""

from __future__ import annotations

import json
import shutil
from itertools import pairwise
from pathlib import Path
from typing import Any

from pzt_ident.files import write_json
from pzt_ident.workbench.session import Session

Done = tuple[dict[str, Any], dict[str, Any]]


def gathered(session: Session) -> Path:
    """The folder of the run of the step shown, with `diagnosis.json` and, where steps led to it, `improvement.json`.

    The same report is then drawn by `pzt-ident report` of that folder.
    """
    step = session.step()
    run, diagnosis = step / "run", step / "diagnosis" / "diagnosis.json"
    if diagnosis.exists():
        for name in ("diagnosis.json", "next_experiment.csv"):
            if (step / "diagnosis" / name).exists():
                shutil.copy(step / "diagnosis" / name, run / name)
        done = [(entry, found) for entry in session.chain() if (found := result_of(session, entry))]
        if len(done) > 1 and done[-1][1]["floor"]:
            write_json(run / "improvement.json", improvement(done, read(diagnosis)))
    return run


def result_of(session: Session, entry: dict[str, Any]) -> dict[str, Any] | None:
    path = session.step(entry["number"]) / "run" / "result.json"
    found = read(path) if path.exists() else {}
    return found if found.get("best") else None


def read(path: Path) -> dict[str, Any]:
    return dict(json.loads(path.read_text(encoding="utf-8")))


def improvement(done: list[Done], diagnosis: dict[str, Any]) -> dict[str, Any]:
    """The content of `improvement.json`, from the steps and their results."""
    last = done[-1][1]
    floor = last["floor"]
    steps = [stair(*done[0]), *(stair(*now, before, floor) for (_, before), now in pairwise(done))]
    return {
        "name": last["name"],
        "steps": steps,
        "verdict": diagnosis["verdict"],
        "reason": diagnosis["reason"],
        "effects": effects(done),
        **{key: last[key] for key in ("unit", "units", "noise_floor", "noise_floor_source", "floor")},
        "next_experiment": diagnosis["next_experiment"],
    }


def effects(done: list[Done]) -> list[str]:
    """Those added on the way and not taken off again."""
    found: list[str] = []
    for entry, _ in done:
        sign, _, word = entry["change"].partition(" ")
        if sign == "+":
            found.append(word)
        elif sign == "−" and word in found:
            found.remove(word)
    return found


def stair(
    entry: dict[str, Any], found: dict[str, Any], before: dict[str, Any] | None = None, floor: float = 0.0
) -> dict[str, Any]:
    """One step; `explained` is the share of the squared misfit above the noise that it removed."""
    sign, _, word = entry["change"].partition(" ")
    left, best = (before or found)["best"]["rmse"]["identify"], found["best"]
    above = max(left**2 - floor**2, 1e-300)
    return {
        "change": entry["change"],
        "added": word if sign == "+" else None,
        "removed": word if sign == "−" else None,
        "class": [word] if sign == "+" else [],
        "rmse": best["rmse"],
        "explained": (left**2 - best["rmse"]["identify"] ** 2) / above,
        "expected": None,
        "parameters": {
            name: {key: item[key] for key in ("value", "unit")} for name, item in best["parameters"].items()
        },
    }
