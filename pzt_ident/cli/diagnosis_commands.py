"""The commands that say what is missing: `diagnose`, `improve`."""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from pzt_ident.cli.options import answer, diagnosis_options, place_option, write_report

if TYPE_CHECKING:
    from pzt_ident.cli.progress import Listener
    from pzt_ident.run.place import Place


@click.command()
@diagnosis_options
@place_option
def diagnose(job: Path, place: Place, **options: Any) -> None:
    """Say which physical effect the model of a job file JOB misses."""
    from pzt_ident.cli import verdict_tables
    from pzt_ident.run.elsewhere import sought_at

    _diagnose(partial(sought_at, place, "diagnose"), "diagnosis", verdict_tables.show_diagnosis, job, **options)


@click.command()
@diagnosis_options
@place_option
def improve(job: Path, place: Place, **options: Any) -> None:
    """Add what the model of a job file JOB misses, effect by effect, and watch the error fall."""
    from pzt_ident.cli import verdict_tables
    from pzt_ident.run.elsewhere import sought_at

    _diagnose(partial(sought_at, place, "improve"), "improvement", verdict_tables.show_improvement, job, **options)


def _diagnose(
    function: Callable[..., Path],
    name: str,
    show: Callable[[dict[str, Any], Path], None],
    job: Path,
    out: Path | None,
    start: Path | None,
    no_report: bool,
    plugins: bool,
    budget: float | None,
    as_json: bool,
    quiet: bool,
) -> None:
    from pzt_ident.job.schema import load_job

    def begin(listen: Listener) -> Path:
        return function(load_job(job, plugins), out, listen, budget, start)

    _show_diagnosis(begin, name, show, no_report, as_json, quiet)


def _show_diagnosis(
    start: Callable[[Listener], Path],
    name: str,
    show: Callable[[dict[str, Any], Path], None],
    no_report: bool,
    as_json: bool,
    quiet: bool,
) -> None:
    from pzt_ident.cli.progress import listening

    with listening(silent=as_json or quiet) as listen:
        folder = start(listen)
        write_report(folder, no_report)
    verdict = json.loads((folder / f"{name}.json").read_text(encoding="utf-8"))
    answer({"folder": str(folder), name: verdict}, lambda: show(verdict, folder), as_json, quiet)


def is_diagnosis(folder: Path) -> bool:
    from pzt_ident.run.elsewhere import task_of

    return (folder / "environment.json").is_file() and task_of(folder) in ("improve", "diagnose")


def diagnose_again(
    folder: Path, start: Path | None, place: Place, no_report: bool, plugins: bool, as_json: bool, quiet: bool
) -> None:
    """From its beginning, unless it came to its end and there is no other fit to start from."""
    from pzt_ident.cli import verdict_tables
    from pzt_ident.run.elsewhere import begin_again, task_of

    improves = task_of(folder) == "improve"
    name, show = (
        ("improvement", verdict_tables.show_improvement) if improves else ("diagnosis", verdict_tables.show_diagnosis)
    )

    def begin(listen: Listener) -> Path:
        return begin_again(folder, listen, plugins, place, start)

    _show_diagnosis(begin, name, show, no_report, as_json, quiet)
