"""Processes side by side, watched: one that dies is named, and the others finish."""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
import threading
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from multiprocessing.connection import wait
from typing import Any

Event = dict[str, Any]
SECONDS_DEAF = 0.1


def context() -> Any:
    """Workers forked from a small server that has the kernels loaded; started afresh where that cannot be had."""
    for library in ("OPENBLAS", "MKL", "OMP"):  # one process a core; their own threads would only get in the way
        os.environ.setdefault(f"{library}_NUM_THREADS", "1")
    if sys.platform == "win32":
        return multiprocessing.get_context("spawn")
    from multiprocessing import forkserver, resource_tracker

    made = multiprocessing.get_context("forkserver")
    made.set_forkserver_preload(
        ["pzt_ident.run.task", "pzt_ident.job.schema", "pzt_ident.engine.kernel", "scipy.optimize"]
    )
    with without_working_folder():
        resource_tracker.ensure_running()  # it lets Ctrl-C through
        with interrupts_blocked():  # neither does the server hear of it
            forkserver.ensure_running()
    return made


def search_path() -> list[str]:
    """Where this process looks for modules, less the working folder of a notebook or of `python -c`: a `numpy.py`
    beside the data would be run."""
    return [place for place in sys.path if place]


_starting = threading.Lock()


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
def interrupts_blocked() -> Iterator[None]:
    """Started inside, a process is deaf to Ctrl-C, where there are signal masks."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextmanager
def interrupts_deferred() -> Iterator[Callable[[], None]]:
    """An interrupt waits for the next call of what this gives: raised in the middle of an import it can get lost."""
    asked: list[int] = []

    def check() -> None:
        if asked:
            raise KeyboardInterrupt

    main = threading.current_thread() is threading.main_thread()
    raising = [n for n in (signal.SIGINT, signal.SIGTERM) if signal.getsignal(n) is signal.default_int_handler]
    changed = raising if main else []
    for number in changed:
        signal.signal(number, lambda number, frame: asked.append(number))
    try:
        yield check
    finally:
        for number in changed:
            signal.signal(number, signal.default_int_handler)
    check()


def run_all(
    entry: Callable[..., None],
    jobs: Iterable[tuple[str, tuple[Any, ...]]],
    workers: int | None,
    tell: Callable[[Event], None],
) -> dict[str, str]:
    """Run entry(*arguments, pipe) for each name, at most `workers` at once. What comes through a pipe is told on; a
    process that ends without sending None has failed.

    Returns the reason for each name that failed. Ends all processes when interrupted.
    """
    waiting, failed = list(jobs), dict[str, str]()
    running: dict[Any, tuple[str, Any]] = {}
    with interrupts_deferred() as check:
        made = context()
        try:
            while waiting or running:
                check()
                while waiting and len(running) < (workers or os.cpu_count() or 1):
                    name, arguments = waiting.pop(0)
                    ours, process = started(made, entry, name, arguments)
                    running[ours] = name, process
                for ready in wait(list(running), SECONDS_DEAF):
                    name, process = running[ready]
                    event = said(ready, name, process)
                    if event is None or event["event"] == "failed":
                        del running[ready]
                        process.join()
                    if event is not None:
                        tell(event)
                        if event["event"] == "failed":
                            failed[name] = event["reason"]
        finally:
            for _, process in running.values():
                process.terminate()
            for _, process in running.values():
                process.join()
    return failed


def started(made: Any, entry: Callable[..., None], name: str, arguments: tuple[Any, ...]) -> tuple[Any, Any]:
    """Our end of its pipe, and the process."""
    ours, theirs = made.Pipe(duplex=False)
    process = made.Process(target=entry, args=(*arguments, theirs), name=name, daemon=True)
    with without_working_folder():
        process.start()
    theirs.close()
    return ours, process


def said(pipe: Any, name: str, process: Any) -> Event | None:
    """What came through the pipe; where it broke, why."""
    try:
        event: Event | None = pipe.recv()
    except EOFError:
        event = {"event": "failed", "run": name, "reason": died(process)}
    return event


def died(process: Any) -> str:
    process.join()
    code = process.exitcode
    return f"its process was killed by signal {-code}" if code < 0 else f"its process ended with exit code {code}"
