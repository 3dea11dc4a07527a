"""The commands of `pzt-ident` that fill a step."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

BETTER = 0.999  # of the run's RMSE: the fit of a diagnosis below that is handed back to the run


class Command(NamedTuple):
    """name: as the page shows it. last: the file that the command writes last. arguments: of `pzt-ident`."""

    name: str
    last: Path
    arguments: list[str]


def commands_of(
    step: Path, source: Path | None, search: bool, name_of: Callable[[Path], str], flags: Sequence[str]
) -> list[Command]:
    """Run and diagnosis of a step. source: what holds the fit that it starts from; search: whether the optimizers
    search too. name_of: a path as it is written in a command."""
    job, run, diagnosis = (name_of(step / name) for name in ("job.yaml", "run", "diagnosis"))
    started = (step / "run" / "environment.json").exists()
    start = ["--from", name_of(source), *([] if search else ["--no-search"])] if source else []
    identify = ["resume", run] if started else ["run", job, "--out", run, *start]
    more = ["--no-report", *flags]
    return [
        Command("run", step / "run" / "result.json", [*identify, *more]),
        Command(
            "diagnose",
            step / "diagnosis" / "diagnosis.json",
            ["diagnose", job, "--from", run, "--out", diagnosis, *more],
        ),
    ]


def better_fit(step: Path) -> bool:
    """Whether the diagnosis of a step found a better fit of its model than the run."""
    run, diagnosis = (
        json.loads((step / name).read_text(encoding="utf-8"))
        for name in ("run/result.json", "diagnosis/diagnosis.json")
    )
    rmse = diagnosis.get("rmse", {}).get("identify")
    return bool(rmse and diagnosis.get("parameters") and rmse < BETTER * run["best"]["rmse"]["identify"])
