"""Elementary functions that run in SIMD lanes; they replace those of pzt_ident.model.block in compiled blocks."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import intrinsic, overload, register_jitable

from pzt_ident.model import block


def bitwise(result: Any, build: Any, given: Any = types.float64) -> Any:
    """An intrinsic of one float64, or int64, that works on its bits."""

    def function(context: Any, x: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
            return build(builder, builder.bitcast(args[0], INTEGER), lambda value: ir.Constant(INTEGER, value))

        return result(given), generate

    return intrinsic(function)


INTEGER = ir.IntType(64)
two_to_the = bitwise(  # 2^n from n + SHIFT
    types.float64,
    lambda ir_, bits, const: ir_.bitcast(ir_.shl(ir_.add(bits, const(1023)), const(52)), ir.DoubleType()),
)
two_to_minus = bitwise(  # 2^-n from a whole n, zero for 1023
    types.float64,
    lambda ir_, bits, const: ir_.bitcast(ir_.shl(ir_.sub(const(1023), bits), const(52)), ir.DoubleType()),
    types.int64,
)
bits_of = bitwise(types.int64, lambda ir_, bits, const: bits)
float_of = bitwise(types.float64, lambda ir_, bits, const: ir_.bitcast(bits, ir.DoubleType()), types.int64)
exponent = bitwise(types.int64, lambda ir_, bits, const: ir_.sub(ir_.lshr(bits, const(52)), const(1023)))
mantissa = bitwise(
    types.float64,
    lambda ir_, bits, const: ir_.bitcast(ir_.or_(ir_.and_(bits, const(2**52 - 1)), const(1023 << 52)), ir.DoubleType()),
)

SHIFT = 1.5 * 2**52
LN2 = math.log(2)
PER_LN2, PER_PI = 1 / LN2, 1 / math.pi
LN2_HIGH, LN2_LOW = float.fromhex("0x1.62e42fefap-1"), float.fromhex("0x1.cf79abc9e3b3ap-40")
PI_HIGH, PI_LOW = float.fromhex("0x1.921fb54442p+1"), float.fromhex("0x1.a308d313198a3p-40")


@register_jitable(forceinline=True)
def expm1(x):
    """exp(x) - 1 = 2^n (exp(r) - 1) + (2^n - 1), x = n ln 2 + r; Chebyshev fit to (exp(r) - 1 - r) / r^2."""
    x = min(max(x, -700.0), 700.0)
    shifted = x * PER_LN2 + SHIFT
    n = shifted - SHIFT
    r = (x - n * LN2_HIGH) - n * LN2_LOW
    z = r * r
    even = 0.5 + z * (
        0.04166666666665136 + z * (0.0013888888905881542 + z * (2.4801536388690766e-05 + z * 2.761380686153829e-07))
    )
    odd = 0.1666666666664829 + z * (0.008333333353729397 + z * (0.00019841208732536384 + z * 2.762511557828763e-06))
    p = r + z * (even + r * odd)
    scale = two_to_the(shifted)
    return scale * p + (scale - 1)


@register_jitable(forceinline=True)
def log1p(x):
    """log(1 + x) for x > -1, corrected for the rounding of 1 + x."""
    return log_of_sum(1 + x, x - ((1 + x) - 1))


@register_jitable(forceinline=True)
def log(x):
    """log(x) for x > 0, not below 1e-300."""
    return log_of_sum(x, 0.0)


@register_jitable(forceinline=True)
def log_of_sum(x, rest):
    """log(x + rest), x > 0 and the rest below its rounding; Chebyshev fit to (atanh(s) / s - 1) / s^2."""
    m = mantissa(x)
    high = m > 1.4142135623730951
    m = 0.5 * m if high else m
    power = exponent(x) + (1 if high else 0)
    n = float(power)
    s = ((m - 1) + rest * two_to_minus(power)) / (m + 1)
    z = s * s
    w = z * z
    even = 0.3333333333333335 + w * (0.14285714313095244 + w * (0.09091445840219947 + w * 0.07308749346957806))
    odd = 0.19999999999949516 + w * (0.11111105549855646 + w * 0.0766581834977067)
    return n * LN2_HIGH + (2 * s + (2 * s * z * (even + z * odd) + n * LN2_LOW))


@register_jitable(forceinline=True)
def rough_log(x):
    """The bits of x as a whole number are nearly its logarithm: exponent plus mantissa."""
    return float(bits_of(x)) * (LN2 / 2**52) - (1023 - 0.043) * LN2


@register_jitable(forceinline=True)
def rough_inverse_cube_root(x):
    return float_of(int((4 / 3 * 1023 - 0.06) * 2.0**52 - float(bits_of(x)) * (1 / 3)))


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
def sin(x):
    n = (x * PER_PI + SHIFT) - SHIFT
    return half_wave(x, n, n)


@register_jitable(forceinline=True)
def cos(x):
    """sin(x + pi / 2), with x reduced before pi / 2 is added."""
    n = (x * PER_PI + 0.5 + SHIFT) - SHIFT
    return half_wave(x, n, n - 0.5)


@register_jitable(forceinline=True)
def erf(x):
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


def replace(function: Callable[[float], float], lanes: Any) -> None:
    """Have compiled code call `lanes` where an author calls `function`."""

    @overload(function, jit_options={"forceinline": True})
    def replacement(x):
        return lambda x: lanes(x)


for function, lanes in (
    (block.expm1, expm1),
    (block.log1p, log1p),
    (block.log, log),
    (block.erf, erf),
    (block.rough_log, rough_log),
    (block.rough_inverse_cube_root, rough_inverse_cube_root),
    (block.sin, sin),
    (block.cos, cos),
):
    replace(function, lanes)
