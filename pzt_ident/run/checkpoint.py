"""The losses of a search, generation by generation: replayed, they give back its optimizer's state."""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

import numpy as np

HEAD = struct.Struct("<dq")


class Generation(NamedTuple):
    """Seconds since the search began, and the losses (M,) of its candidates."""

    seconds: float
    losses: np.ndarray

    @property
    def raw(self) -> bytes:
        return HEAD.pack(self.seconds, len(self.losses)) + self.losses.astype("<f8").tobytes()


class Checkpoint:
    """The generations of a search so far, in memory and, where a path is given, on the disk."""

    def __init__(self, path: Path | None = None) -> None:
        self.path = path
        self.generations = list(read_losses(path)) if path else []

    @property
    def seconds(self) -> float:
        return self.generations[-1].seconds if self.generations else 0.0

    @property
    def failures(self) -> int:
        """Candidates whose simulation failed."""
        return sum(int(np.isinf(losses).sum()) for _, losses in self.generations)

    @contextmanager
    def appending(self) -> Iterator[Callable[[float, np.ndarray], None]]:
        """What appends a generation, on the disk behind those that the file holds whole."""
        if self.path is None:
            yield lambda seconds, losses: self.generations.append(Generation(seconds, losses))
            return
        self.path.parent.mkdir(parents=True, exist_ok=True)
        with self.path.open("r+b" if self.generations else "wb") as file:
            file.truncate(sum(len(generation.raw) for generation in self.generations))
            file.seek(0, 2)

            def append(seconds: float, losses: np.ndarray) -> None:
                generation = Generation(seconds, losses)
                file.write(generation.raw)
                file.flush()
                self.generations.append(generation)

            yield append

    def save(self, path: Path) -> None:
        """Write all generations into a file that `Checkpoint(path)` reads."""
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(b"".join(generation.raw for generation in self.generations))


def read_losses(path: Path) -> Iterator[Generation]:
    """Each whole generation on the disk; a torn last one is left out."""
    raw = path.read_bytes() if path.exists() else b""
    at = 0
    while at + HEAD.size <= len(raw):
        seconds, count = HEAD.unpack_from(raw, at)
        if count < 1 or at + HEAD.size + 8 * count > len(raw):
            return
        yield Generation(seconds, np.frombuffer(raw, "<f8", count, at + HEAD.size))
        at += HEAD.size + 8 * count
