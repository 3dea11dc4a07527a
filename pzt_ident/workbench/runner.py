"""The commands of the workbench as processes: one runs, the next one waits warm."""

from __future__ import annotations

import asyncio
import json
import os
import signal
import sys
import time
from collections.abc import Callable, Coroutine, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from pzt_ident.errors import InputError, RunError
from pzt_ident.run.pool import search_path

SECONDS_TO_STOP = 8.0
RESUME = "Resume continues from here."
STOPPED = f"Stopped. {RESUME}"
Process = asyncio.subprocess.Process


class Runner:
    """Runs commands of `pzt-ident` in the folder `root`, one at a time. stage: the name of the running command, since:
    when it began, failure: why the last one failed. `changed` is called with every change of these."""

    def __init__(self, root: Path, changed: Callable[[], None]) -> None:
        self.root, self.changed = root, changed
        self.stage, self.since, self.failure = "", 0.0, ""
        self.task: asyncio.Task[None] | None = None
        self.process: Process | None = None
        self.waiting: asyncio.Task[Process] | None = None

    @property
    def running(self) -> bool:
        return self.task is not None and not self.task.done()

    def start(self, commands: Coroutine[Any, Any, None]) -> None:
        """Start a coroutine that runs commands. Raises InputError while another one runs."""
        if self.running:
            commands.close()
            raise InputError("a command is running", remedy="stop it first")
        self.failure = ""
        self.task = asyncio.create_task(self._watched(commands))

    async def _watched(self, commands: Coroutine[Any, Any, None]) -> None:
        try:
            await commands
        except (InputError, RunError) as error:
            self.failure = str(error)
        except asyncio.CancelledError:
            self.failure = STOPPED
        except Exception as error:
            self.failure = f"The workbench failed: {type(error).__name__}: {error}"
            raise
        finally:
            self.stage, self.process = "", None
            self.changed()

    def warm(self) -> None:
        """Have a process there that has everything imported and waits for its arguments."""
        self._prepared()

    async def run(self, name: str, arguments: Sequence[str]) -> None:
        """Run a command to its end. Raises RunError with its last lines if it fails."""
        self.stage, self.since = name, time.time()
        self.changed()
        self.process = await self._handed([*arguments, "--quiet"])
        self.warm()
        assert self.process.stderr
        errors = await self.process.stderr.read()
        code = await self.process.wait()
        if code == 130 or code == -signal.SIGTERM:
            raise RunError(STOPPED)
        if code < 0:
            raise RunError(f"The command was killed by signal {-code}. {RESUME}")
        if code:
            lines = errors.decode(errors="replace").strip().splitlines()
            raise RunError("\n".join(lines[-12:]).removeprefix("Error: ") or f"pzt-ident {name} failed")

    async def _handed(self, arguments: list[str]) -> Process:
        """A process that has been handed its arguments: the waiting one unless it has ended."""
        while True:
            process = await asyncio.shield(self._prepared())  # which a stop leaves to the next command
            self.waiting = None
            assert process.stdin
            with suppress(ConnectionError):
                process.stdin.write(json.dumps(arguments).encode() + b"\n")
                await process.stdin.drain()
                if process.returncode is None:
                    return process

    def _prepared(self) -> asyncio.Task[Process]:
        """The process that waits, or is about to."""
        if self.waiting is None or (self.waiting.done() and self.waiting.exception()):
            self.waiting = asyncio.create_task(self._spawned())
        return self.waiting

    async def _spawned(self) -> Process:
        return await asyncio.create_subprocess_exec(
            *command_line(),
            cwd=self.root,
            stdin=asyncio.subprocess.PIPE,  # closed with this process, which ends the command
            stdout=asyncio.subprocess.DEVNULL,
            stderr=asyncio.subprocess.PIPE,
            start_new_session=True,
        )

    async def stop(self) -> None:
        """Stop the running command and its workers; returns when they have ended."""
        if not self.running or self.task is None:
            return
        if self.process is None or self.process.returncode is not None:
            self.task.cancel()
        else:
            self.process.terminate()
        done, _ = await asyncio.wait([self.task], timeout=SECONDS_TO_STOP)
        if not done and self.process and self.process.returncode is None:
            os.killpg(self.process.pid, signal.SIGKILL)
            await asyncio.wait([self.task])

    async def close(self) -> None:
        """Stop, and end the process that waits."""
        await self.stop()
        if self.waiting:
            process = await self.waiting
            if process.returncode is None:
                process.kill()
                await process.wait()


class Aside(Runner):
    """A command now and then beside the others: no process waits for it."""

    def warm(self) -> None:
        """Nothing."""


def command_line() -> list[str]:
    """A process of `pzt-ident` with this process' module search path, which reads its arguments from its input."""
    code = f"import sys; sys.path[:] = {search_path()}; from pzt_ident.cli.child_process import main; main()"
    return [sys.executable, "-P", "-c", code]
