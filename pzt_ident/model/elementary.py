"""Elementary functions for the steps of blocks; authors import them from `pzt_ident.model.block`."""

import math


def expm1(x: float) -> float:
    """exp(x) - 1 for blocks; compiled blocks use a version that runs in SIMD lanes."""
    return math.expm1(x)


def log1p(x: float) -> float:
    """log(1 + x) for blocks, likewise; undefined for x <= -1, but raises no error there."""
    return math.log1p(x) if x > -1 else math.nan


def log(x: float) -> float:
    """log(x) for blocks, likewise; undefined for x <= 0, but raises no error there."""
    return math.log(x) if x > 0 else math.nan


def rough_log(x: float) -> float:
    """log(x) for x > 0, where an iteration starts; in lanes it is off by up to 0.03."""
    return math.log(x)


def rough_inverse_cube_root(x: float) -> float:
    """x^(-1/3) for x > 0, likewise; in lanes it is off by up to 4 %."""
    return x ** (-1 / 3)


def sin(x: float) -> float:
    """sin(x) for blocks, likewise; accurate to 1e-15 for |x| < 1e4."""
    return math.sin(x) if math.isfinite(x) else math.nan


def cos(x: float) -> float:
    """cos(x) for blocks, likewise; accurate to 1e-15 for |x| < 1e4."""
    return math.cos(x) if math.isfinite(x) else math.nan


def erf(x: float) -> float:
    """erf(x) for blocks, likewise; accurate to 1e-14."""
    return math.erf(x)
