"""What a person sees on the terminal: one live progress display, and tables."""

from __future__ import annotations

import math
import signal
import sys
import time
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from shlex import quote
from typing import Any, Protocol, TextIO

import click

SECONDS_BETWEEN_LINES = 5.0

Event = dict[str, Any]
Row = Sequence[object]


class Listener(Protocol):
    def __call__(self, event: Event, /) -> None: ...


@dataclass
class Progress:
    """How far the runs of a job are, from its events."""

    budget: int = 0
    unit: str = ""
    best: float = math.inf
    folder: str = ""
    activity: str = ""
    evaluations: dict[str, int] = field(default_factory=dict)
    first: tuple[float, int] | None = None

    def take(self, event: Event) -> None:
        if event["event"] == "start":
            self.budget, self.unit, self.folder = event["budget"], event["unit"], event.get("folder", "")
            self.evaluations = dict.fromkeys(event["runs"], 0)
        elif event["event"] == "generation":
            self.evaluations[event["run"]] = event["evaluations"]
            self.best = min(self.best, event["best"])
            self.first = self.first or (time.perf_counter(), self.done)
        elif event["event"] in ("run", "failed") and self.evaluations:
            self.evaluations[event["run"]] = self.budget // len(self.evaluations)
        elif "said" in event:
            self.activity = event["said"]

    @property
    def done(self) -> int:
        return sum(self.evaluations.values())

    def seconds_left(self) -> float | None:
        """What is left at the pace since the first generation; None before there is one."""
        if self.first is None or self.done <= self.first[1]:
            return None
        since, before = self.first
        return (time.perf_counter() - since) * (self.budget - self.done) / (self.done - before)

    def __str__(self) -> str:
        if not self.budget:
            return self.activity or "finishing"
        left = self.seconds_left()
        ahead = "finishing" if self.done >= self.budget else "" if left is None else f"{duration(left)} left"
        share = f"{100 * self.done / self.budget:.0f} %: {self.done} of {self.budget} evaluations"
        said = f"{share}, best RMSE {number(self.best)} {self.unit}"
        return f"{said}, {ahead}" if ahead else said


@contextmanager
def listening(silent: bool) -> Iterator[Listener]:
    """A listener for the events of a run: a live bar on a terminal, else a line every few seconds, on stderr.

    An interrupt, SIGTERM (a cluster's scheduler sends it) or a full disk is followed by how to go on.
    """
    progress = Progress()
    before = signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        if silent:
            yield progress.take
        elif _is_terminal(sys.stderr):
            with _bar(progress) as listener:
                yield listener
        else:
            yield _lines(progress)
    except (KeyboardInterrupt, OSError):
        if progress.folder and not silent:
            click.echo(f"`pzt-ident resume {quote(progress.folder)}` goes on from here", err=True)
        raise
    finally:
        signal.signal(signal.SIGTERM, before)


def _is_terminal(stream: TextIO | None) -> bool:
    """Whether a person looks at it; None where the process was started with the stream closed."""
    return stream is not None and stream.isatty()


def _lines(progress: Progress) -> Listener:
    shown = time.perf_counter()

    def listen(event: Event) -> None:
        nonlocal shown
        progress.take(event)
        if said := _said(event):
            click.echo(said, err=True)
        elif time.perf_counter() - shown >= SECONDS_BETWEEN_LINES:
            shown = time.perf_counter()
            click.echo(progress, err=True)

    return listen


@contextmanager
def _bar(progress: Progress) -> Iterator[Listener]:
    from rich.console import Console
    from rich.progress import BarColumn, TextColumn
    from rich.progress import Progress as Bar

    with Bar(BarColumn(), TextColumn("{task.description}"), console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("reading", total=None)

        def listen(event: Event) -> None:
            progress.take(event)
            if said := _said(event):
                bar.console.print(said, markup=False, highlight=False)
            bar.update(task, total=progress.budget or None, completed=progress.done, description=str(progress))

        yield listen


def _said(event: Event) -> str:
    """An event in words, where it is worth some."""
    if event["event"] == "finished":
        return "every run is finished: nothing is searched again"
    if event["event"] == "stair":
        return str(event["said"])
    return _failed(event) if event["event"] == "failed" else ""


def _failed(event: Event) -> str:
    return f"{event['run']} failed: {event['reason']}"


def duration(seconds: float) -> str:
    """Seconds as a person reads them: `8 s`, `2 min 5 s`, `1 h 20 min`."""
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60} s"
    return f"{whole // 3600} h {whole % 3600 // 60} min"


def number(value: float | None) -> str:
    """Four digits; a dash where there is none."""
    return "-" if value is None or not math.isfinite(value) else f"{value:.4g}"


def table(header: Sequence[str], rows: Sequence[Row]) -> None:
    """Columns under their headings on stdout, set by rich on a terminal and by blanks elsewhere; no word is cut."""
    cells = [["" if cell is None else str(cell) for cell in row] for row in rows]
    if _is_terminal(sys.stdout):
        from rich.box import SIMPLE_HEAD
        from rich.console import Console
        from rich.table import Table
        from rich.text import Text

        drawn = Table(box=SIMPLE_HEAD)
        for heading in header:
            drawn.add_column(Text(heading))
        for row in cells:
            drawn.add_row(*map(Text, row))
        console = Console()
        least = console.measure(drawn, options=console.options.update_width(1000)).minimum
        console.width = max(console.width, least)
        console.print(drawn)
        return
    widths = [max(map(len, column)) for column in zip(header, *cells, strict=True)]
    for row in [list(header), *cells]:
        click.echo("  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip())
    click.echo()


def show_result(result: dict[str, Any], folder: Path) -> None:
    """The league of optimizers, the best run's parameters, the noise floor, and where the rest is."""
    unit, best = result["unit"], result["best"]
    table(
        ("optimizer", "runs", f"best RMSE [{unit}]", f"median [{unit}]", f"median polished [{unit}]", "time [s]"),
        [
            (row["optimizer"], row["runs"], *(number(row[key]) for key in _LEAGUE), number(row["seconds_median"]))
            for row in result["league"]
        ],
    )
    table(
        ("parameter", "value", "standard error", "unit", "verdict"),
        [
            (name, number(item["value"]), number(item["standard_error"]), item["unit"], item["verdict"])
            for name, item in best["parameters"].items()
        ],
    )
    click.echo(f"RMSE [{unit}]: {_uses(best['rmse'])} ({best['run']})")
    for axis, floor in result["noise_floor"].items():
        click.echo(f"noise floor of {axis} [{unit}]: {number(floor)}")
    show_notes(result["records"])
    for run in result["failed_runs"]:
        click.echo(_failed(run))
    page = folder / "report.html"
    click.echo(f"report: {page}" if page.exists() else f"results: {folder}")


def show_notes(records: Iterable[dict[str, Any]]) -> None:
    """What there is to know of each record."""
    for record in records:
        for note in record["notes"]:
            click.echo(f"{record['name']}: {note}")


_LEAGUE = ("rmse_best", "rmse_median", "polished_rmse_median")


def _uses(rmse: dict[str, float | None]) -> str:
    return ", ".join(f"{number(value)} {use}" for use, value in rmse.items())


def tracked(items: Iterable[Any], what: str, silent: bool) -> Iterator[Any]:
    """The items, counted on a terminal while they come; nothing is said elsewhere."""
    if silent or not _is_terminal(sys.stdout):
        yield from items
        return
    from rich.progress import track

    yield from track(items, what, transient=True)
