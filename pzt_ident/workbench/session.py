"""A session of the workbench: its steps, each a folder with a job, a run and a diagnosis, and what is kept of them."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping, Sequence
from copy import deepcopy
from pathlib import Path
from shlex import join
from typing import Any

from pzt_ident.errors import InputError
from pzt_ident.files import write_json, write_text
from pzt_ident.job.edit import edited, tried
from pzt_ident.job.schema import Job, load_job
from pzt_ident.model.registry import word_of
from pzt_ident.workbench.job_form import file_sources, job_text
from pzt_ident.workbench.runner import RESUME
from pzt_ident.workbench.step_commands import Command, commands_of
from pzt_ident.workbench.step_model import job_in, stated
from pzt_ident.workbench.wording import in_page_words

INTERRUPTED = f"The run was interrupted before it finished. {RESUME}"
Step = dict[str, Any]


class Session:
    """One session in `folder`, below `root`. `version` grows with every change, so that a page can follow; `at` is the
    number of the current step, 0 for the measurement; `draft`: what the page keeps of choices that are not confirmed;
    `warning`: what was found damaged; `plugins`: whether code files that jobs name are loaded."""

    def __init__(self, root: Path, folder: Path, plugins: bool = False) -> None:
        self.plugins = plugins
        self.root, self.folder, self.version = root.resolve(), folder.resolve(), 0
        self.closing: Callable[[], bool] = lambda: False
        self.warning, self.interrupted = "", False
        saved = self._saved()
        self.steps: list[Step] = saved.get("steps", [])
        self.at: int = saved.get("at", 0)
        self.draft: dict[str, Any] = saved.get("draft", {})
        self.settle()
        if self.at and any(c.last.parent.exists() and not c.last.exists() for c in self.commands(self.step())):
            self.interrupted = True

    def _saved(self) -> dict[str, Any]:
        """The content of `state.json`; where it is damaged, the steps whose folders are there, one after the other."""
        path = self.folder / "state.json"
        try:
            return dict(json.loads(path.read_text(encoding="utf-8"))) if path.exists() else {}
        except (OSError, ValueError):
            folders = self.folder / "steps"
            numbers = [int(step.name) for step in folders.iterdir() if step.name.isdigit()] if folders.is_dir() else []
            last = max(numbers, default=0)
            self.warning = f"{self.relative(path)} is damaged: the steps are listed in the order of their folders."
            steps = [{"number": n, "parent": n - 1, "change": f"step {n}"} for n in range(1, last + 1)]
            return {"steps": steps, "at": last}

    def settle(self) -> None:
        """Go back to the last step that is whole, and say so in `warning`."""
        while self.at and (fault := self.fault(self.at)):
            before = next((step["parent"] for step in self.steps if step["number"] == self.at), 0)
            place = f"step {before}" if before else "the measurement"
            self.warning = f"Step {self.at} cannot be opened: {fault} This is {place}, before it."
            self.at = before
            self.version += 1

    def fault(self, number: int) -> str:
        """Why a step cannot be opened; empty where it can."""
        folder = self.folder / "steps" / str(number)
        if not 1 <= number <= len(self.steps):
            return "the session does not have it."
        if not (folder / "job.yaml").is_file():
            return f"{self.relative(folder / 'job.yaml')} is missing."
        for name in ("run/result.json", "diagnosis/diagnosis.json"):
            try:
                if (folder / name).exists():
                    json.loads((folder / name).read_text(encoding="utf-8"))
            except (OSError, ValueError):
                return f"{self.relative(folder / name)} is damaged."
        try:
            job_in(folder, self.plugins)
        except InputError as error:
            return f"{self.readable(str(error)).rstrip('.')}."
        return ""

    @property
    def data(self) -> Path:
        return self.folder / "data"

    def step(self, number: int | None = None) -> Path:
        """The folder of a step, by default of the current one. Raises InputError if there is no step yet."""
        if not (number or self.at):
            raise InputError("there is no job yet", remedy="drop a measurement and confirm its columns")
        if not 0 <= (number or 0) <= len(self.steps):
            raise InputError(f"there is no step {number}")
        return self.folder / "steps" / str(number or self.at)

    def entry(self, number: int | None = None) -> Step:
        """What the session knows of a step."""
        self.step(number)
        return self.steps[(number or self.at) - 1]

    def job(self, number: int | None = None) -> Job:
        return job_in(self.step(number), self.plugins)

    def chain(self) -> list[Step]:
        """The steps from the first to the current one."""
        steps: list[Step] = []
        number = self.at
        while number:
            steps.insert(0, self.steps[number - 1])
            number = steps[0]["parent"]
        return steps

    def begin(self, form: dict[str, Any]) -> None:
        """Make a first step from the form that was confirmed on the page. Raises InputError that lists every fault."""
        form = deepcopy(form)
        for source in file_sources(form["records"]):
            source["file"] = os.path.relpath(self.root / source["file"], self.folder / "steps" / str(self._next))
        self.make(job_text(form), parent=0, change="as given")

    def open(self, path: Path) -> None:
        """Make a first step from a job file, or go on with it. Raises InputError if it is another job."""
        job, first = load_job(path, self.plugins), self.folder / "steps" / "1"
        text = edited(job, job.effects, first)
        if not self.steps:
            self.make(text, parent=0, change="as given")
        elif (first / "job.yaml").read_text(encoding="utf-8") != text:
            problem = f"the session in {self.relative(self.folder)} began with another job"
            raise InputError(problem, where=str(path), remedy="give another folder with --out")
        else:
            self.at = self.at or 1

    def add(self, effect: str) -> None:
        """A step with one effect more, from the fit in which the diagnosis tried it."""
        job = self.job()
        if word_of(effect) in map(word_of, job.effects):
            raise InputError(f"{effect!r} is in the model already")
        candidate = self.candidate(effect)
        diagnosis = self.step() / "diagnosis"
        text = edited(job, (*job.effects, effect), self.next_folder, **tried(diagnosis, effect))
        source = diagnosis if candidate else self.step() / "run"
        self._derive(
            "add", [effect], f"+ {effect}", text, source, promised=candidate.get("rmse"), tied=candidate.get("class")
        )

    def candidate(self, effect: str) -> dict[str, Any]:
        """What the diagnosis of the current step says of an effect; empty where it was not refitted."""
        path = self.step() / "diagnosis" / "diagnosis.json"
        content = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
        fitted = [row for row in content.get("candidates", ()) if row.get("rmse") and row.get("parameters")]
        return next((row for row in fitted if effect in (row["effect"], row["item"])), {})

    def remove(self, effect: str) -> None:
        job = self.job()
        if effect not in job.effects:
            raise InputError(f"{effect!r} is not in the model")
        effects = tuple(word for word in job.effects if word != effect)
        text = edited(job, effects, self.next_folder)
        self._derive("remove", [effect], f"− {effect}", text, self.step() / "run")

    def set_model(self, words: Sequence[str]) -> None:
        """Make a step with another chain of blocks."""
        job = self.job()
        text = edited(job, job.effects, self.next_folder, words)
        self._derive("model", list(words), " → ".join(words), text)

    def _derive(
        self,
        command: str,
        arguments: Sequence[str],
        change: str,
        text: str,
        source: Path | None = None,
        promised: Mapping[str, Any] | None = None,
        tied: Sequence[str] | None = None,
    ) -> None:
        """Make a step from the current one, which starts from the fit in the folder `source`, and log the command that
        does the same."""
        parent = self.step()
        facts: dict[str, Any] = {"from": os.path.relpath(source, self.folder)} if source and source.exists() else {}
        facts |= {"promised": dict(promised)} if promised else {}
        facts |= {"tied": list(tied)} if tied and len(tied) > 1 else {}
        self.make(text, self.at, change, command=command, **facts)
        start = ["--from", self.again(source)] if command == "add" and promised and source else []
        paths = [self.again(step / "job.yaml") for step in (parent, self.step())]
        self.log(["pzt-ident", command, paths[0], *arguments, *start, "-o", paths[1], *self.plugins_flag])

    def undo(self) -> None:
        """Go back to the parent step, from the first one to the measurement; no folder is deleted."""
        if self.at:
            self.go_to(self.steps[self.at - 1]["parent"])

    @property
    def plugins_flag(self) -> list[str]:
        return ["--plugins"] if self.plugins else []

    @property
    def _next(self) -> int:
        return len(self.steps) + 1

    @property
    def next_folder(self) -> Path:
        return self.folder / "steps" / str(self._next)

    def go_to(self, number: int) -> None:
        """Go to any step, 0 for the measurement."""
        if not 0 <= number <= len(self.steps):
            raise InputError(f"there is no step {number}")
        if number and (fault := self.fault(number)):
            raise InputError(f"step {number} cannot be opened: {fault}")
        self.at = number
        self.store()

    def keep(self, number: int, **facts: Any) -> None:
        """Keep facts with a step, such as a `note`."""
        self.entry(number).update(facts)
        self.store()

    def keep_draft(self, draft: dict[str, Any]) -> None:
        """Keep the choices that are not confirmed yet."""
        self.draft, warning = draft, self.warning
        self.store()
        self.warning = warning

    def logs(self) -> list[Path]:
        """The event logs of the commands that fill the current step."""
        return [self.step() / name / "events.jsonl" for name in ("run", "diagnosis", "improved")] if self.at else []

    def make(self, text: str, parent: int, change: str, **facts: Any) -> None:
        """Check a job with its data and add it as a new step. Raises InputError."""
        folder = self.next_folder
        folder.mkdir(parents=True, exist_ok=True)  # the job's paths are relative to it
        job = Job.from_text(text, folder, "job.yaml", self.plugins)
        write_text(folder / "job.yaml", text)
        stated(folder / "job.yaml", job)
        self.steps.append({"number": self._next, "parent": parent, "change": change, **facts})
        self.at = len(self.steps)
        self.store()

    def store(self) -> None:
        write_json(self.folder / "state.json", {"steps": self.steps, "at": self.at, "draft": self.draft})
        self.interrupted, self.warning = False, ""
        self.version += 1

    def readable(self, text: str) -> str:
        """A message in the words of the page, of files the names alone."""
        return in_page_words(text.replace(f"{self.root}{os.sep}", ""))

    def relative(self, path: Path) -> str:
        return os.path.relpath(path, self.root)

    def commands(self, step: Path) -> list[Command]:
        """The commands that fill a step."""
        entry = self.entry(int(step.name))
        source = self.folder / entry["from"] if "from" in entry else None
        return commands_of(step, source, bool(entry.get("search", source is None)), self.relative, self.plugins_flag)

    def again(self, path: Path) -> str:
        """Where a listed command writes what the workbench wrote into `steps`: a folder beside it, so that the commands
        can be run where the session is. A job that no command makes is read where it is."""
        steps = self.folder / "steps"
        if path.name == "diagnosis" and path.parent.parent == steps:
            path = self.folder / self.entry(int(path.parent.name)).get("diagnosed", path)
        made_here = path.name == "start.json" or (path.name == "job.yaml" and not self._has_command(path.parent))
        if made_here or not path.is_relative_to(steps):
            return self.relative(path)
        return self.relative(self.folder / "again" / path.relative_to(steps))

    def _has_command(self, step: Path) -> bool:
        """Whether a listed command makes the job of a step."""
        return bool(step.name.isdigit() and self.steps[int(step.name) - 1].get("command"))

    def again_word(self, word: str) -> str:
        """A word of a command as it is listed."""
        path = self.root / word
        return self.again(path) if path.is_relative_to(self.folder) else word

    def start_of(self, folder: Path) -> str:
        """The file of values that a step starts from, as the session keeps it."""
        return os.path.relpath(folder / "start.json", self.folder)

    def log(self, arguments: Sequence[str]) -> None:
        """Add a line, once, to the commands that repeat the session in a terminal."""
        line = join(arguments)
        if line not in self.logged_commands():
            with (self.folder / "commands.txt").open("a", encoding="utf-8") as log:
                log.write(line + "\n")

    def logged_commands(self) -> list[str]:
        path = self.folder / "commands.txt"
        return path.read_text(encoding="utf-8").splitlines() if path.exists() else []
