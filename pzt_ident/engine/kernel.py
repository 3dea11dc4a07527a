"""The driver that runs compiled blocks over many candidates as SIMD lanes and over tiles of time that fit the cache.

A group of WIDTH candidates goes through a tile of TILE samples, block after block. Each block is one C function,
rendered from the template of its kind (lanes/), compiled by numba and cached on disk under a name with the hash of its
source; the driver calls it by its address, so no combination of blocks is ever compiled.
"""

from __future__ import annotations

import os
from math import prod
from typing import Any

import numba
import numpy as np
from llvmlite import binding, ir
from numba import cfunc, njit, types
from numba.core.compiler import Compiler
from numba.extending import intrinsic

from pzt_ident.files import cache_folder

cache_folder()
setattr(numba.config, "CACHE_DIR", os.environ.get("NUMBA_CACHE_DIR", ""))  # noqa: B010

WIDTH = 24
TILE = 64
UNROLL = 2
VECTORS = WIDTH // 8
PADDING = 4  # samples after the last one, which an unrolled loop may read
# Three vectors at once, so that none waits for a step of another, and no loop over lanes written out before it is one.
for option in (f"-force-vector-interleave={VECTORS}", f"-unroll-full-max-count={WIDTH - 1}"):
    binding.set_option("pzt_ident", option)
OPTIONS: dict[str, Any] = {"fastmath": {"contract"}, "error_model": "numpy", "cache": True}

pointer = types.CPointer(types.float64)
SIGNATURE = types.void(types.intp, types.intp, types.intp, pointer, pointer, pointer, pointer)


class NoAliasCompiler(Compiler):
    """Compiles with pointers that never overlap, so that coefficients stay in registers."""

    def define_pipelines(self) -> Any:
        self.state.flags.noalias = True
        return super().define_pipelines()


compiled = cfunc(SIGNATURE, pipeline_class=NoAliasCompiler, **OPTIONS)


@intrinsic
def call(
    context: Any, function: Any, samples: Any, first: Any, fresh: Any, drive: Any, runs: Any, scratch: Any, tile: Any
) -> Any:
    """Call the C function at an address; the last four are addresses of float64."""

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        integer, floats = ir.IntType(64), ir.DoubleType().as_pointer()
        function_type = ir.FunctionType(ir.VoidType(), [integer] * 3 + [floats] * 4)
        function = builder.inttoptr(args[0], function_type.as_pointer())
        builder.call(function, [*args[1:4], *(builder.inttoptr(argument, floats) for argument in args[4:])])
        return context.get_dummy_value()

    return types.void(*[types.int64] * 8), generate


@intrinsic
def widen(context: Any) -> Any:
    """Use vectors of 512 bits in this function where the processor has them; LLVM's default is 256."""

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        set.add(builder.function.attributes, '"prefer-vector-width"="512"')
        return context.get_dummy_value()

    return types.void(), generate


@intrinsic
def spread(context: Any, tile: Any, row: Any, value: Any) -> Any:
    """Store the same number in every lane of a row of the tile by one instruction; LLVM would store them one by one."""

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        scalar = ir.VectorType(ir.DoubleType(), 1)
        first = builder.insert_element(ir.Constant(scalar, ir.Undefined), args[2], ir.Constant(ir.IntType(32), 0))
        lanes = ir.Constant(ir.VectorType(ir.IntType(32), WIDTH), [0] * WIDTH)
        place = builder.gep(args[0], [builder.mul(args[1], ir.Constant(args[1].type, WIDTH))])
        vector = builder.shuffle_vector(first, ir.Constant(scalar, ir.Undefined), lanes)
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
    """Keep the drive ahead of the readout blocks, the input of the operator's prompt response."""
    for i in range(samples * WIDTH):
        tile[TILE * WIDTH + i] = tile[i]


@compiled
def keep_force(samples, first, fresh, drive, runs, scratch, tile):
    """Keep the force on the mechanics."""
    for i in range(samples * WIDTH):
        tile[2 * TILE * WIDTH + i] = tile[i]


@compiled
def errors(samples, first, fresh, response, runs, sums, tile):
    """Add up e and e^2, e = y - response."""
    widen()  # type: ignore[call-arg]
    even = samples - samples % 2
    for i in range(0, even, 2):
        r0, r1 = response[first + i], response[first + i + 1]
        for j in range(WIDTH):
            e0, e1 = tile[i * WIDTH + j] - r0, tile[(i + 1) * WIDTH + j] - r1
            sums[j] += e0 + e1
            sums[WIDTH + j] += e0 * e0 + e1 * e1
    for i in range(even, samples):
        for j in range(WIDTH):
            e0 = tile[i * WIDTH + j] - response[first + i]
            sums[j] += e0
            sums[WIDTH + j] += e0 * e0


@compiled
def products(samples, first, fresh, response, runs, sums, tile):
    """Add up e = y - response and the signals of additions, and the products of each pair of them: x_0, x_0 x_0, x_1,
    x_1 x_0, x_1 x_1, ..., with x_0 = e. Row 0 of sums: the number of signals; row 1: the tile of e, ahead of theirs,
    counted from that of y."""
    widen()  # type: ignore[call-arg]
    count, begin = int(sums[0]), int(sums[WIDTH]) * TILE * WIDTH
    for i in range(samples):
        for j in range(WIDTH):
            tile[begin + i * WIDTH + j] = tile[i * WIDTH + j] - response[first + i]
    row, even = 2 * WIDTH, samples - samples % 4
    for k in range(count + 1):
        x = begin + k * TILE * WIDTH
        for i in range(0, even, 4):
            for j in range(WIDTH):
                a = x + i * WIDTH + j
                sums[row + j] += tile[a] + tile[a + WIDTH] + (tile[a + 2 * WIDTH] + tile[a + 3 * WIDTH])
        for i in range(even, samples):
            for j in range(WIDTH):
                sums[row + j] += tile[x + i * WIDTH + j]
        for m in range(k + 1):
            row += WIDTH
            y = begin + m * TILE * WIDTH
            for i in range(0, even, 4):
                for j in range(WIDTH):
                    a, b = x + i * WIDTH + j, y + i * WIDTH + j
                    first_two = tile[a] * tile[b] + tile[a + WIDTH] * tile[b + WIDTH]
                    last_two = tile[a + 2 * WIDTH] * tile[b + 2 * WIDTH] + tile[a + 3 * WIDTH] * tile[b + 3 * WIDTH]
                    sums[row + j] += first_two + last_two
            for i in range(even, samples):
                for j in range(WIDTH):
                    sums[row + j] += tile[x + i * WIDTH + j] * tile[y + i * WIDTH + j]
        row += WIDTH


@njit(nogil=True, cache=True)
def run(program, signals, scratch, count, begin, end, since, stride, output, output_tiles):
    """Run every group through the samples from `begin` to `end`, tile by tile, on from where the scratch is.

    program: (steps, 5), each step the address of a function, its row of the scratch, row of signals, tile, and first
    sample. signals: (rows, 1 + samples + PADDING), with a sample of rest before the record; the row after that of a
    drive holds its runs. scratch: (groups, rows * WIDTH). count: number of tiles. begin: a multiple of TILE, and of the
    stride. output: (candidates, tiles, samples after `since` / stride) or empty; it is filled with every `stride`-th
    sample of output_tiles.
    """
    buffer = np.zeros(count * TILE * WIDTH + 8)
    start = (-buffer.ctypes.data // 8) % 8  # on a cache line
    tiles = buffer[start : start + count * TILE * WIDTH].reshape(count, TILE * WIDTH)
    kept = max(begin, since)
    for group in range(scratch.shape[0]):
        lanes = min(WIDTH, output.shape[0] - group * WIDTH)
        for first in range(begin, end, TILE):
            here = min(TILE, end - first)
            for step in range(program.shape[0]):
                skip = max(0, program[step, 4] - first)
                if skip < here:
                    call(  # type: ignore[call-arg]
                        program[step, 0],
                        here - skip,
                        first + skip,
                        1 if first == 0 else 0,
                        signals[program[step, 2]].ctypes.data + 8,
                        signals[min(program[step, 2] + 1, signals.shape[0] - 1)].ctypes.data + 8,
                        scratch[group].ctypes.data + 8 * WIDTH * program[step, 1],
                        tiles[program[step, 3]].ctypes.data + 8 * WIDTH * skip,
                    )
            if output.size:
                left = max(first, kept)
                left += (kept - left) % stride
                for k in range(output_tiles.size):
                    for i in range(left, first + here, stride):
                        for j in range(lanes):
                            output[group * WIDTH + j, k, (i - kept) // stride] = tiles[
                                output_tiles[k], (i - first) * WIDTH + j
                            ]


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


def address(function: Any) -> int:
    """Address of a compiled C function."""
    return int(function.address)


def aligned_zeros(*shape: int) -> np.ndarray:
    """Zeros that start on a cache line."""
    size = prod(shape)
    buffer = np.zeros(size + 8)
    shift = (-buffer.ctypes.data // 8) % 8
    return buffer[shift : shift + size].reshape(shape)


VERSION = f"{numba.__version__}-{WIDTH}-{TILE}-{UNROLL}"
