"""The state of a session for the page, read from its folders."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from pzt_ident.atlas.href import href
from pzt_ident.data.notation import spelled, unit
from pzt_ident.data.over_axes import together, weighed
from pzt_ident.data.readers.registry import readers
from pzt_ident.data.signals import Trace
from pzt_ident.diagnosis.ties import differ
from pzt_ident.errors import InputError
from pzt_ident.model.description import description_of, summary, words
from pzt_ident.model.registry import blocks, phrase_of, word_of
from pzt_ident.report.decimation import decimate
from pzt_ident.report.sentences import printed_reason
from pzt_ident.report.tables import expected
from pzt_ident.report.traces import packed
from pzt_ident.run.results import read_results
from pzt_ident.workbench import downloads
from pzt_ident.workbench.guard import LARGEST_UPLOAD
from pzt_ident.workbench.measurement import WHOLE, encoded
from pzt_ident.workbench.session import Session
from pzt_ident.workbench.step_model import model_of
from pzt_ident.workbench.wording import in_page_words

ATLAS = "/atlas"
PRINTERS = {"unit": unit} | dict.fromkeys(("reason", "why", "said", "sentences"), spelled)


def state(session: Session) -> dict[str, Any]:
    """The whole state except the signals; parts without results are None or empty."""
    chain = session.chain()
    step = session.step() if chain else None
    job = job_of(session) if step else None  # read first: its plugins may register blocks
    return {
        "folder": session.relative(session.folder),
        "largest": LARGEST_UPLOAD,
        "blocks": model_blocks(),
        "effects": effects(),
        "optimizer_words": optimizer_words(),
        "files": [*files_in(session.root), *(session.relative(session.data / name) for name in files_in(session.data))],
        "steps": [step_state(session, entry) for entry in chain],
        "others": [step_state(session, entry) for entry in session.steps if entry not in chain],
        "at": session.at,
        "warning": session.warning,
        "draft": session.draft,
        **over_axes(session),
        "job": job,
        "result": read(step / "run" / "result.json") if step else None,
        "misfit": read(step / "run" / "residuals.json") if step else None,
        "diagnosis": diagnosis_of(session, step) if step else None,
        "parameters": parameters(session, step) if step else [],
        "optimizers": optimizers(session),
        "improving": improving(step) if step else None,
        "control": read(step / "control" / "control.json") if step else None,
        "downloads": downloads.names(session),
        "commands": session.logged_commands(),
    }


def step_state(session: Session, entry: dict[str, Any]) -> dict[str, Any]:
    """A step, the RMSE of its model by use, None if it was not run, that of the identification records in noise
    floors, and what the diagnosis before promised."""
    result = read(session.step(entry["number"]) / "run" / "result.json")
    rmse = result["best"]["rmse"] if result and result.get("best") else {"identify": None, "validate": None}
    floors = rmse["identify"] / result["floor"] if rmse["identify"] is not None and result.get("floor") else None
    return {"promised": None, "note": ""} | entry | rmse | {"floors": floors}


def optimizers(session: Session) -> list[dict[str, Any]]:
    """The comparison of the optimizers in the newest run of the chain in which some searched, the best first. `equal`:
    whether its fits are as good as the best of all, within the noise."""
    for entry in reversed(session.chain()):
        result = read(session.step(entry["number"]) / "run" / "result.json")
        if result and result.get("league"):
            errors = [min(row["rmse_best"], row["polished_rmse_median"]) for row in result["league"]]
            equal = [not differ(error, min(errors), result["floor"]) for error in errors]
            return [row | {"equal": same} for row, same in zip(result["league"], equal, strict=True)]
    return []


def improving(step: Path) -> dict[str, Any] | None:
    """The steps that an improvement of this step has taken so far, None where none was asked for."""
    path = step / "improved" / "events.jsonl"
    if not path.exists():
        return None
    lines = [line for line in path.read_text(encoding="utf-8").splitlines() if line.endswith("}")]
    stairs = [stair for line in lines if (stair := json.loads(line))["event"] == "stair"]
    return {"steps": [printed(stair) for stair in stairs]}


def tracking(path: Path) -> dict[str, Any]:
    """The columns of a comparison of ways to follow a reference, by heading, as 32-bit floats, of long ones the
    extremes. Raises InputError where there is none."""
    import pandas as pd

    if not path.exists():
        raise InputError("nothing follows a reference yet", remedy="drop a reference")
    frame = pd.read_csv(path)
    positions = decimate(frame.iloc[:, 1].to_numpy(float), WHOLE // 2)
    columns = {name: encoded(frame[name].to_numpy("<f4")[positions]) for name in frame}
    return {"samples": len(frame), "columns": columns}


def over_axes(session: Session) -> dict[str, str]:
    """Unit, name suffix and explanation of errors over all axes, from the newest step that has a result."""
    results = (read(session.step(entry["number"]) / "run" / "result.json") for entry in reversed(session.steps))
    newest: dict[str, Any] = next(filter(None, results), {})
    units = newest.get("units", {})
    unit = newest["unit"] or "1" if newest else ""
    return {"unit": unit, "together": together(units), "weighed": " ".join(weighed(units))}


def parameters(session: Session, step: Path) -> list[dict[str, Any]]:
    """Those of the model of a step, each with the link to its block in the atlas."""
    rows = printed(model_of(step, session.plugins).parameters)
    return [row | {"about": href(row["block"], ATLAS)} for row in rows]


def diagnosis_of(session: Session, step: Path) -> dict[str, Any] | None:
    """The diagnosis with the estimated parameters of each effect as printed text."""
    path = step / "diagnosis" / "diagnosis.json"
    if not path.exists():
        return None
    diagnosis = json.loads(path.read_text(encoding="utf-8"))
    for candidate in diagnosis["candidates"]:
        candidate["estimate"] = expected(candidate["expected"], candidate["units"])
        candidate["about"] = href(candidate.get("item", candidate["effect"]), ATLAS)
    tied = (sentence for sentence in tied_sentences(session) if sentence not in diagnosis["reason"])
    reason = printed_reason(diagnosis["reason"] + "".join(tied), read_results(step / "run"))
    return printed(diagnosis) | {"reason": in_page_words(reason.replace("`", ""))}


def tied_sentences(session: Session) -> list[str]:
    """What stays undecided of effects that were added where others would have fitted as well."""
    effects = list(map(word_of, session.job().effects))
    tied = [entry["tied"] for entry in session.chain() if set(entry.get("tied", ())) & set(effects)]
    return [f" These data cannot tell {' from '.join(map(phrase_of, words))}." for words in tied]


def job_of(session: Session) -> dict[str, Any]:
    job = session.job()
    folder = session.relative(session.step())
    return {
        "name": job.name,
        "model": [word_of(item) for item in job.model],
        "effects": job.effects,
        "folder": folder,
        "text": job.text,
        "limits": asdict(job.limits),
        "drive_units": drive_units(session),
        "files": list(dict.fromkeys(Path(record.file).name for record in job.records)),
        "search": {
            "optimizers": [{"name": item.name, **item.settings} for item in job.optimizers],
            "repeats": job.repeats,
            "seed": job.seed,
        },
    }


def drive_units(session: Session) -> dict[str, str]:
    """Of each axis as printed."""
    record = model_of(session.step(), session.plugins).statement.records[0]
    return dict(zip(record.axes, map(unit, record.drive_units), strict=True))


def signals(session: Session, numbers: Sequence[int] = ()) -> dict[str, Any]:
    """All samples of the records with the models of the current step and of the one before, or of the steps of these
    numbers."""
    models: dict[str, tuple[Trace, ...]] = {}
    steps = numbers or [entry["number"] for entry in reversed(session.chain())]
    for number, name in zip(steps, ("now", "before"), strict=False):
        run = session.step(number) / "run"
        if (run / "result.json").exists():
            models[name] = read_results(run).traces
    result = read(session.step() / "run" / "result.json") or {"noise_floor": {}}
    return {"records": packed(models, None), "floors": result["noise_floor"]}


def read(path: Path) -> Any:
    """The content of a JSON file with printed units; None if there is no file, or a damaged one."""
    try:
        return printed(json.loads(path.read_text(encoding="utf-8"))) if path.exists() else None
    except ValueError:
        return None


def printed(content: Any, key: str = "") -> Any:
    """JSON content with units as printed, also those in sentences."""
    if isinstance(content, dict):
        return {name: printed(value, "unit" if key == "units" else name) for name, value in content.items()}
    if isinstance(content, list):
        return [printed(value, key) for value in content]
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


def optimizer_words() -> list[dict[str, Any]]:
    """The optimizers with the defaults of their settings."""
    settings = {
        word: {setting["name"]: setting["default"] for setting in description_of(word)["settings"]}
        for word in words("optimizers")
    }
    return [
        {"name": word, "doc": doc, "about": href(word, ATLAS), "settings": settings[word]}
        for word, doc in words("optimizers").items()
    ]


def description(word: str) -> dict[str, Any]:
    place = getattr(blocks[word], "place", None)
    return {
        "name": word,
        "about": href(word, ATLAS),
        "forms": {item: href(item, ATLAS) for item in blocks.forms(word)[1:]},
        "doc": summary(blocks[word]),
        "place": None if place is None else int(place),
        "kind": blocks.kind_of(word),
    }
