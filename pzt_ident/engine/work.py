"""The work of simulations, in seconds of a processor core that is taken as the same on every machine.

A budget is spent by it, so that an answer depends neither on the machine nor on what else that does, nor on how many
threads share the work: each thread counts its own.
"""

from __future__ import annotations

import threading

CALL = 5.5e-4  # s: a run of the kernel, with what is calculated around it
LANE = 1.7e-9  # s: a candidate through a step of time
ROW = 2.7e-11  # s: for each number that it keeps there, which are the more the more branches a block has

_counted = threading.local()


def done() -> float:
    """Seconds of work that this thread has done, or was told of."""
    return float(getattr(_counted, "seconds", 0.0))


def add(seconds: float) -> None:
    """Count work of this thread, or such that another one did for it."""
    _counted.seconds = done() + seconds


def begin(seconds: float) -> None:
    """Count on from so many seconds: of a thread that does the work of another one."""
    _counted.seconds = seconds


def of_run(candidates: int, steps: int, rows: int, solving: float = 0.0) -> float:
    """Seconds of so many candidates, each with so many rows of the scratch, through so many steps of time. solving: s,
    of each step, what blocks solve for in it (`Block.solving`)."""
    return CALL + (LANE + ROW * rows + solving) * candidates * steps
