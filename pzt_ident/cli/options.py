"""What all commands share: options, errors as one line, the answer as text or JSON."""

from __future__ import annotations

import errno
import json
import warnings
from collections.abc import Callable
from functools import update_wrapper
from pathlib import Path
from shlex import quote
from typing import Any

import click

from pzt_ident.errors import InputError, RunError, nearest

Command = Callable[..., None]

EXISTING = click.Path(path_type=Path)


class Failure(click.ClickException):
    """An error that is printed as one line; exit code 1."""


class BadInput(click.ClickException):
    exit_code = 2


class Interrupted(click.ClickException):
    exit_code = 130


RESULTS = "results, which `pzt-ident run` and `pzt-ident improve` write"
WHAT_IS_MISSING = {
    "JOB": "A job file: `pzt-ident init DIR` writes an example, `pzt-ident workbench DATA` makes one of measurements.",
    "JOB-or-DIR": f"A job file, or a folder of {RESULTS}.",
    "init DIR": "The folder to write into, which may be new.",
    "DIR": f"A folder of {RESULTS}.",
    "DIR...": f"Folders of {RESULTS}.",
    "RESULT": f"A folder of {RESULTS}.",
    "NAME": "A word or a key of a job: `pzt-ident list` has the words, `pzt-ident list keys` the keys.",
    "EFFECT": "The word of an effect: `pzt-ident list effects` has them all.",
    "PATTERN...": "Folders, files or a table of devices, which `pzt-ident fleet` describes.",
    "BLOCK...": "Words of blocks: `pzt-ident list blocks` has them all.",
}  # by what the usage of a command calls it


def said_missing(error: click.MissingParameter) -> str:
    """What the argument is that was not given, and where it comes from."""
    name = error.param.human_readable_name if error.param else ""
    command = error.ctx.info_name if error.ctx else ""
    return WHAT_IS_MISSING.get(f"{command} {name}", WHAT_IS_MISSING.get(name, ""))


class Group(click.Group):
    """Prints an error as one line. Exit code 2 for bad input, 1 for a failure, 130 for an interrupt."""

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        try:
            return super().resolve_command(ctx, args)
        except click.UsageError as error:
            raise click.UsageError(f"{error.message} {self.remedy(args[0])}", ctx) from None

    def remedy(self, word: str) -> str:
        """What is meant by a word that is no command: one that a command takes, or the commands that are nearest."""
        taking = (
            f"Write `pzt-ident {name} {word}`."
            for name, command in self.commands.items()
            for parameter in command.params
            if isinstance(parameter.type, click.Choice) and word in parameter.type.choices
        )
        return next(taking, nearest(word, self.commands).capitalize())

    def invoke(self, ctx: click.Context) -> Any:
        warnings.formatwarning = lambda message, *location, **options: f"Warning: {message}\n"
        try:
            return super().invoke(ctx)
        except click.MissingParameter as error:
            said = error.message or said_missing(error)
            raise click.MissingParameter(said, error.ctx, error.param, error.param_hint, error.param_type) from None
        except (click.ClickException, click.exceptions.Exit, click.Abort):
            raise
        except InputError as error:
            raise BadInput(str(error)) from None
        except RunError as error:
            raise Failure(str(error)) from None
        except KeyboardInterrupt:
            raise Interrupted("interrupted") from None
        except Exception as error:
            if ctx.params["debug"] or (isinstance(error, OSError) and error.errno == errno.EPIPE):
                raise
            raise Failure(_one_line(error)) from None


def _one_line(error: Exception) -> str:
    if isinstance(error, OSError) and error.strerror:
        return f"{error.filename}: {error.strerror}" if error.filename else error.strerror
    return f"{type(error).__name__}: {error} (`pzt-ident --debug ...` shows where)"


def output_options(command: Command) -> Command:
    """--json and --quiet."""

    def without_warnings(ctx: click.Context, parameter: click.Parameter, quiet: bool) -> bool:
        if quiet:
            ctx.with_resource(warnings.catch_warnings())
            warnings.simplefilter("ignore")
        return quiet

    text = "Say nothing but errors."
    command = click.option("--quiet", is_flag=True, callback=without_warnings, is_eager=True, help=text)(command)
    return click.option("--json", "as_json", is_flag=True, help="Write the answer to stdout as JSON.")(command)


no_report_flag = click.option("--no-report", is_flag=True, help="Write the results, draw no report and no figure.")


def plugins_flag(command: Command) -> Command:
    """--plugins, a flag: load the files that the job lists."""
    text = "Load the files that the job lists under `plugins`: they run as code."
    return click.option("--plugins", is_flag=True, help=text)(command)


def plugins_option(command: Command) -> Command:
    """--plugins FILE of a command that reads no job."""

    def load(ctx: click.Context, parameter: click.Parameter, paths: tuple[Path, ...]) -> None:
        from pzt_ident.job.schema import load_plugins

        for path in () if ctx.resilient_parsing else paths:
            load_plugins(path)

    text = "Load this Python file, or those of this job's `plugins`: they run as code. Can be given several times."
    option = click.option(
        "--plugins", metavar="JOB-or-FILE", type=EXISTING, multiple=True, callback=load, expose_value=False, help=text
    )
    return option(command)


class At(click.ParamType):
    """A place to run at: `local:4`, `tcp://scheduler:8786`, `slurm:PARTITION:8`."""

    name = "place"

    def convert(self, value: Any, param: Any, ctx: Any) -> Any:
        from pzt_ident.run.place import place_of

        return place_of(value)


def place_option(command: Command) -> Command:
    """--on, and --workers N as its short form `local:N`."""

    def place(on: Any, workers: int | None, **options: Any) -> None:
        from pzt_ident.run.place import HERE, Local

        if on and workers:
            raise InputError("says where as well", where="--workers", remedy=f"write --on local:{workers} alone")
        command(place=on or (Local(workers) if workers else HERE), **options)

    update_wrapper(place, command)
    text = "Where to run: local[:N], tcp://scheduler:8786 or slurm:PARTITION:N; all cores of this machine if not given."
    on = click.option("--on", metavar="PLACE", type=At(), help=text)
    workers = click.option("--workers", type=click.IntRange(min=1), help="N processes side by side: --on local:N.")
    return on(workers(place))


def start_option(command: Command) -> Command:
    """--from, as `start`."""
    text = "Start from the fit in this folder of a run, diagnosis or improvement, or in a JSON file of values."
    return click.option("--from", "start", metavar="RESULT", type=EXISTING, help=text)(command)


def run_options(command: Command) -> Command:
    """--on, --workers and --no-report."""
    return no_report_flag(place_option(command))


def diagnosis_options(command: Command) -> Command:
    """JOB, --out and the options of a command that looks for what a model misses."""
    text = "Folder for the results; results/<name>/<time>-<hash> if not given."
    command = start_option(no_report_flag(plugins_flag(output_options(command))))
    more = (
        "CPU time to spend, such as 60s or 5 min; 60 s or 1 ms a sample if not given. It is counted in simulations, so "
        "that the answer does not depend on the machine unless that is much slower."
    )
    command = click.option("--budget", type=Seconds(), help=more)(command)
    return click.argument("job", type=EXISTING)(click.option("--out", type=EXISTING, help=text)(command))


class Seconds(click.ParamType):
    """A time with a unit, in seconds: `60s`, `5 min`; s where none is given."""

    name = "time"

    def convert(self, value: Any, param: Any, ctx: Any) -> float:
        from pzt_ident.data.units import duration

        try:
            return duration(str(value))
        except InputError as error:
            self.fail(f"{error.message}: {error.remedy}", param, ctx)


def edit_options(metavar: str, **attributes: Any) -> Callable[[Command], Command]:
    """JOB, the effect or blocks, -o and the options of a command that writes another job file."""

    def decorate(command: Command) -> Command:
        out = click.option("-o", "--out", type=EXISTING, required=True, help="The new job file.")
        words = click.argument("words", metavar=metavar, **attributes)
        return click.argument("job", type=EXISTING)(words(out(plugins_flag(output_options(command)))))

    return decorate


def edit_job(
    name: str, job: Path, words: Any, out: Path, plugins: bool, as_json: bool, quiet: bool, **more: Any
) -> None:
    """Write another job file by the function `name` of pzt_ident.job.edit, and print what is in it."""
    from pzt_ident.job import edit
    from pzt_ident.model.registry import word_of

    new_job = getattr(edit, name)(job, words, out, plugins, **more)
    facts = {"model": [word_of(item) for item in new_job.model], "effects": list(new_job.effects)}
    contents = "; ".join(f"{key} {', '.join(words) or 'none'}" for key, words in facts.items())
    text = f"wrote {out}: {contents}\nnext: pzt-ident run {quote(str(out))}"
    answer({"job": str(out)} | facts, lambda: click.echo(text), as_json, quiet)


def answer(facts: dict[str, Any], show: Callable[[], None], as_json: bool, quiet: bool) -> None:
    if as_json:
        click.echo(json.dumps(facts, indent=2))
    elif not quiet:
        show()


def write_report(folder: Path, no_report: bool) -> None:
    """Draw the report of a folder of results, unless --no-report."""
    if not no_report:
        from pzt_ident.report.page import write_report

        write_report(folder)
