"""What the page shows of a session, read from its folders."""

from __future__ import annotations

import inspect
import json
from pathlib import Path
from typing import Any

from pzt_ident.data.notation import spelled, unit
from pzt_ident.data.over_axes import together, weighed
from pzt_ident.data.readers.registry import readers
from pzt_ident.data.signals import Trace
from pzt_ident.model.registry import blocks, word_of
from pzt_ident.report.sentences import printed_reason
from pzt_ident.report.tables import expected
from pzt_ident.report.traces import packed
from pzt_ident.run.results import read_results
from pzt_ident.workbench.guard import LARGEST_UPLOAD
from pzt_ident.workbench.session import Session

SPELLED = {"unit": unit} | dict.fromkeys(("reason", "why", "said", "sentences"), spelled)


def state(session: Session) -> dict[str, Any]:
    """Everything but the signals; empty parts where there is nothing yet."""
    chain = session.chain()
    step = session.step() if chain else None
    job = job_of(session) if step else None  # read first: it may bring blocks
    return {
        "version": session.version,
        "folder": session.relative(session.folder),
        "largest": LARGEST_UPLOAD,
        "blocks": chainable(),
        "effects": effects(),
        "files": [*files_in(session.root), *(session.relative(session.data / name) for name in files_in(session.data))],
        "steps": [about(session, entry) for entry in chain],
        "others": [about(session, entry) for entry in session.steps if entry not in chain],
        "stage": session.stage,
        "since": session.since,
        "failure": session.failure,
        **over_axes(session),
        "job": job,
        "result": read(step / "run" / "result.json") if step else None,
        "misfit": read(step / "run" / "residuals.json") if step else None,
        "diagnosis": diagnosis_of(step) if step else None,
        "commands": session.said(),
    }


def about(session: Session, entry: dict[str, Any]) -> dict[str, Any]:
    """A step and what its model leaves, where it was run."""
    found = read(session.step(entry["number"]) / "run" / "result.json")
    rmse = found["best"]["rmse"] if found and found.get("best") else {"identify": None, "validate": None}
    return entry | rmse


def over_axes(session: Session) -> dict[str, str]:
    """The unit of errors over all axes, what stands behind their name and what they count, from the newest step that
    has a result."""
    found = (read(session.step(entry["number"]) / "run" / "result.json") for entry in reversed(session.steps))
    newest: dict[str, Any] = next(filter(None, found), {})
    units = newest.get("units", {})
    unit = newest["unit"] or "1" if newest else ""
    return {"unit": unit, "together": together(units), "weighed": " ".join(weighed(units))}


def diagnosis_of(step: Path) -> dict[str, Any] | None:
    """The diagnosis, with what each effect would be as it is printed."""
    path = step / "diagnosis" / "diagnosis.json"
    if not path.exists():
        return None
    found = json.loads(path.read_text(encoding="utf-8"))
    for item in found["candidates"]:
        item["would_be"] = expected(item["expected"], item["units"])
    return printed(found) | {"reason": printed_reason(found["reason"], read_results(step / "run"))}


def job_of(session: Session) -> dict[str, Any]:
    job = session.job()
    folder = session.relative(session.step())
    return {
        "name": job.name,
        "model": [word_of(item) for item in job.model],
        "effects": job.effects,
        "folder": folder,
        "text": job.text,
    }


def signals(session: Session) -> dict[str, Any]:
    """The records with the model of the step shown and of the step before, every sample of them."""
    models: dict[str, tuple[Trace, ...]] = {}
    for entry, name in zip(reversed(session.chain()), ("now", "before"), strict=False):
        run = session.step(entry["number"]) / "run"
        if (run / "result.json").exists():
            models[name] = read_results(run).traces
    found = read(session.step() / "run" / "result.json") or {"noise_floor": {}}
    return {"records": packed(models, None), "floors": found["noise_floor"]}


def read(path: Path) -> Any:
    """A JSON file; None where there is none, with its units as they are printed."""
    if not path.exists():
        return None
    return printed(json.loads(path.read_text(encoding="utf-8")))


def printed(found: Any, key: str = "") -> Any:
    """The units in it, and those in its sentences, as they are printed."""
    if isinstance(found, dict):
        return {word: printed(item, "unit" if key == "units" else word) for word, item in found.items()}
    if isinstance(found, list):
        return [printed(item, key) for item in found]
    return SPELLED[key](found) if key in SPELLED and isinstance(found, str) else found


def files_in(root: Path) -> list[str]:
    """Data files right in a folder, if there is one."""
    found = root.iterdir() if root.is_dir() else ()
    suffixes = readers.suffixes()
    return sorted(path.name for path in found if path.suffix.lower() in suffixes and not path.is_symlink())


def chainable() -> list[dict[str, Any]]:
    """Blocks that a model may be made of."""
    return [described(word) for word in blocks.usable() if not blocks.is_effect(word)]


def effects() -> list[dict[str, Any]]:
    return [described(word) for word in blocks.effects()]


def described(word: str) -> dict[str, Any]:
    place = getattr(blocks[word], "place", None)
    doc = (inspect.getdoc(blocks[word]) or "").partition("\n")[0]
    return {"name": word, "doc": doc, "place": None if place is None else int(place), "kind": blocks.kind_of(word)}
