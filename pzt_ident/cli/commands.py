"""The commands. Each imports what it needs when it runs, so that `--help` answers at once."""

from __future__ import annotations

import atexit
import gc
import io
import json
import os
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from pzt_ident.cli.control_commands import control, drive, export, tune
from pzt_ident.cli.diagnosis_commands import diagnose, diagnose_again, improve, is_diagnosis
from pzt_ident.cli.first_commands import demo, init, workbench
from pzt_ident.cli.fleet_commands import fleet, resume_fleet
from pzt_ident.cli.options import (
    EXISTING,
    Group,
    answer,
    edit_job,
    edit_options,
    no_report_flag,
    output_options,
    plugins_flag,
    run_options,
    start_option,
    write_report,
)
from pzt_ident.cli.word_commands import atlas, list_, show
from pzt_ident.errors import DamagedError, InputError

if TYPE_CHECKING:
    from pzt_ident.cli.progress import Listener
    from pzt_ident.run.place import Place


@click.group(cls=Group, context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100})
@click.version_option(package_name="pzt-ident", prog_name="pzt-ident")
@click.option("--debug", is_flag=True, help="Show where an unexpected error came from.")
def main(debug: bool) -> None:
    """Identify hysteresis models of piezo stages from measurements.

    Exit codes: 0 done, 1 failed, 2 bad input, 130 interrupted.
    """
    if sys.flags.optimize > 1:
        problem = "Python was started without docstrings, where the equations are"
        raise InputError(problem, where="PYTHONOPTIMIZE", remedy="unset it, or set it to 1")
    gc.set_threshold(20_000)  # what is imported is no garbage, and need not be looked through again and again
    atexit.register(gc.freeze)  # nor once more at the end
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # its threads wait for each other: 63 s of CPU instead of 19
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="replace")  # a terminal may lack a letter of a name


@main.command()
@click.argument("job", type=EXISTING)
@click.option("--out", type=EXISTING, help="Folder for the results; results/<name>/<time>-<hash> if not given.")
@start_option
@click.option("--no-search", is_flag=True, help="Polish the fit of --from, and let no optimizer search.")
@run_options
@plugins_flag
@output_options
def run(
    job: Path,
    out: Path | None,
    start: Path | None,
    no_search: bool,
    place: Place,
    no_report: bool,
    plugins: bool,
    as_json: bool,
    quiet: bool,
) -> None:
    """Identify the model of a job file JOB."""

    def begin(listen: Listener) -> Path:
        from pzt_ident.job.schema import load_job
        from pzt_ident.run.identify import run

        job_ = load_job(job, plugins)
        return run(job_, out, place=place, listen=listen, start=start, only_start=no_search)

    if no_search and start is None:
        raise click.UsageError("--no-search needs a fit to start from: give --from RESULT")
    _identify(begin, no_report, as_json, quiet)


@main.command()
@click.argument("folder", metavar="DIR", type=EXISTING)
@start_option
@run_options
@plugins_flag
@output_options
def resume(
    folder: Path,
    start: Path | None,
    place: Place,
    no_report: bool,
    plugins: bool,
    as_json: bool,
    quiet: bool,
) -> None:
    """Go on with the run, improvement, diagnosis or fleet in the folder DIR.

    With --from, a run polishes that fit as well, and an improvement or a diagnosis begins again from it.
    """
    if (folder / "fleet.json").is_file():
        if start is not None:
            raise click.UsageError("--from is for a run, an improvement or a diagnosis: leave it out for a fleet")
        resume_fleet(folder, place, plugins, as_json, quiet)
        return
    if is_diagnosis(folder):
        diagnose_again(folder, start, place, no_report, plugins, as_json, quiet)
        return

    def begin(listen: Listener) -> Path:
        from pzt_ident.run.identify import resume

        return resume(folder, place=place, listen=listen, plugins=plugins, start=start)

    _identify(begin, no_report, as_json, quiet)


def _identify(start: Callable[[Listener], Path], no_report: bool, as_json: bool, quiet: bool) -> None:
    from pzt_ident.cli.progress import listening
    from pzt_ident.cli.result_tables import show_result

    with listening(silent=as_json or quiet) as listen:
        folder = start(listen)
        write_report(folder, no_report)
    result = json.loads((folder / "result.json").read_text(encoding="utf-8"))
    answer({"folder": str(folder), "result": result}, lambda: show_result(result, folder), as_json, quiet)


@main.command()
@click.argument("source", metavar="JOB-or-DIR", type=EXISTING)
@click.option("--out", type=EXISTING, help="Folder for the results; DIR, or results/<name>/<time>-<hash>.")
@no_report_flag
@plugins_flag
@output_options
def compare(source: Path, out: Path | None, no_report: bool, plugins: bool, as_json: bool, quiet: bool) -> None:
    """Say where the model fails: the best run in the folder DIR, or of the job file JOB, which is run first."""
    from pzt_ident.cli.misfit_tables import show_misfits
    from pzt_ident.cli.progress import listening
    from pzt_ident.cli.table import tracked
    from pzt_ident.report.figures import write_misfit_figures
    from pzt_ident.run.misfit import compare
    from pzt_ident.run.results import read_folder

    folder = source
    if not source.is_dir():
        from pzt_ident.job.schema import load_job
        from pzt_ident.run.identify import run

        with listening(silent=as_json or quiet) as listen:
            folder = run(load_job(source, plugins), out, listen=listen)
    target = out or folder
    residuals = compare(folder, target)
    results = replace(read_folder(folder), misfit=residuals)
    _say_damaged(results.damaged)
    figures = () if no_report else write_misfit_figures(results, target / "figures")
    for _ in tracked(figures, "figures", as_json or quiet):
        pass
    if not no_report and target == folder and (folder / "report.html").exists():
        write_report(folder, no_report)
    facts = {"folder": str(target), "residuals": residuals}
    answer(facts, lambda: show_misfits(residuals), as_json, quiet)


@main.command()
@edit_options("EFFECT")
@start_option
def add(**options: Any) -> None:
    """Write a new job file: JOB with one EFFECT more, comments kept."""
    edit_job("add", **options)


@main.command()
@edit_options("EFFECT")
def remove(**options: Any) -> None:
    """Write a new job file: JOB without an EFFECT, comments kept."""
    edit_job("remove", **options)


@main.command()
@edit_options("BLOCK...", nargs=-1, required=True)
def model(**options: Any) -> None:
    """Write a new job file: JOB with these blocks as its model, comments kept."""
    edit_job("model", **options)


@main.command()
@click.argument("job", type=EXISTING)
@plugins_flag
@output_options
def check(job: Path, plugins: bool, as_json: bool, quiet: bool) -> None:
    """Say what is in a job file JOB and its data. Writes nothing."""
    from pzt_ident.cli.job_tables import show_job
    from pzt_ident.job.schema import load_job
    from pzt_ident.run.summary import summary_of

    summary = summary_of(load_job(job, plugins))
    answer(summary, lambda: show_job(summary), as_json, quiet)


def _say_damaged(sentences: tuple[str, ...]) -> None:
    for sentence in sentences:
        click.echo(f"left out: {sentence}", err=True)


@main.command()
@click.argument("folders", metavar="DIR...", nargs=-1, required=True, type=EXISTING)
@click.option("-o", "--out", type=EXISTING, help="Page of several results; side-by-side.html if not given.")
@output_options
def report(folders: tuple[Path, ...], out: Path | None, as_json: bool, quiet: bool) -> None:
    """Draw the report of each folder of results again, and every figure as PDF and SVG at 88 and 180 mm.

    Several folders are put side by side, too, on a page of their own.
    """
    from pzt_ident.cli.progress import listening
    from pzt_ident.report.figures import write_all_figures
    from pzt_ident.report.page import write_report as written
    from pzt_ident.report.side_by_side import write_side_by_side
    from pzt_ident.run.results import read_folder

    pages, readable = [], []
    for folder in folders:
        try:
            results = read_folder(folder)
        except DamagedError as error:
            if len(folders) == 1:
                raise
            click.echo(f"left out: {error}", err=True)
            continue
        _say_damaged(results.damaged)
        readable.append(folder)
        pages.append(str(written(folder)))
    with listening(silent=as_json or quiet) as listen:
        write_all_figures(readable, listen=listen)
    if len(readable) > 1:
        pages.append(str(write_side_by_side(readable, out or Path("side-by-side.html"))))
    answer({"reports": pages}, lambda: click.echo("\n".join(pages)), as_json, quiet)


MORE = (diagnose, improve, control, drive, tune, export, fleet, list_, show, atlas, init, demo, workbench)
for command in MORE:
    main.add_command(command)
