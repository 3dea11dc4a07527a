"""A session: its steps as folders, and the commands that fill them, each in its own process.

`<folder>/state.json` lists the steps; `steps/<number>/` holds `job.yaml`, the results of `pzt-ident run` in `run/` and
those of `pzt-ident diagnose` in `diagnosis/`. The page shows what is stored there, so that nothing is lost by a reload
or a crash.
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
from pzt_ident.model.registry import word_of
from pzt_ident.run.pool import search_path
from pzt_ident.workbench.job_form import file_sources, job_text

SECONDS_TO_STOP = 8.0
INTERRUPTED = "The run was interrupted before it finished. Resume continues from here."


class Session:
    """One session in `folder`, below `root`. `version` grows with every change, so that a page can follow; `at` is the
    number of the current step, 0 for the measurement; `plugins`: whether code files that jobs name are loaded."""

    def __init__(self, root: Path, folder: Path, plugins: bool = False) -> None:
        self.plugins = plugins
        self.root, self.folder, self.version = root.resolve(), folder.resolve(), 0
        self.stage, self.since, self.failure = "", 0.0, ""
        self.closing: Callable[[], bool] = lambda: False
        self.task: asyncio.Task[None] | None = None
        self.process: asyncio.subprocess.Process | None = None
        stored = folder / "state.json"
        saved = json.loads(stored.read_text(encoding="utf-8")) if stored.exists() else {}
        self.steps: list[dict[str, Any]] = saved.get("steps", [])
        self.at: int = saved.get("at", 0)
        if self.at and 0 < sum(file.exists() for file in self._milestones()) < len(self._milestones()):
            self.failure = INTERRUPTED

    @property
    def data(self) -> Path:
        return self.folder / "data"

    @property
    def running(self) -> bool:
        return self.task is not None and not self.task.done()

    def step(self, number: int | None = None) -> Path:
        """The folder of a step, by default of the current one. Raises InputError if there is no step yet."""
        if not (number or self.at):
            raise InputError("there is no job yet", remedy="drop a measurement and confirm its columns")
        return self.folder / "steps" / str(number or self.at)

    def job(self) -> Job:
        return load_job(self.step() / "job.yaml", self.plugins)

    def chain(self) -> list[dict[str, Any]]:
        """The steps from the first to the current one."""
        steps: list[dict[str, Any]] = []
        number = self.at
        while number:
            steps.insert(0, self.steps[number - 1])
            number = steps[0]["parent"]
        return steps

    def begin(self, form: dict[str, Any]) -> None:
        """Make a first step from the form that was confirmed on the page. Raises InputError that lists every fault."""
        for source in file_sources(form["records"]):
            source["file"] = os.path.relpath(self.root / source["file"], self.folder / "steps" / str(self._next))
        self._add(job_text(form), parent=0, change="as given")

    def open(self, path: Path) -> None:
        """Make a first step from a job file, or go on with it. Raises InputError if it is another job."""
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
        if word_of(effect) in map(word_of, job.effects):
            raise InputError(f"{effect!r} is in the model already")
        self._change((*job.effects, effect), f"+ {effect}")

    def remove(self, effect: str) -> None:
        job = self.job()
        if effect not in job.effects:
            raise InputError(f"{effect!r} is not in the model")
        self._change(tuple(word for word in job.effects if word != effect), f"− {effect}")

    def _change(self, effects: tuple[str, ...], change: str) -> None:
        sign, effect = change.split()
        self._derive({"+": "add", "−": "remove"}[sign], [effect], change, effects)

    def set_model(self, words: list[str]) -> None:
        """Make a step with another chain of blocks."""
        self._derive("model", words, " → ".join(words), self.job().effects, words)

    def _derive(
        self, command: str, arguments: list[str], change: str, effects: Sequence[str], model: list[str] | None = None
    ) -> None:
        """Make a step from the current one and log the command that does the same."""
        parent, folder = self.step(), self.folder / "steps" / str(self._next)
        self._add(edited(self.job(), effects, folder, model), self.at, change)
        paths = [self.relative(step / "job.yaml") for step in (parent, folder)]
        self.log(join(["pzt-ident", command, paths[0], *arguments, "-o", paths[1], *self._plugins_flag]))

    def undo(self) -> None:
        """Go back to the parent step, from the first one to the measurement; no folder is deleted."""
        if self.at:
            self.go_to(self.steps[self.at - 1]["parent"])

    @property
    def _plugins_flag(self) -> list[str]:
        return ["--plugins"] if self.plugins else []

    @property
    def _next(self) -> int:
        return len(self.steps) + 1

    def go_to(self, number: int) -> None:
        """Go to any step, 0 for the measurement."""
        if not 0 <= number <= len(self.steps):
            raise InputError(f"there is no step {number}")
        self.at = number
        self._store()

    def logs(self) -> list[Path]:
        """The event logs of the commands that fill the current step."""
        return [self.step() / name / "events.jsonl" for name in ("run", "diagnosis")] if self.at else []

    def _add(self, text: str, parent: int, change: str) -> None:
        """Check a job with its data and add it as a new step. Raises InputError."""
        from pzt_ident.run.summary import summary_of

        folder = self.folder / "steps" / str(self._next)
        folder.mkdir(parents=True, exist_ok=True)  # the job's paths are relative to it
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
        """A message with its paths relative to the root and normalised."""
        shortened = text.replace(f"{self.root}{os.sep}", "")
        return re.sub(r"\S+/\.\./\S+", lambda match: os.path.normpath(match[0]), shortened)

    def relative(self, path: Path) -> str:
        return os.path.relpath(path, self.root)

    def commands(self, step: Path) -> list[tuple[str, Path, list[str]]]:
        """The commands that fill a step: name, the file that each writes last, and the arguments of `pzt-ident`."""
        job, run, diagnosis = (self.relative(step / name) for name in ("job.yaml", "run", "diagnosis"))
        started = (step / "run" / "environment.json").exists()
        search = ["resume", run] if started else ["run", job, "--out", run]
        flags = ["--no-report", *self._plugins_flag]
        return [
            ("run", step / "run" / "result.json", [*search, *flags]),
            ("diagnose", step / "diagnosis" / "diagnosis.json", ["diagnose", job, "--out", diagnosis, *flags]),
        ]

    def _milestones(self) -> list[Path]:
        """The files that mark how far the current step has been filled, first to last."""
        step = self.step()
        return [step / "run" / "environment.json", *(last for _, last, _ in self.commands(step))]

    def log(self, line: str) -> None:
        """Add a line, once, to the commands that repeat the session in a terminal."""
        if line not in self.logged_commands():
            with (self.folder / "commands.txt").open("a", encoding="utf-8") as log:
                log.write(line + "\n")

    def logged_commands(self) -> list[str]:
        path = self.folder / "commands.txt"
        return path.read_text(encoding="utf-8").splitlines() if path.exists() else []

    def start(self) -> None:
        """Start filling the current step. Raises InputError while a step is being filled."""
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
                    await self._run_command(name, arguments)
        except RunError as error:
            self.failure = str(error)
        finally:
            self.stage, self.process = "", None
            self.version += 1

    async def _run_command(self, name: str, arguments: list[str]) -> None:
        """Run a command to its end. Raises RunError with its last lines if it fails."""
        self.stage, self.since = name, time.time()
        self.version += 1
        self.log(join(["pzt-ident", *arguments]))
        self.process = await asyncio.create_subprocess_exec(
            *command([*arguments, "--quiet"]),
            cwd=self.root,
            stdin=asyncio.subprocess.PIPE,  # closed with this process, which ends the command
            stdout=asyncio.subprocess.DEVNULL,
            stderr=asyncio.subprocess.PIPE,
            start_new_session=True,
        )
        assert self.process.stderr
        errors = await self.process.stderr.read()
        code = await self.process.wait()
        if code == 130 or code == -signal.SIGTERM:
            raise RunError("Stopped. Resume continues from here.")
        if code < 0:
            raise RunError(f"pzt-ident {name} was killed by signal {-code}. Resume continues from here.")
        if code:
            lines = errors.decode(errors="replace").strip().splitlines()
            raise RunError(self.readable("\n".join(lines[-12:])).removeprefix("Error: ") or f"pzt-ident {name} failed")

    async def stop(self) -> None:
        """Stop the running command and its workers; returns when they have ended."""
        if not self.running or self.task is None:
            return
        if self.process and self.process.returncode is None:
            self.process.terminate()
        done, _ = await asyncio.wait([self.task], timeout=SECONDS_TO_STOP)
        if not done and self.process and self.process.returncode is None:
            os.killpg(self.process.pid, signal.SIGKILL)
            await asyncio.wait([self.task])


def command(arguments: Sequence[str]) -> list[str]:
    """The command line of `pzt-ident` with these arguments and this process' module search path."""
    code = f"import sys; sys.path[:] = {search_path()}; from pzt_ident.cli.child_process import main; main()"
    return [sys.executable, "-P", "-c", code, *arguments]
