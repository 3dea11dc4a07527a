"""What the page shows of a session, read from its folders."""

from __future__ import annotations

import inspect
import json
from functools import cache
from pathlib import Path
from typing import Any

from pzt_ident.registry import blocks
from pzt_ident.report.numbers import unit
from pzt_ident.report.results import Trace, read_results
from pzt_ident.report.traces import packed
from pzt_ident.workbench.bench import Bench

DATA = (".csv", ".tsv", ".txt", ".dat", ".mat", ".h5", ".hdf5", ".npy", ".tdms", ".parquet", ".xlsx", ".ods")


def state(bench: Bench) -> dict[str, Any]:
    """Everything but the signals; empty parts where there is nothing yet."""
    chain = bench.chain()
    step = bench.step() if chain else None
    commands = bench.folder / "commands.txt"
    return {
        "version": bench.version,
        "folder": bench.relative(bench.folder),
        "blocks": chainable(),
        "effects": effects(),
        "files": files_in(bench.root),
        "steps": [about(bench, entry) for entry in chain],
        "stage": bench.stage,
        "since": bench.since,
        "failure": bench.failure,
        "job": job_of(bench) if step else None,
        "result": read(step / "run" / "result.json") if step else None,
        "misfit": read(step / "run" / "residuals.json") if step else None,
        "diagnosis": read(step / "diagnosis" / "diagnosis.json") if step else None,
        "commands": commands.read_text(encoding="utf-8").splitlines() if commands.exists() else [],
    }


def about(bench: Bench, entry: dict[str, Any]) -> dict[str, Any]:
    """A step and what its model leaves, where it was run."""
    found = read(bench.step(entry["number"]) / "run" / "result.json")
    rmse = found["best"]["rmse"] if found and found.get("best") else {"identify": None, "validate": None}
    return entry | rmse


def job_of(bench: Bench) -> dict[str, Any]:
    job = bench.job()
    folder = bench.relative(bench.step())
    return {"name": job.name, "model": job.model, "effects": job.effects, "folder": folder, "text": job.text}


def signals(bench: Bench) -> dict[str, Any]:
    """The records with the model of the step shown and of the step before, every sample of them."""
    models: dict[str, tuple[Trace, ...]] = {}
    for entry, name in zip(reversed(bench.chain()), ("now", "before"), strict=False):
        run = bench.step(entry["number"]) / "run"
        if (run / "result.json").exists():
            models[name] = read_results(run).traces
    found = read(bench.step() / "run" / "result.json") or {"noise_floor": {}}
    return {"records": packed(models, None), "floors": found["noise_floor"]}


def read(path: Path) -> Any:
    """A JSON file; None where there is none, with its units as they are printed."""
    if not path.exists():
        return None
    found = json.loads(path.read_text(encoding="utf-8"))
    return found | {"unit": unit(found["unit"])} if "unit" in found else found


def files_in(root: Path) -> list[str]:
    """Data files right in the folder that the workbench was started in."""
    return sorted(path.name for path in root.iterdir() if path.suffix.lower() in DATA and not path.is_symlink())


@cache
def chainable() -> list[dict[str, str]]:
    """Blocks that a model may be made of."""
    return [described(word) for word in blocks.words() if blocks.folder(word) != "effects"]


@cache
def effects() -> list[dict[str, str]]:
    return [described(word) for word in blocks.effects()]


def described(word: str) -> dict[str, str]:
    place = getattr(blocks[word], "place", None)
    return {"name": word, "doc": (inspect.getdoc(blocks[word]) or "").partition("\n")[0], "place": str(place or "")}
