"""What a mutation is, and those of bytes, whatever they say."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

Random = np.random.Generator
Kind = dict[str, Callable[..., Any]]
"""Mutations by name: of what is good and a random generator, to what is not, what must come of it and, where an error
must show it, a value. They raise LookupError where there is nothing to change."""

REFUSE, SAME, READ = "refuse", "same", "read"
"""What must come of a mutant: an error; the result of what is good; either an error, or what another reader finds."""

BYTES: Kind = {}


def kind(of: Kind) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    def add(function: Callable[..., Any]) -> Callable[..., Any]:
        of[function.__name__.replace("_", " ")] = function
        return function

    return add


@dataclass(frozen=True)
class Mutant:
    """expect: see above. value: what an error must show."""

    how: str
    content: bytes
    expect: str
    value: str = ""


def mutant(kinds: Sequence[tuple[Kind, float, Callable[[], Any], Callable[[Any], str]]], rng: Random) -> Mutant:
    """A mutation by chance. kinds: with their shares, what makes what is good, and what writes it."""
    shares = np.array([share for _, share, _, _ in kinds])
    while True:
        functions, _, good, written = kinds[rng.choice(len(kinds), p=shares / shares.sum())]
        how = list(functions)[rng.integers(len(functions))]
        try:
            changed, expect, *value = functions[how](good(), rng)
        except LookupError:
            continue
        content = changed if isinstance(changed, bytes) else (changed if isinstance(changed, str) else written(changed))
        return Mutant(how, content if isinstance(content, bytes) else content.encode(), expect, *value)


@kind(BYTES)
def bytes_flipped(raw: bytes, rng: Random) -> Any:
    changed = bytearray(raw)
    for place in rng.integers(0, len(raw), rng.integers(1, 5)):
        changed[place] ^= 1 << int(rng.integers(8))
    return bytes(changed), READ


@kind(BYTES)
def bytes_inserted(raw: bytes, rng: Random) -> Any:
    place = int(rng.integers(len(raw)))
    return raw[:place] + rng.bytes(int(rng.integers(1, 6))) + raw[place:], READ


@kind(BYTES)
def letters_inserted(raw: bytes, rng: Random) -> Any:
    place = int(rng.integers(len(raw)))
    letters = b"\t\n -:,[]{}#&*!|>'\"%@`0e.~?\x00"
    return raw[:place] + bytes(rng.choice(list(letters), int(rng.integers(1, 4))).tolist()) + raw[place:], READ


@kind(BYTES)
def part_cut_out(raw: bytes, rng: Random) -> Any:
    first, last = sorted(rng.integers(0, len(raw), 2).tolist())
    return raw[:first] + raw[last:], READ


@kind(BYTES)
def cut_off(raw: bytes, rng: Random) -> Any:
    return raw[: int(rng.integers(len(raw)))], READ


@kind(BYTES)
def part_twice(raw: bytes, rng: Random) -> Any:
    first, last = sorted(rng.integers(0, len(raw), 2).tolist())
    return raw[:last] + raw[first:last] + raw[last:], READ


@kind(BYTES)
def zeros(raw: bytes, rng: Random) -> Any:
    return bytes(len(raw)), REFUSE


@kind(BYTES)
def noise(raw: bytes, rng: Random) -> Any:
    return rng.bytes(int(rng.integers(1, 3000))), REFUSE


@kind(BYTES)
def utf_16(raw: bytes, rng: Random) -> Any:
    return raw.decode("latin-1").encode("utf-16"), READ


def carriage_returns(text: str, rng: Random) -> Any:
    return text.replace("\n", "\r\n"), SAME


def byte_order_mark(text: str, rng: Random) -> Any:
    return b"\xef\xbb\xbf" + text.encode(), SAME


def without_last_newline(text: str, rng: Random) -> Any:
    return text.rstrip("\n"), SAME
