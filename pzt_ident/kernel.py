"""Blocks compiled once each, run over many candidates as SIMD lanes and over tiles of time that stay in the cache.

A group of WIDTH candidates goes through a tile of TILE samples block after block. Each block is one C function of its
own, written out from the template for its kind (lanes.py), compiled by numba and cached on disk under a name that holds
the hash of its source; the driver calls it through its address, so no combination of blocks is ever compiled.
"""

from __future__ import annotations

import os
from math import log, pi, prod
from typing import Any

import numba
import numpy as np
from llvmlite import ir
from numba import cfunc, njit, types
from numba.core.compiler import Compiler
from numba.extending import intrinsic, overload, register_jitable

from pzt_ident import block
from pzt_ident.block import TILES
from pzt_ident.files import cache_folder

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


def bitwise(result: Any, make: Any) -> Any:
    """An intrinsic of one float64 that works on its bits."""

    def function(context: Any, x: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
            return make(builder, builder.bitcast(args[0], WHOLE), lambda value: ir.Constant(WHOLE, value))

        return result(types.float64), generate

    return intrinsic(function)


WHOLE = ir.IntType(64)
two_to_the = bitwise(  # 2^n from n + SHIFT
    types.float64,
    lambda ir_, bits, const: ir_.bitcast(ir_.shl(ir_.add(bits, const(1023)), const(52)), ir.DoubleType()),
)
exponent = bitwise(types.int64, lambda ir_, bits, const: ir_.sub(ir_.lshr(bits, const(52)), const(1023)))
mantissa = bitwise(
    types.float64,
    lambda ir_, bits, const: ir_.bitcast(ir_.or_(ir_.and_(bits, const(2**52 - 1)), const(1023 << 52)), ir.DoubleType()),
)

SHIFT = 1.5 * 2**52
PER_LN2 = 1 / log(2)
LN2_HIGH, LN2_LOW = float.fromhex("0x1.62e42fefap-1"), float.fromhex("0x1.cf79abc9e3b3ap-40")
PI_HIGH, PI_LOW = float.fromhex("0x1.921fb54442p+1"), float.fromhex("0x1.a308d313198a3p-40")


@register_jitable(forceinline=True)
def expm1_lanes(x):
    """exp(x) - 1 = 2^n (exp(r) - 1) + (2^n - 1), x = n ln 2 + r; Chebyshev fit to (exp(r) - 1 - r) / r^2."""
    x = min(max(x, -700.0), 700.0)
    shifted = x * PER_LN2 + SHIFT
    n = shifted - SHIFT
    r = (x - n * LN2_HIGH) - n * LN2_LOW
    p = 2.4801536388690766e-05 + r * (2.762511557828763e-06 + r * 2.761380686153829e-07)
    p = 0.008333333353729397 + r * (0.0013888888905881542 + r * (0.00019841208732536384 + r * p))
    p = r + r * r * (0.5 + r * (0.1666666666664829 + r * (0.04166666666665136 + r * p)))
    scale = two_to_the(shifted)
    return scale * p + (scale - 1)


@register_jitable(forceinline=True)
def log1p_lanes(x):
    """log(1 + x) for x > -1, with the rounding of 1 + x taken back; Chebyshev fit to (atanh(s) / s - 1) / s^2."""
    whole = 1 + x
    m = mantissa(whole)
    high = m > 1.4142135623730951
    m = 0.5 * m if high else m
    n = float(exponent(whole) + (1 if high else 0))
    s = (m - 1) / (m + 1)
    z = s * s
    p = 0.11111105549855646 + z * (0.09091445840219947 + z * (0.0766581834977067 + z * 0.07308749346957806))
    p = 0.3333333333333335 + z * (0.19999999999949516 + z * (0.14285714313095244 + z * p))
    rounding = (x - (whole - 1)) / whole
    return n * LN2_HIGH + (2 * s + (2 * s * z * p + (rounding + n * LN2_LOW)))


@register_jitable(forceinline=True)
def half_wave(x, n, turns):
    """(-1)^n sin(x - turns pi), the argument within pi / 2 of zero; Chebyshev fit to (sin(r) / r - 1) / r^2."""
    r = (x - turns * PI_HIGH) - turns * PI_LOW
    z = r * r
    p = -2.505210761393476e-08 + z * (1.6058977114074673e-10 + z * (-7.643963965925357e-13 + z * 2.731365867494017e-15))
    p = 0.008333333333333316 + z * (-0.00019841269841254885 + z * (2.7557319219139183e-06 + z * p))
    odd = n - 2 * ((0.5 * n + SHIFT) - SHIFT)
    return (1 - 2 * abs(odd)) * (r + r * z * (-0.16666666666666666 + z * p))


@register_jitable(forceinline=True)
def sin_lanes(x):
    n = (x / pi + SHIFT) - SHIFT
    return half_wave(x, n, n)


@register_jitable(forceinline=True)
def cos_lanes(x):
    """By sin(x + pi / 2), so that x is reduced before anything is added to it."""
    n = (x / pi + 0.5 + SHIFT) - SHIFT
    return half_wave(x, n, n - 0.5)


@register_jitable(forceinline=True)
def erf_lanes(x):
    """x P(x^2) / Q(x^2), a rational fit over |x| < 5.7, beyond which erf is 1 to 1e-15."""
    x = min(max(x, -5.7), 5.7)
    z = x * x
    p = 3.847400556209708e-09 + z * (4.443189190677514e-11 + z * 7.388764175151343e-14)
    p = 5.012092761694756e-05 + z * (3.1987896617852972e-06 + z * (1.1788858232347475e-07 + z * p))
    p = 0.06504868415342534 + z * (0.006617756678312501 + z * (0.0007996755629146477 + z * p))
    p = 1.1283791670955843 + z * (0.21822456998884568 + z * p)
    q = 5.017070291241489e-10 + z * (2.4556390924398634e-12 + z * 8.552561380708888e-16)
    q = 1.3216404640572998e-05 + z * (6.396443142854327e-07 + z * (2.2335858573983423e-08 + z * q))
    q = 0.021409543387979013 + z * (0.002434314698011718 + z * (0.00020592629940553638 + z * q))
    q = 1 + z * (0.5267298230545343 + z * (0.13322450303298028 + z * q))
    return x * (p / q)


@overload(block.expm1, jit_options={"forceinline": True})
def _expm1(x):
    return lambda x: expm1_lanes(x)


@overload(block.log1p, jit_options={"forceinline": True})
def _log1p(x):
    return lambda x: log1p_lanes(x)


@overload(block.erf, jit_options={"forceinline": True})
def _erf(x):
    return lambda x: erf_lanes(x)


@overload(block.sin, jit_options={"forceinline": True})
def _sin(x):
    return lambda x: sin_lanes(x)


@overload(block.cos, jit_options={"forceinline": True})
def _cos(x):
    return lambda x: cos_lanes(x)


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
