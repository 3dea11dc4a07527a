"""Processes side by side, each for one task after another, watched: what one that dies was at is done again."""

from __future__ import annotations

import multiprocessing
import os
import shutil
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from itertools import chain
from multiprocessing.connection import wait
from tempfile import TemporaryDirectory
from typing import Any

from pzt_ident.errors import InputError, LostError, RunError
from pzt_ident.files import temporary_files_in
from pzt_ident.model.registry import blocks, optimizers
from pzt_ident.run.interrupts import interrupts_blocked, interrupts_deferred

Event = dict[str, Any]
Tell = Callable[[Event], None]
Done = Callable[[str, Any], None]
Entry = Callable[..., Any]
Arguments = tuple[Any, ...]
Tasks = Iterable[tuple[str, Arguments]]  # names, with the arguments that each task has of its own
Failures = dict[str, str]  # reasons by the name of the task
PRELOADED = ("pzt_ident.run.task", "pzt_ident.job.schema", "pzt_ident.engine.kernel", "ruamel.yaml")
SECONDS_DEAF = 0.1
ATTEMPTS = 3
"""How often a task is begun whose processes die."""


def forget(name: str, result: Any) -> None:
    """What is done with the results of tasks that write their own."""


def context() -> Any:
    """Workers forked from a small server that has the kernels loaded; started afresh where that cannot be had."""
    for library in ("OPENBLAS", "MKL", "OMP"):  # one process a core; their own threads would only get in the way
        os.environ.setdefault(f"{library}_NUM_THREADS", "1")
    if sys.platform == "win32":
        return multiprocessing.get_context("spawn")
    from multiprocessing import forkserver, resource_tracker

    forking = multiprocessing.get_context("forkserver")
    forking.set_forkserver_preload([*PRELOADED, *blocks.modules(), *optimizers.modules()])
    with without_working_folder():
        resource_tracker.ensure_running()  # it lets Ctrl-C through
        with interrupts_blocked():  # neither does the server hear of it
            forkserver.ensure_running()
    return forking


def search_path() -> list[str]:
    """Where this process looks for modules, less the working folder of a notebook or of `python -c`: a `numpy.py`
    beside the data would be run."""
    return [place for place in sys.path if place]


_starting = threading.RLock()


@contextmanager
def without_working_folder() -> Iterator[None]:
    """Started inside, a process has this one's search path, less the working folder."""
    with _starting:
        path, flag = sys.path, os.environ.get("PYTHONSAFEPATH")
        sys.path, os.environ["PYTHONSAFEPATH"] = search_path(), "1"
        try:
            yield
        finally:
            sys.path = path
            del os.environ["PYTHONSAFEPATH"]
            if flag is not None:
                os.environ["PYTHONSAFEPATH"] = flag


@contextmanager
def without_script() -> Iterator[None]:
    """Started inside, a process does not run the user's script again: nothing that a worker needs is in it."""
    with _starting:
        script = sys.modules["__main__"]
        hidden = {name: getattr(script, name) for name in ("__file__", "__spec__") if hasattr(script, name)}
        vars(script).pop("__file__", None)
        script.__spec__ = None
        try:
            yield
        finally:
            vars(script).update(hidden)


@dataclass(eq=False)
class Worker:
    """A process, our end of its pipe, and the task that it is at: the name and the arguments."""

    process: Any
    pipe: Any
    name: str = ""
    arguments: Arguments = ()

    def begin(self, name: str, arguments: Arguments) -> None:
        self.name, self.arguments = name, arguments
        with suppress(ConnectionError):  # it has died: its pipe will say so
            self.pipe.send(arguments)

    def end(self) -> None:
        """Of a worker that has nothing to do; it ends by itself."""
        self.pipe.close()
        self.process.join()


class Pool:
    """The workers of one call of `run_all`: those that wait for a task, and those that are at one. Their temporary
    files lie in one folder, which goes with the pool: a worker that is killed clears nothing up."""

    def __init__(self, entry: Entry, common: Arguments, most: int) -> None:
        self.entry, self.common, self.most = entry, common, most
        self.idle: list[Worker] = []
        self.busy: dict[Any, Worker] = {}
        self.scratch = TemporaryDirectory(prefix="pzt-ident-", ignore_cleanup_errors=True)

    @property
    def has_room(self) -> bool:
        return len(self.busy) < self.most

    def begin(self, name: str, arguments: Arguments) -> None:
        worker = self.idle.pop() if self.idle else self._started()
        self.busy[worker.pipe] = worker
        worker.begin(name, arguments)

    def _started(self) -> Worker:
        """A worker that has not begun. Raises LostError where each one dies as it starts, or the server with it."""
        for _ in range(ATTEMPTS):
            try:
                return self._start()
            except (EOFError, ConnectionError):
                reason = "each one is killed as it starts"
            except OSError as error:
                reason = error.strerror or str(error)
            time.sleep(SECONDS_DEAF)
        raise LostError(f"no process can be started on this machine: {reason}")

    def _start(self) -> Worker:
        starting = context()
        ours, theirs = starting.Pipe()
        process = starting.Process(target=serve, args=(self.entry, self.common, theirs, self.scratch.name), daemon=True)
        with without_working_folder(), without_script():
            process.start()
        theirs.close()
        return Worker(process, ours)

    def end(self) -> None:
        """End idle workers by their pipes and busy ones at once."""
        for worker in self.busy.values():
            worker.process.terminate()
        for worker in (*self.idle, *self.busy.values()):
            worker.end()
        self.scratch.cleanup()


def run_all(
    entry: Entry, common: Arguments, tasks: Tasks, workers: int | None, tell: Tell, done: Done = forget
) -> Failures:
    """Call entry(tell, *common, *arguments) for each name in processes, at most `workers` at once. What it tells is
    told on, what it returns is given to done(name, result). `common` goes to a process once; the tasks are taken as
    there is room for them. A task whose process dies is begun again, ATTEMPTS times in all.

    Returns the reason for each name that failed. Ends all processes when interrupted. Raises LostError where none can
    be started, OSError where one had no room on its disk.
    """
    waiting, failed, deaths = iter(tasks), Failures(), dict[str, int]()
    with interrupts_deferred() as check:
        pool = Pool(entry, common, workers or os.cpu_count() or 1)
        try:
            while True:
                check()
                while pool.has_room and (task := next(waiting, None)):
                    pool.begin(*task)
                if not pool.busy:
                    return failed
                for ready in wait(list(pool.busy), SECONDS_DEAF):
                    worker = pool.busy[ready]
                    kind, content = message_of(worker)
                    if kind == "event":
                        tell(content)
                        continue
                    if kind == "stopped":
                        raise content
                    del pool.busy[ready]
                    deaths[worker.name] = deaths.get(worker.name, 0) + (kind == "died")
                    if kind == "died" and deaths[worker.name] < ATTEMPTS:
                        tell({"event": "again", "run": worker.name, "reason": content})
                        waiting = chain([(worker.name, worker.arguments)], waiting)
                        continue
                    if kind != "died":
                        pool.idle.append(worker)
                    del deaths[worker.name]
                    if kind == "done":
                        done(worker.name, content)
                    else:
                        failed[worker.name] = content
                        tell({"event": "failed", "run": worker.name, "reason": content})
        finally:
            pool.end()


def serve(entry: Entry, common: Arguments, pipe: Any, scratch: str) -> None:
    """The life of a worker: one task after another, until nobody sends any or nobody listens. scratch: the folder of
    its temporary files, which it removes where its parent was killed."""
    import numpy as np

    signal.signal(signal.SIGINT, signal.SIG_IGN)
    np.seterr(all="ignore")  # a simulation that overflows is counted, not warned about
    with suppress(ConnectionError, EOFError), temporary_files_in(scratch):
        while True:
            pipe.send(attempt_away(entry, (*common, *pipe.recv()), lambda event: pipe.send(("event", event))))
    parent = multiprocessing.parent_process()
    if parent and not parent.is_alive():
        shutil.rmtree(scratch, ignore_errors=True)


def attempt_away(entry: Entry, arguments: Arguments, tell: Tell) -> tuple[str, Any]:
    """As `attempt`, or `stopped` with the OSError, for the process that gave the task. Raises ConnectionError where
    that is gone."""
    try:
        return attempt(entry, arguments, tell)
    except ConnectionError:
        raise
    except OSError as error:
        return "stopped", OSError(error.errno, error.strerror or str(error), error.filename)


def attempt(entry: Entry, arguments: Arguments, tell: Tell) -> tuple[str, Any]:
    """`done` with what the entry returns, or `failed` with the reason. Raises OSError: a full disk is no fault of the
    task, which may be done once there is room."""
    try:
        return "done", entry(tell, *arguments)
    except OSError:
        raise
    except (InputError, RunError) as error:
        return "failed", str(error)
    except Exception as error:
        return "failed", f"{type(error).__name__}: {error}"


def message_of(worker: Worker) -> tuple[str, Any]:
    """What came through the pipe; where it broke, why."""
    try:
        message: tuple[str, Any] = worker.pipe.recv()
    except (EOFError, OSError):  # at the end of a message, or in the middle of it
        message = "died", died(worker.process)
    return message


def died(process: Any) -> str:
    process.join()
    code = process.exitcode
    return f"its process was killed by signal {-code}" if code < 0 else f"its process ended with exit code {code}"
