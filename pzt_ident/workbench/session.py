"""The steps of a session as folders, and the commands that fill them, each in a process of its own.

`<folder>/state.json` says which steps there are, and `steps/<number>/` holds `job.yaml`, the results of `pzt-ident run`
in `run/` and those of `pzt-ident diagnose` in `diagnosis/`. What the page shows is read from there, so that neither a
reload nor a crash loses anything.
"""

from __future__ import annotations

import asyncio
import json
import os
import re
import shutil
import signal
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from shlex import join
from typing import Any

from pzt_ident.errors import InputError, RunError
from pzt_ident.files import write_json, write_text
from pzt_ident.job.edit import edited
from pzt_ident.job.schema import Job, load_job
from pzt_ident.run.pool import search_path
from pzt_ident.workbench.job_form import job_text, places

SECONDS_TO_STOP = 8.0
CUT_OFF = "This was ended before it was finished. Run goes on from here."


class Session:
    """One session in `folder`, which lies in `root`; `version` counts what has happened, so that a page can follow.
    `plugins`: whether files of code that its jobs name are loaded."""

    def __init__(self, root: Path, folder: Path, plugins: bool = False) -> None:
        self.plugins = plugins
        self.root, self.folder, self.version = root.resolve(), folder.resolve(), 0
        self.stage, self.since, self.failure = "", 0.0, ""
        self.closing: Callable[[], bool] = lambda: False
        self.task: asyncio.Task[None] | None = None
        self.process: asyncio.subprocess.Process | None = None
        stored = folder / "state.json"
        known = json.loads(stored.read_text(encoding="utf-8")) if stored.exists() else {}
        self.steps: list[dict[str, Any]] = known.get("steps", [])
        self.at: int = known.get("at", 0)
        if self.at and 0 < sum(last.exists() for last in self._traces()) < len(self._traces()):
            self.failure = CUT_OFF

    @property
    def data(self) -> Path:
        return self.folder / "data"

    @property
    def running(self) -> bool:
        return self.task is not None and not self.task.done()

    def step(self, number: int | None = None) -> Path:
        """The folder of a step, of the one shown if none is named. Raises InputError before there is one."""
        if not (number or self.at):
            raise InputError("there is no job yet", remedy="drop a measurement and confirm its columns")
        return self.folder / "steps" / str(number or self.at)

    def job(self) -> Job:
        return load_job(self.step() / "job.yaml", self.plugins)

    def chain(self) -> list[dict[str, Any]]:
        """The steps from the first to the one shown."""
        found: list[dict[str, Any]] = []
        number = self.at
        while number:
            found.insert(0, self.steps[number - 1])
            number = found[0]["parent"]
        return found

    def begin(self, form: dict[str, Any]) -> None:
        """A first step from what was confirmed on the page. Raises InputError that lists every fault."""
        for place in places(form["records"]):
            place["file"] = os.path.relpath(self.root / place["file"], self.folder / "steps" / str(self._next))
        self._add(job_text(form), parent=0, change="as given")

    def open(self, path: Path) -> None:
        """A first step from a job file of the user's. Raises InputError where the session began with another."""
        job, first = load_job(path, self.plugins), self.folder / "steps" / "1"
        text = edited(job, job.effects, first)
        if not self.steps:
            self._add(text, parent=0, change="as given")
        elif (first / "job.yaml").read_text(encoding="utf-8") != text:
            problem = f"the session in {self.relative(self.folder)} began with another job"
            raise InputError(problem, where=str(path), remedy="give another folder with --out")
        else:
            self.at = self.at or 1

    def add(self, effect: str) -> None:
        job = self.job()
        if effect in job.effects:
            raise InputError(f"{effect!r} is in the model already")
        self._change((*job.effects, effect), f"+ {effect}")

    def remove(self, effect: str) -> None:
        job = self.job()
        if effect not in job.effects:
            raise InputError(f"{effect!r} is not in the model")
        self._change(tuple(word for word in job.effects if word != effect), f"− {effect}")

    def _change(self, effects: tuple[str, ...], change: str) -> None:
        sign, effect = change.split()
        self._amend({"+": "add", "−": "remove"}[sign], [effect], change, effects)

    def choose(self, words: list[str]) -> None:
        """Another chain of blocks."""
        self._amend("model", words, " → ".join(words), self.job().effects, words)

    def _amend(
        self, command: str, said: list[str], change: str, effects: Sequence[str], words: list[str] | None = None
    ) -> None:
        """A step from the one shown, as a command makes it."""
        before, folder = self.step(), self.folder / "steps" / str(self._next)
        self._add(edited(self.job(), effects, folder, words), self.at, change)
        paths = [self.relative(place / "job.yaml") for place in (before, folder)]
        self.log(join(["pzt-ident", command, paths[0], *said, "-o", paths[1], *self._trust]))

    def undo(self) -> None:
        """Back to the step before, from the first one to the measurement; what was made stays in its folder."""
        if self.at:
            self.go(self.steps[self.at - 1]["parent"])

    @property
    def _trust(self) -> list[str]:
        return ["--plugins"] if self.plugins else []

    @property
    def _next(self) -> int:
        return len(self.steps) + 1

    def go(self, number: int) -> None:
        """To any step that was made, 0 for the measurement."""
        if not 0 <= number <= len(self.steps):
            raise InputError(f"there is no step {number}")
        self.at = number
        self._store()

    def logs(self) -> list[Path]:
        """Where the commands that fill the step shown write their events."""
        return [self.step() / name / "events.jsonl" for name in ("run", "diagnosis")] if self.at else []

    def _add(self, text: str, parent: int, change: str) -> None:
        """A new step, once its job and data are found in order."""
        from pzt_ident.run.summary import summary_of

        folder = self.folder / "steps" / str(self._next)
        folder.mkdir(parents=True, exist_ok=True)  # paths of a job lead through it
        summary_of(Job.from_text(text, folder, "job.yaml", self.plugins))
        write_text(folder / "job.yaml", text)
        self.steps.append({"number": self._next, "parent": parent, "change": change})
        self.at = len(self.steps)
        self._store()

    def _store(self) -> None:
        write_json(self.folder / "state.json", {"steps": self.steps, "at": self.at})
        self.failure = ""
        self.version += 1

    def readable(self, text: str) -> str:
        """What was said, with paths from the root, and none that leads up and down again."""
        within = text.replace(f"{self.root}{os.sep}", "")
        return re.sub(r"\S+/\.\./\S+", lambda found: os.path.normpath(found[0]), within)

    def relative(self, path: Path) -> str:
        return os.path.relpath(path, self.root)

    def commands(self, step: Path) -> list[tuple[str, Path, list[str]]]:
        """What fills a step: a name, the file that comes last, and the arguments of `pzt-ident`."""
        job, run, diagnosis = (self.relative(step / name) for name in ("job.yaml", "run", "diagnosis"))
        begun = (step / "run" / "environment.json").exists()
        search = ["resume", run] if begun else ["run", job, "--out", run]
        rest = ["--no-report", *self._trust]
        return [
            ("run", step / "run" / "result.json", [*search, *rest]),
            ("diagnose", step / "diagnosis" / "diagnosis.json", ["diagnose", job, "--out", diagnosis, *rest]),
        ]

    def _traces(self) -> list[Path]:
        """What a step has of its own in the course of being filled, from the first to the last."""
        step = self.step()
        return [step / "run" / "environment.json", *(last for _, last, _ in self.commands(step))]

    def log(self, line: str) -> None:
        """Keep a line of what it takes to repeat the session in a terminal, once."""
        if line not in self.said():
            with (self.folder / "commands.txt").open("a", encoding="utf-8") as log:
                log.write(line + "\n")

    def said(self) -> list[str]:
        """The lines kept."""
        path = self.folder / "commands.txt"
        return path.read_text(encoding="utf-8").splitlines() if path.exists() else []

    def start(self) -> None:
        """Fill the step that is shown. Raises InputError while another is being filled."""
        if self.running:
            raise InputError("a command is running", remedy="stop it first")
        self.failure = ""
        self.task = asyncio.create_task(self._fill(self.step()))

    async def _fill(self, step: Path) -> None:
        try:
            for name, last, arguments in self.commands(step):
                if not last.exists():
                    if name == "diagnose":
                        shutil.rmtree(last.parent, ignore_errors=True)
                    await self._call(name, arguments)
        except RunError as error:
            self.failure = str(error)
        finally:
            self.stage, self.process = "", None
            self.version += 1

    async def _call(self, name: str, arguments: list[str]) -> None:
        """Run a command to its end. Raises RunError with what it said where it failed."""
        self.stage, self.since = name, time.time()
        self.version += 1
        self.log(join(["pzt-ident", *arguments]))
        self.process = await asyncio.create_subprocess_exec(
            *command([*arguments, "--quiet"]),
            cwd=self.root,
            stdin=asyncio.subprocess.PIPE,  # open as long as this process lives
            stdout=asyncio.subprocess.DEVNULL,
            stderr=asyncio.subprocess.PIPE,
            start_new_session=True,
        )
        assert self.process.stderr
        said = await self.process.stderr.read()
        code = await self.process.wait()
        if code == 130 or code == -signal.SIGTERM:
            raise RunError("Stopped. Run goes on from here.")
        if code < 0:
            raise RunError(f"`pzt-ident {name}` was killed by signal {-code}. Run goes on from here.")
        if code:
            lines = said.decode(errors="replace").strip().splitlines()
            raise RunError(
                self.readable("\n".join(lines[-12:])).removeprefix("Error: ") or f"`pzt-ident {name}` failed"
            )

    async def stop(self) -> None:
        """End what is running, with its workers; returns when it has ended."""
        if not self.running or self.task is None:
            return
        if self.process and self.process.returncode is None:
            self.process.terminate()
        done, _ = await asyncio.wait([self.task], timeout=SECONDS_TO_STOP)
        if not done and self.process and self.process.returncode is None:
            os.killpg(self.process.pid, signal.SIGKILL)
            await asyncio.wait([self.task])


def command(arguments: Sequence[str]) -> list[str]:
    """What to start for `pzt-ident` with these arguments: it looks for modules where this process does."""
    said = f"import sys; sys.path[:] = {search_path()}; from pzt_ident.cli.child_process import main; main()"
    return [sys.executable, "-P", "-c", said, *arguments]
