"""The losses of a search, generation by generation: replayed, they give back its optimizer's state."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

import numpy as np

HEAD = struct.Struct("<dqI")  # seconds, number of losses, CRC-32 of them and of the two


class Generation(NamedTuple):
    """Seconds since the search began, and the losses (M,) of its candidates."""

    seconds: float
    losses: np.ndarray

    @property
    def raw(self) -> bytes:
        losses = self.losses.astype("<f8").tobytes()
        return HEAD.pack(self.seconds, len(self.losses), _check(self.seconds, losses)) + losses


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
    """Each whole generation on the disk, up to the first that is torn or damaged."""
    raw = path.read_bytes() if path.exists() else b""
    at = 0
    while at + HEAD.size <= len(raw):
        seconds, count, check = HEAD.unpack_from(raw, at)
        start, end = at + HEAD.size, at + HEAD.size + 8 * count
        if count < 1 or end > len(raw) or _check(seconds, raw[start:end]) != check:
            return
        yield Generation(seconds, np.frombuffer(raw, "<f8", count, start))
        at = end


def _check(seconds: float, losses: bytes) -> int:
    return zlib.crc32(losses, zlib.crc32(struct.pack("<dq", seconds, len(losses) // 8)))
