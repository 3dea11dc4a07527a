"""What all commands share: options, errors in one clear line, the answer as text or JSON."""

from __future__ import annotations

import errno
import json
import warnings
from collections.abc import Callable
from pathlib import Path
from shlex import quote
from typing import Any

import click

from pzt_ident.errors import InputError, RunError

Command = Callable[..., None]

EXISTING = click.Path(path_type=Path)


class Failure(click.ClickException):
    """One line on stderr; ends with exit code 1."""


class BadInput(click.ClickException):
    exit_code = 2


class Interrupted(click.ClickException):
    exit_code = 130


class Group(click.Group):
    """Turns errors into one clear line: exit code 2 for bad input, 1 for a failure, 130 for an interrupt."""

    def invoke(self, ctx: click.Context) -> Any:
        warnings.formatwarning = lambda message, *place, **more: f"Warning: {message}\n"
        try:
            return super().invoke(ctx)
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
            raise Failure(_in_a_line(error)) from None


def _in_a_line(error: Exception) -> str:
    if isinstance(error, OSError) and error.strerror:
        return f"{error.filename}: {error.strerror}" if error.filename else error.strerror
    return f"{type(error).__name__}: {error} (`pzt-ident --debug ...` shows where)"


def output(command: Command) -> Command:
    """--json and --quiet."""
    command = click.option("--quiet", is_flag=True, help="Say nothing but errors.")(command)
    return click.option("--json", "as_json", is_flag=True, help="Write the answer to stdout as JSON.")(command)


reporting = click.option("--no-report", is_flag=True, help="Write the results, draw no report and no figure.")


def trusting(command: Command) -> Command:
    """--plugins."""
    said = "Load the files that the job lists under `plugins`: they run as code."
    return click.option("--plugins", is_flag=True, help=said)(command)


def plugging(command: Command) -> Command:
    """--plugins of a command that reads no job."""

    def load(ctx: click.Context, option: click.Parameter, paths: tuple[Path, ...]) -> None:
        from pzt_ident.job.schema import load_plugins

        for path in () if ctx.resilient_parsing else paths:
            load_plugins(path)

    said = "Load this Python file, or those of this job's `plugins`: they run as code. Can be given several times."
    several = click.option(
        "--plugins", metavar="JOB-or-FILE", type=EXISTING, multiple=True, callback=load, expose_value=False, help=said
    )
    return several(command)


def searching(command: Command) -> Command:
    """--workers and --no-report."""
    command = reporting(command)
    workers = click.IntRange(min=1)
    return click.option("--workers", type=workers, help="Processes side by side; all cores if not given.")(command)


def diagnosing(command: Command) -> Command:
    """JOB, --out and the options of a command that looks for what a model misses."""
    said = "Folder for the results; results/<name>/<time>-<hash> if not given."
    command = reporting(trusting(output(command)))
    return click.argument("job", type=EXISTING)(click.option("--out", type=EXISTING, help=said)(command))


def editing(metavar: str, **more: Any) -> Callable[[Command], Command]:
    """JOB, the words of its change, -o and the options of a command that writes another job file."""

    def decorate(command: Command) -> Command:
        new = click.option("-o", "--out", type=EXISTING, required=True, help="The new job file.")
        words = click.argument("words", metavar=metavar, **more)
        return click.argument("job", type=EXISTING)(words(new(trusting(output(command)))))

    return decorate


def edit(name: str, job: Path, words: Any, out: Path, plugins: bool, as_json: bool, quiet: bool) -> None:
    """Write another job file by the function of `amend` with this name, and say what is in it."""
    from pzt_ident.job import edit as edit
    from pzt_ident.model.registry import word_of

    made = getattr(edit, name)(job, words, out, plugins)
    facts = {"model": [word_of(item) for item in made.model], "effects": list(made.effects)}
    held = "; ".join(f"{key} {', '.join(named) or 'none'}" for key, named in facts.items())
    said = f"wrote {out}: {held}\nnext: pzt-ident run {quote(str(out))}"
    answer({"job": str(out)} | facts, lambda: click.echo(said), as_json, quiet)


def answer(found: dict[str, Any], say: Callable[[], None], as_json: bool, quiet: bool) -> None:
    if as_json:
        click.echo(json.dumps(found, indent=2))
    elif not quiet:
        say()
