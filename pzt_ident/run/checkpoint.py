"""The losses of a search, generation by generation, on the disk: replayed, they give back its optimizer's state."""

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


@contextmanager
def losses_file(path: Path, generations: list[Generation]) -> Iterator[Callable[[float, np.ndarray], None]]:
    """What appends a generation behind those that the file holds whole."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("r+b" if generations else "wb") as file:
        file.truncate(sum(HEAD.size + 8 * len(losses) for _, losses in generations))
        file.seek(0, 2)

        def append(seconds: float, losses: np.ndarray) -> None:
            file.write(HEAD.pack(seconds, len(losses)) + losses.astype("<f8").tobytes())
            file.flush()

        yield append
