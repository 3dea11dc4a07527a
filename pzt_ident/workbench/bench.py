"""The workbench: a session, the command that runs for it, and one change at a time."""

from __future__ import annotations

import asyncio
import json
import shutil
from collections.abc import Awaitable, Callable, Coroutine
from pathlib import Path
from typing import Any

from pzt_ident.errors import InputError
from pzt_ident.files import plain
from pzt_ident.lot.identify import is_fleet
from pzt_ident.workbench import adopt, page_state
from pzt_ident.workbench.atlas import Atlas
from pzt_ident.workbench.fleet import Fleet, to_adopt
from pzt_ident.workbench.headline import error, headline
from pzt_ident.workbench.runner import Aside, Runner
from pzt_ident.workbench.session import INTERRUPTED, Session
from pzt_ident.workbench.session_results import gathered
from pzt_ident.workbench.step_commands import better_fit

Form = dict[str, Any]
Change = Callable[["Bench", Form], Awaitable[None]]


class Bench:
    """A session with what is done to it. `fleet`: the lot that it is in or that was made from it, in `folder` or
    elsewhere. `handouts`: files that are given away, by keys that cannot be guessed."""

    def __init__(self, session: Session, fleet: Fleet | None = None) -> None:
        made_here = session.folder / "fleet"
        self.session, self.folder = session, session.folder
        self.fleet = fleet or (Fleet(made_here) if is_fleet(made_here) else None)
        self.runner = Runner(session.root, self.changed)
        self.atlas = Atlas(session)
        self.drawer, self.drawing = Aside(session.root, lambda: None), asyncio.Lock()
        self.lock = asyncio.Lock()
        self.making: tuple[str, str] | None = None
        self.tasks: set[asyncio.Task[None]] = set()
        self.handouts: dict[str, Path] = {}
        if session.interrupted:
            self.runner.failure = INTERRUPTED

    def changed(self) -> None:
        self.session.version += 1

    @property
    def busy(self) -> bool:
        return self.runner.running or self.lock.locked()

    async def change(self, name: str, change: Change, form: Form) -> None:
        """Make one change after the other. A change that was asked for at another step than the current one, or that
        is being made as it is asked for again, is not made again."""
        request = name, json.dumps(form, sort_keys=True)
        repeated = self.making == request
        async with self.lock:
            at_this_step = int(form.get("at", self.session.at)) == self.session.at
            if repeated or not at_this_step:
                return
            self.making = request
            self.changed()
            try:
                await change(self, form)
            finally:
                self.making = None
                self.changed()

    async def step(self, make: Callable[[], None]) -> None:
        """Make a step and fill it."""
        await self.runner.stop()
        await asyncio.to_thread(make)
        self.fill()

    async def move(self, go: Callable[[], None]) -> None:
        """Go to another step."""
        await self.runner.stop()
        go()
        self.runner.failure = ""

    def fill(self) -> None:
        """Run what the current step lacks; nothing where that is being done already."""
        if not self.runner.running:
            step = self.session.step()
            self.runner.start(self._fill(step))

    async def _fill(self, step: Path) -> None:
        for command in self.session.commands(step):
            if command.last.exists():
                continue
            if command.name == "diagnose":
                shutil.rmtree(command.last.parent, ignore_errors=True)
            await self.command(command.name, command.arguments)
        if better_fit(step):
            run, diagnosis = (self.session.relative(step / name) for name in ("run", "diagnosis"))
            flags = ["--no-report", *self.session.plugins_flag]
            await self.command("run", ["resume", run, "--from", diagnosis, *flags])

    async def command(self, name: str, arguments: list[str]) -> None:
        """Log a command and run it to its end."""
        self.session.log(["pzt-ident", *map(self.session.again_word, arguments)])
        await self.runner.run(name, arguments)

    def improve(self, budget: str | None) -> None:
        """Run `improve` on the current step; its steps become steps of the session."""
        if not self.runner.running:
            self.runner.start(self._improve(self.session.step(), budget))

    async def _improve(self, step: Path, budget: str | None) -> None:
        session, out = self.session, step / "improved"
        shutil.rmtree(out, ignore_errors=True)
        job, run, folder = (session.relative(path) for path in (step / "job.yaml", step / "run", out))
        start = ["--from", run] if (step / "run" / "result.json").exists() else []
        more = ["--budget", budget] if budget else []
        flags = ["--no-report", *session.plugins_flag]
        await self.command("improve", ["improve", job, *start, "--out", folder, *more, *flags])
        await self._adopt(step)

    async def _adopt(self, step: Path) -> None:
        """Make steps of the improvement of a step."""
        session = self.session
        numbers = await asyncio.to_thread(adopt.improvement, session, step)
        for number in numbers:
            first, _ = session.commands(session.step(number))
            await self.command(first.name, first.arguments)
        adopt.diagnosis(session, step, session.at)

    def put_to_work(self, reference: Path, options: list[str]) -> None:
        """Run `control` and `drive` on the current step."""
        if not self.runner.running:
            self.runner.start(self._put_to_work(self.session.step(), reference, options))

    async def _put_to_work(self, step: Path, reference: Path, options: list[str]) -> None:
        if not (step / "run" / "result.json").exists():
            raise InputError("this step has no result yet", remedy="run it first")
        name_of, flags = self.session.relative, self.session.plugins_flag
        shutil.rmtree(step / "control", ignore_errors=True)
        arguments = [name_of(step / "run"), "--reference", name_of(reference), *options, *flags]
        await self.command("control", ["control", *arguments, "--out", name_of(step / "control")])
        await self.command("control", ["drive", *arguments, "-o", name_of(step / "control" / "drive.csv")])

    async def open_device(self, name: str) -> None:
        """Go to the session of a device of the lot. A fleet that is running goes on."""
        if self.fleet is None:
            raise InputError("there is no lot")
        if self.runner.stage != "fleet":
            await self.runner.stop()
        before = self.session
        session = await asyncio.to_thread(
            self.fleet.session, name, before.root, self.folder / "devices", before.plugins
        )
        session.version, session.closing = before.version + 1, before.closing
        self.session = self.atlas.session = session
        if not self.runner.running:
            self.runner.failure = INTERRUPTED if session.interrupted else ""
            if to_adopt(session):
                self.runner.start(self._adopt(session.step()))

    def identify_lot(self, pattern: str, improve: bool) -> None:
        """Run the job of the current step on the devices that a pattern names."""
        job, out = self.session.step() / "job.yaml", self.folder / "fleet"
        name_of, flags = self.session.relative, self.session.plugins_flag
        arguments = ["fleet", name_of(job), pattern, "--out", name_of(out), *["--improve"] * improve, *flags]
        self._run_fleet(out, arguments)

    def resume_lot(self) -> None:
        """Go on with the fleet that is shown."""
        if self.fleet is None:
            raise InputError("there is no lot")
        folder = self.fleet.folder
        self._run_fleet(folder, ["resume", self.session.relative(folder), *self.session.plugins_flag])

    def _run_fleet(self, folder: Path, arguments: list[str]) -> None:
        if not self.runner.running:
            if self.fleet is None or self.fleet.folder != folder:
                self.fleet = Fleet(folder)
            self.runner.start(self.command("fleet", arguments))

    @property
    def lot(self) -> dict[str, Any] | None:
        """The lot beside the session: where its page is, and which device the session is of."""
        device = self.session.steps[0].get("device", "") if self.session.steps else ""
        return {"url": self.fleet.url, "device": device} if self.fleet and self.fleet.begun else None

    def state(self) -> dict[str, Any]:
        """All that the page shows, but signals. Its `version` is read first, so that the page asks again for what
        changes while this is gathered."""
        session, runner = self.session, self.runner
        session.settle()
        version = session.version
        doing = {"stage": runner.stage, "since": runner.since, "busy": self.busy, "running": runner.running}
        failure = session.readable(runner.failure)
        state = page_state.state(session) | doing | {"failure": failure, "lot": self.lot, "version": version}
        state |= {"headline": headline(state), "error": error(state)}
        return dict(plain(state))

    async def draw(self) -> None:
        """Draw the report of the current step with every figure, in a process that ends with this one."""
        run = await asyncio.to_thread(gathered, self.session)
        async with self.drawing:
            await self.drawer.run("report", ["report", self.session.relative(run)])

    def background(self, work: Coroutine[Any, Any, None]) -> None:
        """Let something be done beside all else."""
        task = asyncio.create_task(work)
        self.tasks.add(task)
        task.add_done_callback(self.tasks.discard)

    async def close(self) -> None:
        await self.runner.close()
        await self.atlas.close()
