"""The command line. What a command needs is imported when it runs, so that `--help` is there at once."""

from __future__ import annotations

import io
import json
import os
import sys
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from shlex import quote
from threading import Thread
from typing import TYPE_CHECKING, Any

import click

from pzt_ident.cli import options as shell
from pzt_ident.cli.options import (
    EXISTING,
    Group,
    answer,
    diagnosing,
    edit,
    editing,
    output,
    reporting,
    searching,
    trusting,
)

if TYPE_CHECKING:
    from pzt_ident.cli.progress import Listener


@click.group(cls=Group, context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100})
@click.version_option(package_name="pzt-ident", prog_name="pzt-ident")
@click.option("--debug", is_flag=True, help="Show where an unexpected error came from.")
def main(debug: bool) -> None:
    """Identify hysteresis models of piezo stages from measurements.

    Exit codes: 0 done, 1 failed, 2 bad input, 130 interrupted.
    """
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # its threads only wait for each other: 63 s of CPU for 19
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="replace")  # a terminal may lack a letter of a name


@main.command()
@click.argument("job", type=EXISTING)
@click.option("--out", type=EXISTING, help="Folder for the results; results/<name>/<time>-<hash> if not given.")
@searching
@trusting
@output
def run(
    job: Path, out: Path | None, workers: int | None, no_report: bool, plugins: bool, as_json: bool, quiet: bool
) -> None:
    """Identify the model of a job file JOB."""

    def start(listen: Listener) -> Path:
        from pzt_ident.job.schema import load_job
        from pzt_ident.run.identify import run

        return run(load_job(job, plugins), out, workers=workers, listen=listen)

    _identify(start, no_report, as_json, quiet)


@main.command()
@click.argument("folder", metavar="DIR", type=EXISTING)
@searching
@trusting
@output
def resume(folder: Path, workers: int | None, no_report: bool, plugins: bool, as_json: bool, quiet: bool) -> None:
    """Go on with the run in the folder DIR."""

    def start(listen: Listener) -> Path:
        from pzt_ident.run.identify import resume

        return resume(folder, workers=workers, listen=listen, plugins=plugins)

    _identify(start, no_report, as_json, quiet)


def _identify(start: Callable[[Listener], Path], no_report: bool, as_json: bool, quiet: bool) -> None:
    from pzt_ident.cli.progress import listening
    from pzt_ident.cli.result_tables import show_result

    with listening(silent=as_json or quiet) as listen:

        def listen_and_prepare(event: dict[str, Any]) -> None:
            if event["event"] == "start" and not no_report:
                _import_drawing()
            listen(event)

        folder = start(listen_and_prepare)
        _report(folder, no_report)
    result = json.loads((folder / "result.json").read_text(encoding="utf-8"))
    answer({"folder": str(folder), "result": result}, lambda: show_result(result, folder), as_json, quiet)


def _import_drawing() -> None:
    """Import what draws the report while the searches run: they leave this process idle."""
    drawing = ("pandas", "matplotlib.figure", "matplotlib.backends.backend_svg", "pzt_ident.report.page")
    Thread(target=lambda: [import_module(name) for name in drawing], daemon=True).start()


def _report(folder: Path, no_report: bool) -> None:
    if not no_report:
        from pzt_ident.report.page import write_report

        write_report(folder)


@main.command()
@click.argument("source", metavar="JOB-or-DIR", type=EXISTING)
@click.option("--out", type=EXISTING, help="Folder for the results; DIR, or results/<name>/<time>-<hash>.")
@reporting
@trusting
@output
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
    there = out or folder
    residuals = compare(folder, there)
    compared = replace(read_folder(folder), misfit=residuals)
    drawn = () if no_report else write_misfit_figures(compared, there / "figures")
    for _ in tracked(drawn, "figures", as_json or quiet):
        pass
    if not no_report and there == folder and (folder / "report.html").exists():
        _report(folder, no_report)
    facts = {"folder": str(there), "residuals": residuals}
    answer(facts, lambda: show_misfits(residuals), as_json, quiet)


@main.command()
@diagnosing
def diagnose(job: Path, **options: Any) -> None:
    """Say which physical effect the model of a job file JOB misses."""
    from pzt_ident.cli import verdict_tables
    from pzt_ident.run.improve import diagnose

    _diagnose(diagnose, "diagnosis", verdict_tables.show_diagnosis, job, **options)


@main.command()
@editing("EFFECT")
def add(**options: Any) -> None:
    """Write the job file JOB with an EFFECT more, comments kept."""
    edit("add", **options)


@main.command()
@editing("EFFECT")
def remove(**options: Any) -> None:
    """Write the job file JOB with one EFFECT less, comments kept."""
    edit("remove", **options)


@main.command()
@editing("BLOCK...", nargs=-1, required=True)
def model(**options: Any) -> None:
    """Write the job file JOB with a model of these blocks, comments kept."""
    edit("model", **options)


@main.command()
@diagnosing
def improve(job: Path, **options: Any) -> None:
    """Add what the model of a job file JOB misses, effect by effect, and watch the error fall."""
    from pzt_ident.cli import verdict_tables
    from pzt_ident.run.improve import improve

    _diagnose(improve, "improvement", verdict_tables.show_improvement, job, **options)


def _diagnose(
    work: Callable[..., Path],
    name: str,
    show: Callable[[dict[str, Any], Path], None],
    job: Path,
    out: Path | None,
    no_report: bool,
    plugins: bool,
    as_json: bool,
    quiet: bool,
) -> None:
    from pzt_ident.cli.progress import listening
    from pzt_ident.job.schema import load_job

    with listening(silent=as_json or quiet) as listen:
        folder = work(load_job(job, plugins), out, listen)
        _report(folder, no_report)
    found = json.loads((folder / f"{name}.json").read_text(encoding="utf-8"))
    answer({"folder": str(folder), name: found}, lambda: show(found, folder), as_json, quiet)


@main.command()
@click.argument("job", type=EXISTING)
@trusting
@output
def check(job: Path, plugins: bool, as_json: bool, quiet: bool) -> None:
    """Say what is in a job file JOB and its data. Writes nothing."""
    from pzt_ident.cli.job_tables import show_job
    from pzt_ident.job.schema import load_job
    from pzt_ident.run.summary import summary_of

    found = summary_of(load_job(job, plugins))
    answer(found, lambda: show_job(found), as_json, quiet)


@main.command("list")
@click.argument("kind", type=click.Choice(["blocks", "effects", "optimizers"]))
@shell.plugging
@output
def list_(kind: str, as_json: bool, quiet: bool) -> None:
    """List the words that a job may use."""
    from pzt_ident.cli.table import table
    from pzt_ident.model.description import words

    found = words(kind)
    answer(found, lambda: table(("word", "what it is"), list(found.items())), as_json, quiet)


@main.command()
@click.argument("name")
@shell.plugging
@output
def show(name: str, as_json: bool, quiet: bool) -> None:
    """Show what a block, effect or optimizer declares."""
    from pzt_ident.cli.word_tables import show_word
    from pzt_ident.model.description import description_of

    found = description_of(name)
    answer(found, lambda: show_word(found), as_json, quiet)


@main.command()
@click.argument("folder", metavar="DIR", type=EXISTING)
@output
def init(folder: Path, as_json: bool, quiet: bool) -> None:
    """Write an example job and its data into the folder DIR."""
    from pzt_ident.job.example import write_example

    written = write_example(folder)
    job = folder / "job.yaml"
    said = "".join(f"wrote {path}\n" for path in written) + f"next: pzt-ident run {quote(str(job))}"
    answer({"written": [str(path) for path in written], "job": str(job)}, lambda: click.echo(said), as_json, quiet)


@main.command()
@click.option("--out", type=EXISTING, default=Path("pzt-ident-demo"), show_default=True, help="Folder to write into.")
@click.option("--no-browser", is_flag=True, help="Do not open the report.")
@output
def demo(out: Path, no_browser: bool, as_json: bool, quiet: bool) -> None:
    """Find and add what a model misses, on a measurement that ships, and open the report."""
    from pzt_ident.cli import verdict_tables
    from pzt_ident.cli.progress import listening
    from pzt_ident.job.demo import hidden, show_in_browser, write_demo
    from pzt_ident.job.schema import load_job
    from pzt_ident.report.page import write_report
    from pzt_ident.run.improve import improve

    silent, job = as_json or quiet, write_demo(out)
    if not silent:
        click.echo(f"wrote {job}, which knows of no effect, and a measurement with effects hidden in it", err=True)
    with listening(silent) as listen:
        folder = improve(load_job(job), out / "improved", listen)
        write_report(folder)
    found = json.loads((folder / "improvement.json").read_text(encoding="utf-8"))

    def say() -> None:
        verdict_tables.show_improvement(found, folder)
        click.echo(f"hidden was: {', '.join(item['effect'] for item in hidden())}")
        click.echo(f"next, with the mouse: pzt-ident workbench {quote(str(job))}")

    answer({"folder": str(folder), "improvement": found, "hidden": hidden()}, say, as_json, quiet)
    if not no_browser:
        show_in_browser(folder / "report.html")


@main.command()
@click.argument("source", metavar="[JOB or DATA]", required=False, type=EXISTING)
@click.option("--out", type=EXISTING, help="Folder of the session; workbench/<name of the file> if not given.")
@click.option("--port", type=click.IntRange(0, 65535), default=0, help="A free one if not given.")
@click.option("--host", default="127.0.0.1", show_default=True, help="Address to listen at.")
@click.option("--allow-network", is_flag=True, help="Let --host be one that other machines can reach.")
@click.option("--no-browser", is_flag=True, help="Do not open the browser.")
@trusting
def workbench(
    source: Path | None, out: Path | None, port: int, host: str, allow_network: bool, no_browser: bool, plugins: bool
) -> None:
    """See and do all of it in the browser, on a job, a measurement, or one that you drop onto the page.

    Serves files of the folder it is started in, to this machine only.
    """
    from pzt_ident.job.demo import show_in_browser
    from pzt_ident.workbench.serve import serve

    folder = out or Path("workbench") / (source.stem if source else "session")

    def ready(address: str) -> None:
        click.echo(f"workbench: {address}\nCtrl-C ends it; what was done stays in {folder}")
        if not no_browser:
            show_in_browser(address)

    with suppress(KeyboardInterrupt):
        serve(source, folder, host, port, allow_network, ready, plugins)


@main.command()
@click.argument("folders", metavar="DIR...", nargs=-1, required=True, type=EXISTING)
@click.option("-o", "--out", type=EXISTING, help="Page of several results; side-by-side.html if not given.")
@output
def report(folders: tuple[Path, ...], out: Path | None, as_json: bool, quiet: bool) -> None:
    """Draw the report of each folder of results again, and every figure as PDF and SVG at 88 and 180 mm.

    Several folders are put side by side, too, on a page of their own.
    """
    from pzt_ident.cli.table import tracked
    from pzt_ident.report.figures import write_paper_figures
    from pzt_ident.report.page import write_report
    from pzt_ident.report.side_by_side import write_side_by_side
    from pzt_ident.run.results import read_folder

    pages = []
    for folder in folders:
        pages.append(str(write_report(folder)))
        for _ in tracked(write_paper_figures(read_folder(folder), folder / "figures"), "figures", as_json or quiet):
            pass
    if len(folders) > 1:
        pages.append(str(write_side_by_side(folders, out or Path("side-by-side.html"))))
    answer({"reports": pages}, lambda: click.echo("\n".join(pages)), as_json, quiet)
