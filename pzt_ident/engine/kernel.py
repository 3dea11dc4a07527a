"""The driver that runs compiled blocks over many candidates as SIMD lanes and over tiles of time that fit the cache.

A group of WIDTH candidates goes through a tile of TILE samples, block after block. Each block is one C function,
rendered from the template of its kind (lanes/), compiled by numba and kept as an object file under a name with the hash
of its source; the driver calls it by its address, so no combination of blocks is ever compiled.
"""

from __future__ import annotations

import ctypes
from functools import cache
from math import prod
from pathlib import Path
from typing import Any

import numpy as np

from pzt_ident.engine.native import NUMBA, address_of, name_of

WIDTH = 24
TILE = 64
UNROLL = 2
VECTORS = WIDTH // 8
PADDING = 4  # samples after the last one, which an unrolled loop may read
SERIES = {8: 0.057, 12: 0.25, 16: 0.55}  # nodes of a power series: half of the range on which it is erf to 1e-14
VERSION = f"{NUMBA}-{WIDTH}-{TILE}-{UNROLL}"


@cache
def address(function: str) -> int:
    """Address of a C function of `tiles`."""

    def compiled() -> Any:
        from pzt_ident.engine import tiles

        return getattr(tiles, function)

    return address_of(name_of(function, VERSION, *sources("jit", "tiles")), compiled)


def sources(*modules: str) -> list[str]:
    """The source of modules beside this one."""
    return [Path(__file__).with_name(f"{module}.py").read_text(encoding="utf-8") for module in modules]


def run(
    program: np.ndarray,
    signals: np.ndarray,
    scratch: np.ndarray,
    candidates: int,
    count: int,
    begin: int,
    end: int,
    since: int,
    stride: int,
    output: np.ndarray,
    output_tiles: np.ndarray,
) -> None:
    """Run every group through the samples from `begin` to `end`, tile by tile, on from where the scratch is.

    program: (steps, 5), each step the address of a function, its row of the scratch, row of signals, tile, and first
    sample. signals: (rows, 1 + samples + PADDING), with a sample of rest before the record; the row after that of a
    drive holds its runs. scratch: (groups, rows * WIDTH), of so many candidates and copies of the last one. count:
    number of tiles. begin: a multiple of TILE, and of the stride. output: (candidates, tiles, samples after `since` /
    stride) or empty; it is filled with every `stride`-th sample of output_tiles.
    """
    tiles, wanted = aligned_zeros(count * TILE * WIDTH), np.ascontiguousarray(output_tiles, dtype=np.int64)
    assert all(array.flags.c_contiguous for array in (program, signals, scratch, output))
    at, kept = tiles.ctypes.data, output.shape[2] if output.size else 0
    _driver()(
        program.ctypes.data, len(program),
        signals.ctypes.data, len(signals), signals.strides[0],
        scratch.ctypes.data, len(scratch), scratch.strides[0], candidates,
        at, at, begin, end, max(begin, since), stride,
        output.ctypes.data, kept,
        wanted.ctypes.data, wanted.size,
    )  # fmt: skip


@cache
def _driver() -> Any:
    return ctypes.CFUNCTYPE(None, *[ctypes.c_ssize_t] * 19)(address("run"))


def runs_of(drive: np.ndarray) -> np.ndarray:
    """For each sample the end (excluded) of the monotone run of the drive that it is in: positive if all steps from the
    sample to the end are equal to 1e-11, negative otherwise. drive: (samples,), starting at rest."""
    move = np.diff(drive, prepend=drive[:1])
    number = np.arange(drive.size)
    direction = np.where(move >= 0, 1, -1)
    reverses = np.append(direction[1:] != direction[:-1], True)
    changes = np.append(np.abs(move[1:] - move[:-1]) > 1e-11 * np.abs(move[:-1]), True) | reverses
    constant_end = next_true(changes)
    constant = constant_end - number >= 2 * UNROLL
    varying_ends = np.append(constant[1:] & ~constant[:-1], True) | reverses
    return np.where(constant, constant_end, -next_true(varying_ends)).astype(float)


def next_true(flags: np.ndarray) -> np.ndarray:
    """For each place, one past the first true flag at or after it; the last flag is true."""
    ends = np.flatnonzero(flags) + 1
    return ends[np.searchsorted(ends, np.arange(flags.size), side="right")]


def aligned_zeros(*shape: int) -> np.ndarray:
    """Zeros that start on a cache line."""
    size = prod(shape)
    buffer = np.zeros(size + 8)
    shift = (-buffer.ctypes.data // 8) % 8
    return buffer[shift : shift + size].reshape(shape)
