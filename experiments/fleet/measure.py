"""What a task costs beside itself, and how memory goes with the number of devices."""

from __future__ import annotations

import os
import resource
import time
from statistics import median
from typing import Any

import psutil

from pzt_ident.run.place import Place

CARGO, RESULT = 100_000, 250_000  # bytes of the files of a device of two records of 2,000 samples, and of its results
MIB = 2**20


def work(tell: Any, seconds: float, data: bytes) -> tuple[float, bytes]:
    """A task that waits, so that it takes no core from what is measured."""
    start = time.perf_counter()
    time.sleep(seconds)
    return time.perf_counter() - start, bytes(RESULT)


def overhead(place: Place, tasks: int, seconds: float, workers: int) -> dict[str, float]:
    """Seconds beside its own that each task takes from a worker, from the first result to the last; and the share of
    the workers' time that tasks have."""
    ends: list[float] = []
    waits: list[float] = []

    def note(name: str, result: tuple[float, bytes]) -> None:
        ends.append(time.perf_counter())
        waits.append(result[0])

    todo = ((str(i), (seconds, os.urandom(CARGO))) for i in range(tasks))
    place.run_all(work, (), todo, lambda event: None, note)
    span, counted = ends[-1] - ends[workers - 1], waits[workers:]
    return {"overhead": (span * workers - sum(counted)) / len(counted), "efficiency": sum(counted) / (span * workers)}


class Memory:
    """The resident memory of processes by the number of devices done; a listener to a fleet."""

    def __init__(self, processes: dict[str, int], every: int) -> None:
        self.processes = {name: psutil.Process(number) for name, number in processes.items()}
        self.every, self.rows, self.begun = every, [], time.perf_counter()

    rows: list[dict[str, float]]

    def __call__(self, event: dict[str, Any]) -> None:
        if event["event"] == "devices" and event["done"] % self.every == 0:
            if self.rows and self.rows[-1]["devices"] == event["done"]:
                return
            sizes = {name: process.memory_info().rss / MIB for name, process in self.processes.items()}
            self.rows.append({"devices": event["done"], "seconds": time.perf_counter() - self.begun, **sizes})

    def growth(self, name: str) -> float:
        """KiB a device, from the first third on: by then all is loaded."""
        late = self.rows[len(self.rows) // 3 :]
        slopes = [
            (b[name] - a[name]) / (b["devices"] - a["devices"]) for i, a in enumerate(late) for b in late[i + 1 :]
        ]
        return median(slopes) * 1024


def peak() -> float:
    """The most memory that this process has had, MiB."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
