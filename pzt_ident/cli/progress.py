"""The progress of a run on the terminal: a live bar, or a line every few seconds."""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass, field
from shlex import quote
from typing import Any, Protocol

import click

from pzt_ident.cli.table import is_terminal, number
from pzt_ident.errors import LostError
from pzt_ident.run.interrupts import interrupts_heard

SECONDS_BETWEEN_LINES = 5.0
SENTENCES = {"stair", "cluster", "damaged", "gone", "other", "stale", "kept", "table", "undrawn", "alike", "untold"}
"""Events that are printed as what they say."""

Event = dict[str, Any]
Row = Sequence[object]


class Listener(Protocol):
    def __call__(self, event: Event, /) -> None: ...


@dataclass
class Progress:
    """The progress of the runs of a job, from its events."""

    budget: int = 0
    what: str = "evaluations"
    broken: int = 0
    unit: str = ""
    together: str = ""
    best: float = math.inf
    folder: str = ""
    activity: str = ""
    evaluations: dict[str, int] = field(default_factory=dict)
    first: tuple[float, int] | None = None

    def take(self, event: Event) -> None:
        if event["event"] == "start":
            self.budget, self.unit, self.folder = event["budget"], event["unit"], event.get("folder", "")
            self.together = event["together"]
            self.evaluations = dict.fromkeys(event["runs"], 0)
        elif event["event"] in ("devices", "pages", "figures"):
            self.what, self.budget, self.folder = event["event"], event["of"], event["folder"]
            self.broken = event.get("broken", 0)
            self.evaluations = {"": event["done"] + self.broken}
            self.first = self.first or (time.perf_counter(), self.done)
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
        """The time left at the rate since the first generation; None before there is one."""
        if self.first is None or self.done <= self.first[1]:
            return None
        since, before = self.first
        return (time.perf_counter() - since) * (self.budget - self.done) / (self.done - before)

    def __str__(self) -> str:
        if not self.budget:
            return self.activity or "finishing"
        left = self.seconds_left()
        time_left = "finishing" if self.done >= self.budget else "" if left is None else f"{duration(left)} left"
        share = f"{100 * self.done / self.budget:.0f} %: {self.done} of {self.budget} {self.what}"
        best = f", best RMSE{self.together} {number(self.best)} {self.unit}" if self.what == "evaluations" else ""
        text = f"{share}{best}{f', {self.broken} broken' if self.broken else ''}"
        return f"{text}, {time_left}" if time_left else text


@contextmanager
def listening(silent: bool) -> Iterator[Listener]:
    """A listener for the events of a run: a live bar on a terminal, else a line every few seconds, on stderr.

    After an interrupt, SIGTERM (sent by the scheduler of a cluster), a full disk or the loss of a cluster, it prints
    how to resume the run.
    """
    progress = Progress()
    shown = nullcontext(progress.take) if silent else _bar(progress) if is_terminal(sys.stderr) else _lines(progress)
    try:
        with interrupts_heard() as check, shown as show:

            def listen(event: Event) -> None:
                check()
                show(event)

            yield listen
    except (KeyboardInterrupt, OSError, LostError):
        if progress.folder and not silent:
            click.echo(f"`pzt-ident resume {quote(progress.folder)}` goes on from here", err=True)
        raise


@contextmanager
def _lines(progress: Progress) -> Iterator[Listener]:
    last_line = time.perf_counter()

    def listen(event: Event) -> None:
        nonlocal last_line
        progress.take(event)
        if message := _message(event):
            click.echo(message, err=True)
        elif time.perf_counter() - last_line >= SECONDS_BETWEEN_LINES:
            last_line = time.perf_counter()
            click.echo(progress, err=True)

    yield listen


@contextmanager
def _bar(progress: Progress) -> Iterator[Listener]:
    from rich.console import Console
    from rich.progress import BarColumn, TextColumn
    from rich.progress import Progress as Bar

    with Bar(BarColumn(), TextColumn("{task.description}"), console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("reading", total=None)

        def listen(event: Event) -> None:
            progress.take(event)
            if message := _message(event):
                bar.console.print(message, markup=False, highlight=False)
            bar.update(task, total=progress.budget or None, completed=progress.done, description=str(progress))

        yield listen


def _message(event: Event) -> str:
    """The sentence that is printed for an event; empty for most events."""
    if event["event"] == "finished":
        return "every run is finished: nothing is searched again"
    if event["event"] in SENTENCES:
        return str(event["said"])
    if event["event"] == "again":
        return f"{event['run']} is done again: {event['reason']}"
    if event["event"] == "devices" and "failed" in event:
        return f"{event['device']}: {event['failed']}"
    return failure_message(event) if event["event"] == "failed" else ""


def failure_message(event: Event) -> str:
    return f"{event['run']} failed: {event['reason']}"


def duration(seconds: float) -> str:
    """Seconds in readable units: `8 s`, `2 min 5 s`, `1 h 20 min`."""
    rounded = round(seconds)
    if rounded < 60:
        return f"{rounded} s"
    if rounded < 3600:
        return f"{rounded // 60} min {rounded % 60} s"
    return f"{rounded // 3600} h {rounded % 3600 // 60} min"
