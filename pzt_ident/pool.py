"""Processes side by side, watched: one that dies is named, and the others finish."""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from multiprocessing.connection import wait
from typing import Any

Event = dict[str, Any]


def context() -> Any:
    """Workers forked from a small server that has the kernels loaded; started afresh where that cannot be had."""
    for library in ("OPENBLAS", "MKL", "OMP"):  # one process a core; their own threads would only get in the way
        os.environ.setdefault(f"{library}_NUM_THREADS", "1")
    if sys.platform == "win32":
        return multiprocessing.get_context("spawn")
    from multiprocessing import forkserver, resource_tracker

    made = multiprocessing.get_context("forkserver")
    made.set_forkserver_preload(["pzt_ident.worker", "pzt_ident.job", "pzt_ident.kernel", "scipy.optimize"])
    resource_tracker.ensure_running()  # it lets Ctrl-C through
    with uninterrupted():  # neither does the server hear of it
        forkserver.ensure_running()
    return made


@contextmanager
def uninterrupted() -> Iterator[None]:
    """Ctrl-C waits, where there are signal masks: a process is started whole, or not at all."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


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
    waiting, made = list(jobs), context()
    running: dict[Any, tuple[str, Any]] = {}
    failed: dict[str, str] = {}
    try:
        while waiting or running:
            while waiting and len(running) < (workers or os.cpu_count() or 1):
                name, arguments = waiting.pop(0)
                ours, theirs = made.Pipe(duplex=False)
                process = made.Process(target=entry, args=(*arguments, theirs), name=name, daemon=True)
                with uninterrupted():
                    process.start()
                    running[ours] = name, process
                theirs.close()
            for ready in wait(list(running)):
                pipe: Any = ready
                name, process = running[pipe]
                try:
                    event = pipe.recv()
                except EOFError:
                    event = {"event": "failed", "run": name, "reason": died(process)}
                if event is None or event["event"] == "failed":
                    del running[pipe]
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


def died(process: Any) -> str:
    process.join()
    code = process.exitcode
    return f"its process was killed by signal {-code}" if code < 0 else f"its process ended with exit code {code}"
