"""The state of a session for the page, read from its folders."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from pzt_ident.data.notation import spelled, unit
from pzt_ident.data.over_axes import together, weighed
from pzt_ident.data.readers.registry import readers
from pzt_ident.data.signals import Trace
from pzt_ident.model.description import headline
from pzt_ident.model.registry import blocks, word_of
from pzt_ident.report.sentences import printed_reason
from pzt_ident.report.tables import expected
from pzt_ident.report.traces import packed
from pzt_ident.run.results import read_results
from pzt_ident.workbench.guard import LARGEST_UPLOAD
from pzt_ident.workbench.session import Session

PRINTERS = {"unit": unit} | dict.fromkeys(("reason", "why", "said", "sentences"), spelled)


def state(session: Session) -> dict[str, Any]:
    """The whole state except the signals; parts without results are None or empty."""
    chain = session.chain()
    step = session.step() if chain else None
    job = job_of(session) if step else None  # read first: its plugins may register blocks
    return {
        "version": session.version,
        "folder": session.relative(session.folder),
        "largest": LARGEST_UPLOAD,
        "blocks": model_blocks(),
        "effects": effects(),
        "files": [*files_in(session.root), *(session.relative(session.data / name) for name in files_in(session.data))],
        "steps": [step_state(session, entry) for entry in chain],
        "others": [step_state(session, entry) for entry in session.steps if entry not in chain],
        "stage": session.stage,
        "since": session.since,
        "failure": session.failure,
        **over_axes(session),
        "job": job,
        "result": read(step / "run" / "result.json") if step else None,
        "misfit": read(step / "run" / "residuals.json") if step else None,
        "diagnosis": diagnosis_of(step) if step else None,
        "commands": session.logged_commands(),
    }


def step_state(session: Session, entry: dict[str, Any]) -> dict[str, Any]:
    """A step and the RMSE of its model by use, None if it was not run."""
    result = read(session.step(entry["number"]) / "run" / "result.json")
    rmse = result["best"]["rmse"] if result and result.get("best") else {"identify": None, "validate": None}
    return entry | rmse


def over_axes(session: Session) -> dict[str, str]:
    """Unit, name suffix and explanation of errors over all axes, from the newest step that has a result."""
    results = (read(session.step(entry["number"]) / "run" / "result.json") for entry in reversed(session.steps))
    newest: dict[str, Any] = next(filter(None, results), {})
    units = newest.get("units", {})
    unit = newest["unit"] or "1" if newest else ""
    return {"unit": unit, "together": together(units), "weighed": " ".join(weighed(units))}


def diagnosis_of(step: Path) -> dict[str, Any] | None:
    """The diagnosis with the estimated parameters of each effect as printed text."""
    path = step / "diagnosis" / "diagnosis.json"
    if not path.exists():
        return None
    diagnosis = json.loads(path.read_text(encoding="utf-8"))
    for item in diagnosis["candidates"]:
        item["would_be"] = expected(item["expected"], item["units"])
    return printed(diagnosis) | {"reason": printed_reason(diagnosis["reason"], read_results(step / "run"))}


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
    """All samples of the records with the models of the current step and of the one before."""
    models: dict[str, tuple[Trace, ...]] = {}
    for entry, name in zip(reversed(session.chain()), ("now", "before"), strict=False):
        run = session.step(entry["number"]) / "run"
        if (run / "result.json").exists():
            models[name] = read_results(run).traces
    result = read(session.step() / "run" / "result.json") or {"noise_floor": {}}
    return {"records": packed(models, None), "floors": result["noise_floor"]}


def read(path: Path) -> Any:
    """The content of a JSON file with printed units; None if there is no file."""
    if not path.exists():
        return None
    return printed(json.loads(path.read_text(encoding="utf-8")))


def printed(content: Any, key: str = "") -> Any:
    """JSON content with units as printed, also those in sentences."""
    if isinstance(content, dict):
        return {name: printed(item, "unit" if key == "units" else name) for name, item in content.items()}
    if isinstance(content, list):
        return [printed(item, key) for item in content]
    return PRINTERS[key](content) if key in PRINTERS and isinstance(content, str) else content


def files_in(root: Path) -> list[str]:
    """Names of the data files directly in a folder, which need not exist."""
    paths = root.iterdir() if root.is_dir() else ()
    suffixes = readers.suffixes()
    return sorted(path.name for path in paths if path.suffix.lower() in suffixes and not path.is_symlink())


def model_blocks() -> list[dict[str, Any]]:
    """The blocks of which a model can be made."""
    return [description(word) for word in blocks.usable() if not blocks.is_effect(word)]


def effects() -> list[dict[str, Any]]:
    return [description(word) for word in blocks.effects()]


def description(word: str) -> dict[str, Any]:
    place = getattr(blocks[word], "place", None)
    return {
        "name": word,
        "doc": headline(blocks[word]),
        "place": None if place is None else int(place),
        "kind": blocks.kind_of(word),
    }
