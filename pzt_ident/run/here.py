"""Searches in the process that asks for them, for as long as it would take to start others."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from contextlib import suppress
from typing import Any

import numpy as np

from pzt_ident.run.pool import Failures, Tell, attempt, context, without_working_folder
from pzt_ident.run.statement import Statement
from pzt_ident.run.task import Task, search

SECONDS = 2.5
"""CPU time."""
SECONDS_TO_START = 1.0
"""How long before its end the server of other processes is started."""


class Enough(BaseException):
    """The time is over."""


def search_here(statement: Statement, tasks: Sequence[Task], tell: Tell) -> tuple[list[Task], Failures]:
    """Search task after task, until SECONDS after the first generation another one is left. Returns those that are
    left, the first of which goes on from its losses on the disk, and the reason for each that failed."""
    failed, end = Failures(), math.inf

    def tell_in_time(event: dict[str, Any]) -> None:
        nonlocal end
        tell(event)
        if event["event"] == "generation" and task is not tasks[-1]:
            now = time.process_time()
            end = min(end, now + SECONDS)
            if now >= end:
                raise Enough
            if now > end - SECONDS_TO_START:
                with suppress(OSError):  # whether one can be started is asked when it is needed
                    context()

    def entry(tell: Tell, task: Task) -> None:
        with np.errstate(all="ignore"), without_working_folder():
            search(task, statement, tell)

    for place, task in enumerate(tasks):
        try:
            kind, reason = attempt(entry, (task,), tell_in_time)
        except Enough:
            return list(tasks[place:]), failed
        if kind == "failed":
            failed[task.run] = reason
            tell({"event": "failed", "run": task.run, "reason": reason})
    return [], failed
