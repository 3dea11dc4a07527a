"""Blocks compiled once each, run over many candidates as SIMD lanes and over tiles of time that stay in the cache.

A group of WIDTH candidates goes through a tile of TILE samples block after block. Each block is one C function of its
own, written out from the template for its kind (lanes.py), compiled by numba and cached on disk under a name that holds
the hash of its source; the driver calls it through its address, so no combination of blocks is ever compiled.
"""

from __future__ import annotations

import os
from math import prod
from typing import Any

import numba
import numpy as np
from llvmlite import ir
from numba import cfunc, njit, types
from numba.core.compiler import Compiler
from numba.extending import intrinsic

from pzt_ident.files import cache_folder
from pzt_ident.model.block import TILES

cache_folder()
setattr(numba.config, "CACHE_DIR", os.environ.get("NUMBA_CACHE_DIR", ""))  # noqa: B010

WIDTH = 24
TILE = 64
UNROLL = 2
PADDING = 4  # samples behind the last one, which a loop over several at once may touch
OPTIONS: dict[str, Any] = {"fastmath": {"contract"}, "error_model": "numpy", "cache": True}

pointer = types.CPointer(types.float64)
SIGNATURE = types.void(types.intp, types.intp, types.intp, pointer, pointer, pointer, pointer)


class Apart(Compiler):
    """Compiles with pointers that never point at the same numbers, so that coefficients stay in registers."""

    def define_pipelines(self) -> Any:
        self.state.flags.noalias = True
        return super().define_pipelines()


compiled = cfunc(SIGNATURE, pipeline_class=Apart, **OPTIONS)


@intrinsic
def call(
    context: Any, function: Any, samples: Any, first: Any, fresh: Any, drive: Any, runs: Any, scratch: Any, tile: Any
) -> Any:
    """Call the C function at an address; the last four are addresses of float64."""

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        whole, real = ir.IntType(64), ir.DoubleType().as_pointer()
        kind = ir.FunctionType(ir.VoidType(), [whole] * 3 + [real] * 4)
        function = builder.inttoptr(args[0], kind.as_pointer())
        builder.call(function, [*args[1:4], *(builder.inttoptr(a, real) for a in args[4:])])
        return context.get_dummy_value()

    return types.void(*[types.int64] * 8), generate


@intrinsic
def widen(context: Any) -> Any:
    """Vectors of 512 bits in this function where the processor has them; LLVM takes 256 of its own accord."""

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        set.add(builder.function.attributes, '"prefer-vector-width"="512"')
        return context.get_dummy_value()

    return types.void(), generate


@intrinsic
def spread(context: Any, tile: Any, row: Any, value: Any) -> Any:
    """The same number in every lane of a row of the tile: LLVM would store them one by one."""

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        one = ir.VectorType(ir.DoubleType(), 1)
        first = builder.insert_element(ir.Constant(one, ir.Undefined), args[2], ir.Constant(ir.IntType(32), 0))
        lanes = ir.Constant(ir.VectorType(ir.IntType(32), WIDTH), [0] * WIDTH)
        place = builder.gep(args[0], [builder.mul(args[1], ir.Constant(args[1].type, WIDTH))])
        vector = builder.shuffle_vector(first, ir.Constant(one, ir.Undefined), lanes)
        builder.store(vector, builder.bitcast(place, vector.type.as_pointer()), align=8)
        return context.get_dummy_value()

    return types.void(tile, types.intp, types.float64), generate


@compiled
def fill(samples, first, fresh, drive, runs, scratch, tile):
    """The drive itself, the same in every lane."""
    widen()  # type: ignore[call-arg]
    for i in range(samples):
        spread(tile, i, drive[first + i])


@compiled
def keep_prompt(samples, first, fresh, drive, runs, scratch, tile):
    """What the operator's prompt response is driven by, ahead of the readout."""
    for i in range(samples * WIDTH):
        tile[TILE * WIDTH + i] = tile[i]


@compiled
def keep_force(samples, first, fresh, drive, runs, scratch, tile):
    """What the mechanics is driven by."""
    for i in range(samples * WIDTH):
        tile[2 * TILE * WIDTH + i] = tile[i]


@compiled
def errors(samples, first, fresh, response, runs, sums, tile):
    """Sum of e and e^2, e = y - response."""
    widen()  # type: ignore[call-arg]
    whole = samples - samples % 2
    for i in range(0, whole, 2):
        r0, r1 = response[first + i], response[first + i + 1]
        for j in range(WIDTH):
            e0, e1 = tile[i * WIDTH + j] - r0, tile[(i + 1) * WIDTH + j] - r1
            sums[j] += e0 + e1
            sums[WIDTH + j] += e0 * e0 + e1 * e1
    for i in range(whole, samples):
        for j in range(WIDTH):
            e0 = tile[i * WIDTH + j] - response[first + i]
            sums[j] += e0
            sums[WIDTH + j] += e0 * e0


@njit(nogil=True, cache=True)
def run(program, signals, scratch, axes, samples, since, stride, output, take):
    """Run every group through every tile.

    program: (steps, 5) of address, scratch row, row of signals, tile, from which sample on.
    signals: (rows, 1 + samples + PADDING), a sample of rest before the record; the row behind a drive's holds its runs.
    scratch: (groups, rows * WIDTH). output: (groups * WIDTH, axes, samples after `since` / stride) or empty, filled
    from the signals of the axes in `take`, every `stride`-th sample.
    """
    room = np.zeros(TILES * axes * TILE * WIDTH + 8)
    start = (-room.ctypes.data // 8) % 8  # on a cache line
    tiles = room[start : start + TILES * axes * TILE * WIDTH].reshape(TILES * axes, TILE * WIDTH)
    for group in range(scratch.shape[0]):
        for first in range(0, samples, TILE):
            count = min(TILE, samples - first)
            for step in range(program.shape[0]):
                skip = max(0, program[step, 4] - first)
                if skip < count:
                    call(  # type: ignore[call-arg]
                        program[step, 0],
                        count - skip,
                        first + skip,
                        1 if first == 0 else 0,
                        signals[program[step, 2]].ctypes.data + 8,
                        signals[min(program[step, 2] + 1, signals.shape[0] - 1)].ctypes.data + 8,
                        scratch[group].ctypes.data + 8 * WIDTH * program[step, 1],
                        tiles[program[step, 3]].ctypes.data + 8 * WIDTH * skip,
                    )
            if output.size:
                begin = max(first, since)
                begin += (since - begin) % stride
                for axis in range(take.size):
                    for i in range(begin, first + count, stride):
                        for j in range(WIDTH):
                            output[group * WIDTH + j, axis, (i - since) // stride] = tiles[
                                TILES * take[axis], (i - first) * WIDTH + j
                            ]


def runs_of(drive: np.ndarray) -> np.ndarray:
    """For each sample the end (excluded) of the monotone run of the drive that it stands in: positive where all steps
    from there to the end are the same to 1e-11, else negative. drive: (samples,), the first one at rest."""
    move = np.diff(drive, prepend=drive[:1])
    number = np.arange(drive.size)
    direction = np.where(move >= 0, 1, -1)
    turn = np.append(direction[1:] != direction[:-1], True)
    other = np.append(np.abs(move[1:] - move[:-1]) > 1e-11 * np.abs(move[:-1]), True) | turn
    same = next_true(other)
    long = same - number >= 2 * UNROLL
    begins = (
        np.append(long[1:] & ~long[:-1], True) | turn
    )  # where a stretch of varying steps gives way to a constant one
    return np.where(long, same, -next_true(begins)).astype(float)


def next_true(flags: np.ndarray) -> np.ndarray:
    """One past the first true at or behind each place; the last one is true."""
    ends = np.flatnonzero(flags) + 1
    return ends[np.searchsorted(ends, np.arange(flags.size), side="right")]


def address(function: Any) -> int:
    """Where a compiled C function stands."""
    return int(function.address)


def aligned(*shape: int) -> np.ndarray:
    """Zeros that begin on a cache line."""
    size = prod(shape)
    raw = np.zeros(size + 8)
    shift = (-raw.ctypes.data // 8) % 8
    return raw[shift : shift + size].reshape(shape)


VERSION = f"{numba.__version__}-{WIDTH}-{TILE}-{UNROLL}"
