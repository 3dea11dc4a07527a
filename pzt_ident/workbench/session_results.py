"""The results of a step gathered for its report: run, diagnosis, and the staircase of steps that led to it."""

from __future__ import annotations

import json
import shutil
from itertools import pairwise
from pathlib import Path
from typing import Any

from pzt_ident.diagnosis.misfit import share_explained
from pzt_ident.files import write_json
from pzt_ident.workbench.session import Session

StepResult = tuple[dict[str, Any], dict[str, Any]]


def gathered(session: Session) -> Path:
    """The run folder of the current step, with `diagnosis.json` and, if steps led to it, `improvement.json` copied in.

    `pzt-ident report` of that folder then draws the same report.
    """
    step = session.step()
    run, diagnosis = step / "run", step / "diagnosis" / "diagnosis.json"
    if diagnosis.exists():
        for name in ("diagnosis.json", "next_experiment.csv"):
            if (step / "diagnosis" / name).exists():
                shutil.copy(step / "diagnosis" / name, run / name)
        results = [(entry, result) for entry in session.chain() if (result := result_of(session, entry))]
        if len(results) > 1 and results[-1][1]["floor"]:
            write_json(run / "improvement.json", improvement(results, read(diagnosis)))
    return run


def result_of(session: Session, entry: dict[str, Any]) -> dict[str, Any] | None:
    path = session.step(entry["number"]) / "run" / "result.json"
    result = read(path) if path.exists() else {}
    return result if result.get("best") else None


def read(path: Path) -> dict[str, Any]:
    return dict(json.loads(path.read_text(encoding="utf-8")))


def improvement(results: list[StepResult], diagnosis: dict[str, Any]) -> dict[str, Any]:
    """The content of `improvement.json`, from the steps and their results."""
    last = results[-1][1]
    floor = last["floor"]
    steps = [step_of(*results[0]), *(step_of(*last, before, floor) for (_, before), last in pairwise(results))]
    return {
        "name": last["name"],
        "steps": steps,
        "verdict": diagnosis["verdict"],
        "reason": diagnosis["reason"],
        "effects": effects(results),
        **{key: last[key] for key in ("unit", "units", "noise_floor", "noise_floor_source", "floor")},
        "next_experiment": diagnosis["next_experiment"],
    }


def effects(results: list[StepResult]) -> list[str]:
    """The effects that were added and not removed again."""
    words: list[str] = []
    for entry, _ in results:
        sign, _, word = entry["change"].partition(" ")
        if sign == "+":
            words.append(word)
        elif sign == "−" and word in words:
            words.remove(word)
    return words


def step_of(
    entry: dict[str, Any], result: dict[str, Any], before: dict[str, Any] | None = None, floor: float = 0.0
) -> dict[str, Any]:
    """One step of the staircase."""
    sign, _, word = entry["change"].partition(" ")
    previous, best = (before or result)["best"]["rmse"]["identify"], result["best"]
    return {
        "change": entry["change"],
        "added": word if sign == "+" else None,
        "removed": word if sign == "−" else None,
        "class": [word] if sign == "+" else [],
        "rmse": best["rmse"],
        "explained": share_explained(previous, best["rmse"]["identify"], floor),
        "expected": None,
        "promised": entry.get("promised"),
        "note": entry.get("note", ""),
        "parameters": {
            name: {key: item.get(key) for key in ("value", "unit", "standard_error", "interval")}
            for name, item in best["parameters"].items()
        },
    }
