"""Commands of `pzt-ident` in a process beside this one, which may hang, die or be left behind."""

from __future__ import annotations

import multiprocessing
import os
import signal
import traceback
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

PATIENCE = 60.0  # s


@dataclass(frozen=True)
class Ended:
    """How a command ended. code: None where it hung or its process died. message: its standard error."""

    code: int | None
    message: str
    answer: str = ""


@dataclass
class Case:
    """What came of a case, and what is wrong with that."""

    number: int
    how: str
    came: str
    faults: list[str] = field(default_factory=list)
    message: str = ""

    def row(self) -> dict[str, Any]:
        return {"case": self.number, "how": self.how, "came": self.came, "faults": "; ".join(self.faults)}


def command(words: Sequence[str], folder: Path) -> Ended:
    """`pzt-ident WORDS` in a folder, in this process."""
    from click.testing import CliRunner

    from pzt_ident.cli.commands import main

    os.chdir(folder)
    ended = CliRunner().invoke(main, list(words))
    crash = "".join(traceback.format_exception(ended.exception)) if ended.exc_info[0] is not SystemExit else ""
    return Ended(ended.exit_code, ended.stderr + crash * bool(ended.exception), ended.stdout)


class InThisProcess:
    """A place for the tasks of a run that needs no other process."""

    shares_disk = True

    def run_all(self, entry: Any, common: Any, tasks: Any, tell: Any, done: Any = lambda name, result: None) -> Any:
        import numpy as np

        from pzt_ident.run.pool import attempt

        failed = {}
        for name, arguments in tasks:
            with np.errstate(all="ignore"):
                kind, content = attempt(entry, (*common, *arguments), tell)
            if kind == "done":
                done(name, content)
            else:
                failed[name] = content
                tell({"event": "failed", "run": name, "reason": content})
        return failed


def _serve(pipe: Any) -> None:
    while True:
        call, arguments = pipe.recv()
        signal.alarm(int(2 * PATIENCE))
        pipe.send(call(*arguments))
        signal.alarm(0)


class Bench:
    """Calls functions in a process that is replaced where it hangs or dies."""

    def __init__(self, patience: float = PATIENCE) -> None:
        self.patience, self.process, self.pipe = patience, None, None

    def _start(self) -> None:
        context = multiprocessing.get_context("spawn")
        self.pipe, theirs = context.Pipe()
        self.process = context.Process(target=_serve, args=(theirs,), daemon=True)
        self.process.start()
        theirs.close()

    def call(self, function: Callable[..., Ended], *arguments: Any) -> Ended:
        """What the function returns; that it hung, or that its process died."""
        if self.process is None:
            self._start()
        self.pipe.send((function, arguments))
        try:
            if self.pipe.poll(self.patience):
                return self.pipe.recv()
            message = "hangs"
        except (EOFError, ConnectionError):
            message = "its process died"
        self.end()
        return Ended(None, message)

    def end(self) -> None:
        if self.process is not None:
            self.process.kill()
            self.process.join()
            self.process = None

    def __enter__(self) -> Bench:
        return self

    def __exit__(self, *error: object) -> None:
        self.end()
