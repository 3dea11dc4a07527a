"""The steps of an improvement as steps of the session."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from pzt_ident.files import write_json
from pzt_ident.job.edit import edited
from pzt_ident.job.schema import load_job
from pzt_ident.run.events import step_name
from pzt_ident.workbench.session import Session


def improvement(session: Session, step: Path) -> list[int]:
    """Make the steps that `improve` took from a step, each with the fit that it found as its start; their numbers."""
    content = json.loads((step / "improved" / "improvement.json").read_text(encoding="utf-8"))
    stairs, numbers = content["steps"][1:], list[int]()
    for place, stair in enumerate(stairs, 1):
        folder = session.next_folder
        text = text_of(session, step, stair, folder, last=place == len(stairs))
        write_json(folder / "start.json", {"parameters": stair["parameters"]})
        change = step_name(stair).replace("- ", "− ")
        source = session.start_of(folder)
        tied = {"tied": stair["class"]} if len(stair["class"]) > 1 else {}
        session.make(text, session.at, change, promised=stair["rmse"], **{"from": source}, **tied)
        numbers.append(session.at)
    return numbers


def text_of(session: Session, step: Path, stair: dict[str, Any], folder: Path, last: bool) -> str:
    """The job of a stair; of the last one as `improved.yaml` has it."""
    if last:
        job = load_job(step / "improved" / "improved.yaml", session.plugins)
        return edited(job, job.effects, folder)
    job = load_job(step / "job.yaml", session.plugins)
    return edited(job, stair["effects"], folder, steps=stair["steps"])
