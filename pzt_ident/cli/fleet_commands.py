"""The commands on many devices: `fleet`, `fleet report`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from pzt_ident.cli.options import EXISTING, Seconds, answer, output_options, place_option, plugins_flag

if TYPE_CHECKING:
    from pzt_ident.run.place import Place


class Fleet(click.Group):
    """`fleet JOB PATTERN...` beside `fleet report DIR`: what is no command of it is a job."""

    def resolve_command(self, ctx: click.Context, args: list[str]) -> Any:
        from pzt_ident.errors import InputError, nearest

        word = args[0]
        meant = nearest(word, [name for name, command in self.commands.items() if not command.hidden])
        is_word = word not in self.commands and not Path(word).suffix and not Path(word).exists()
        if is_word and meant.startswith("did you mean"):
            raise InputError("no such job and no such command", where=repr(word), remedy=meant)
        return super().resolve_command(ctx, args if word in self.commands else ["JOB", *args])

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Both, the options of the first below it."""
        with formatter.section("Usage"):
            formatter.write_text("pzt-ident fleet JOB PATTERN... [OPTIONS]\n\npzt-ident fleet report DIR [OPTIONS]")
        self.commands["JOB"].format_options(ctx, formatter)


@click.group(
    cls=Fleet,
    context_settings={"ignore_unknown_options": True, "allow_interspersed_args": False},
    subcommand_metavar="JOB PATTERN... | report DIR",
    no_args_is_help=True,
)
def fleet() -> None:
    """Identify the model of a job file JOB on every device.

    PATTERN: folders that hold the files of the job's records by name ('lot/*/'), files ('lot/*.csv'), or a table with a
    column `file` or `folder`, and others such as temperature or serial number. Into a folder that holds the fleet
    already, what was done is not done again. `fleet report DIR` draws the report on the devices in DIR.
    """


class Identify(click.Command):
    """A command whose first argument is its name."""

    def collect_usage_pieces(self, ctx: click.Context) -> list[str]:
        return [piece for piece in super().collect_usage_pieces(ctx) if piece]


@fleet.command("JOB", cls=Identify, hidden=True)
@click.argument("job", metavar="", type=EXISTING)
@click.argument("patterns", metavar="PATTERN...", nargs=-1, required=True)
@click.option("--out", type=EXISTING, help="Folder for the results; results/<name>/fleet if not given.")
@click.option("--improve", is_flag=True, help="Diagnose each device, and add what its model misses.")
@click.option("--budget", type=Seconds(), help="CPU time of each diagnosis, as of `pzt-ident improve`.")
@place_option
@plugins_flag
@output_options
def identify(
    job: Path,
    patterns: tuple[str, ...],
    out: Path | None,
    improve: bool,
    budget: float | None,
    place: Place,
    plugins: bool,
    as_json: bool,
    quiet: bool,
) -> None:
    """Identify the model of a job file JOB on every device that the patterns or tables name."""
    from pzt_ident.cli.progress import listening
    from pzt_ident.errors import InputError
    from pzt_ident.job.schema import load_job
    from pzt_ident.lot.identify import fleet

    if swapped := next((pattern for pattern in patterns if is_job(Path(pattern)) and not is_job(job)), None):
        remedy = f"the job comes first: `pzt-ident fleet {swapped} PATTERN...`"
        raise InputError("is no job file", where=str(job), remedy=remedy)
    if budget is not None and not improve:
        raise InputError("is the time of each diagnosis", where="--budget", remedy="add --improve, or leave it out")
    with listening(silent=as_json or quiet) as listen:
        loaded = load_job(job, plugins)
        folder = fleet(loaded, patterns, out, improve=improve, budget=budget, place=place, listen=listen)
    show_fleet(folder, as_json, quiet)


def is_job(path: Path) -> bool:
    return path.suffix.lower() in (".yaml", ".yml") and path.is_file()


def resume_fleet(folder: Path, place: Place, plugins: bool, as_json: bool, quiet: bool) -> None:
    from pzt_ident.cli.progress import listening
    from pzt_ident.lot.identify import resume

    with listening(silent=as_json or quiet) as listen:
        resume(folder, place=place, listen=listen, plugins=plugins)
    show_fleet(folder, as_json, quiet)


def show_fleet(folder: Path, as_json: bool, quiet: bool) -> None:
    """What a fleet came to. Ends with exit code 1 where no device could be identified."""
    from shlex import quote

    from pzt_ident.errors import RunError
    from pzt_ident.lot.outcome import read_lot

    lot = read_lot(folder)
    facts = {"folder": str(folder), "table": str(folder / "devices.csv"), **lot.summary()}
    lines = [*lot.sentences(), f"table: {folder / 'devices.csv'}"]
    lines += [f"next: pzt-ident fleet report {quote(str(folder))}"] * bool(lot.done)
    answer(facts, lambda: click.echo("\n".join(lines)), as_json, quiet)
    if not lot.done:
        raise RunError("no device could be identified")


@fleet.command("report")
@click.argument("folder", metavar="DIR", type=EXISTING)
@place_option
@output_options
def report(folder: Path, place: Place, as_json: bool, quiet: bool) -> None:
    """Draw the report on the devices in the folder DIR: spreads, devices out of line, what depends on what."""
    from pzt_ident.cli.progress import listening
    from pzt_ident.lot.report import write_fleet_report

    with listening(silent=as_json or quiet) as listen:
        page = write_fleet_report(folder, place=place, listen=listen)
    answer({"report": str(page)}, lambda: click.echo(f"report: {page}"), as_json, quiet)
