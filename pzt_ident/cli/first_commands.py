"""The commands to start with: example job, demonstration, workbench."""

from __future__ import annotations

import json
from contextlib import suppress
from pathlib import Path
from shlex import quote

import click

from pzt_ident.cli.options import EXISTING, answer, output_options, plugins_flag


@click.command()
@click.argument("folder", metavar="DIR", type=EXISTING)
@output_options
def init(folder: Path, as_json: bool, quiet: bool) -> None:
    """Write an example job and its data into the folder DIR."""
    from pzt_ident.job.example import write_example

    written = write_example(folder)
    job = folder / "job.yaml"
    text = "".join(f"wrote {path}\n" for path in written) + f"next: pzt-ident run {quote(str(job))}"
    answer({"written": [str(path) for path in written], "job": str(job)}, lambda: click.echo(text), as_json, quiet)


@click.command()
@click.option("--out", type=EXISTING, default=Path("pzt-ident-demo"), show_default=True, help="Folder to write into.")
@click.option("--no-browser", is_flag=True, help="Do not open the report.")
@output_options
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
        click.echo(f"wrote {job}, a job without effects, and a measurement with hidden effects", err=True)
    with listening(silent) as listen:
        folder = improve(load_job(job), out / "improved", listen)
        write_report(folder)
    improvement = json.loads((folder / "improvement.json").read_text(encoding="utf-8"))

    def show() -> None:
        verdict_tables.show_improvement(improvement, folder)
        click.echo(f"hidden effects: {', '.join(item['effect'] for item in hidden())}")
        click.echo(f"next, with the mouse: pzt-ident workbench {quote(str(job))}")

    answer({"folder": str(folder), "improvement": improvement, "hidden": hidden()}, show, as_json, quiet)
    if not no_browser:
        show_in_browser(folder / "report.html")


@click.command()
@click.argument("source", metavar="[JOB, DATA or FLEET]", required=False, type=EXISTING)
@click.option("--out", type=EXISTING, help="Folder of the session; workbench/<name of the file> if not given.")
@click.option("--port", type=click.IntRange(0, 65535), default=0, help="A free port if not given.")
@click.option("--host", default="127.0.0.1", show_default=True, help="Address to listen at.")
@click.option("--allow-network", is_flag=True, help="Let --host be one that other machines can reach.")
@click.option("--no-browser", is_flag=True, help="Do not open the browser.")
@plugins_flag
def workbench(
    source: Path | None, out: Path | None, port: int, host: str, allow_network: bool, no_browser: bool, plugins: bool
) -> None:
    """See and do all of it in the browser: a job, a measurement, a fleet, or a file that you drop onto the page.

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
