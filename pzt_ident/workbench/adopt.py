"""The steps of an improvement as steps of the session."""

from __future__ import annotations

import json
import shutil
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from pzt_ident.files import write_json, write_sealed
from pzt_ident.job.edit import edited
from pzt_ident.job.schema import load_job
from pzt_ident.model.registry import word_of
from pzt_ident.run.events import step_name
from pzt_ident.workbench.session import Session


def improvement(session: Session, step: Path) -> list[int]:
    """Make the steps that `improve` took from a step and did not take back, each with the fit that it found as its
    start; their numbers."""
    content = json.loads((step / "improved" / "improvement.json").read_text(encoding="utf-8"))
    first, *stairs = without_detours(content["steps"])
    numbers = list[int]()
    session.keep(int(step.name), tried=first["tried"])
    for place, stair in enumerate(stairs, 1):
        folder = session.next_folder
        text = text_of(session, step, stair, folder, last=place == len(stairs))
        write_json(folder / "start.json", {"parameters": stair["parameters"]})
        change = step_name(stair).replace("- ", "− ")
        source = session.start_of(folder)
        facts = {"from": source, "promised": stair["rmse"], "tried": stair["tried"]}
        facts |= {"tied": stair["class"]} if len(stair["class"]) > 1 else {}
        session.make(text, session.at, change, **facts)
        numbers.append(session.at)
    return numbers


def without_detours(stairs: Sequence[dict[str, Any]]) -> list[dict[str, Any]]:
    """The stairs of an improvement less those that it took back. One that a removal leads back to has the fit that was
    found then; `tried`: the effects that were added in between."""
    path = list[dict[str, Any]]()
    for stair in stairs:
        same = [place for place, before in enumerate(path) if same_model(before, stair)]
        if stair["removed"] and same:
            back, detour = path[same[-1]], path[same[-1] + 1 :]
            words = [*back["tried"], *(word for one in detour for word in (one["added"], *one["tried"]) if word)]
            found = {key: stair[key] for key in ("rmse", "parameters", "effects", "steps")}
            path = [*path[: same[-1]], back | found | {"tried": list(dict.fromkeys(words))}]
        else:
            path.append(stair | {"tried": []})
    return path


def same_model(one: dict[str, Any], other: dict[str, Any]) -> bool:
    """Whether two stairs have the same blocks, bounds and effects."""
    return all(one[key] == other[key] for key in ("model", "bounds")) and set(one["effects"]) == set(other["effects"])


def diagnosis(session: Session, step: Path, last: int) -> None:
    """Give the last step of an improvement, or the one that it came back to, the diagnosis with which it ended."""
    improved, folder = step / "improved", session.step(last) / "diagnosis"
    found, account = (
        json.loads((improved / name).read_text(encoding="utf-8")) for name in ("diagnosis.json", "improvement.json")
    )
    folder.mkdir(exist_ok=True)
    (folder / "next_experiment.csv").unlink(missing_ok=True)
    if (improved / "next_experiment.csv").exists():
        shutil.copy(improved / "next_experiment.csv", folder)
    write_sealed(folder / "diagnosis.json", found | {"reason": account["reason"]})
    session.keep(last, diagnosed=str(improved.relative_to(session.folder)))


def text_of(session: Session, step: Path, stair: dict[str, Any], folder: Path, last: bool) -> str:
    """The job of a stair; of the last one as `improved.yaml` has it."""
    if last:
        job = load_job(step / "improved" / "improved.yaml", session.plugins)
        return edited(job, job.effects, folder)
    job = load_job(step / "job.yaml", session.plugins)
    words = stair["model"] if stair["model"] != list(map(word_of, job.model)) else None
    return edited(job, stair["effects"], folder, words, steps=stair["steps"], bounds=stair["bounds"])
