"""What an author of a model block writes: one sample of one candidate.

`prepare` turns parameters into coefficients, once per candidate. `start` gives the state at rest under the first
input, `step` one sample. All are scalars in, scalars out; `step` has conditional expressions instead of branches. The
functions are declared without self. The kernel compiles them and batches candidates as SIMD lanes (lanes/).
"""

from __future__ import annotations

import inspect
import math
from enum import IntEnum
from functools import cache
from typing import ClassVar

from pzt_ident.parameter import Parameter


class Place(IntEnum):
    """Where a block stands in the signal chain, from the drive to the response."""

    DELAY = 0
    SLEW = 1
    AMPLIFIER = 2
    READOUT = 3
    OPERATOR = 4
    CREEP = 5
    COUPLING = 6
    GUIDE = 7
    MECHANICS = 8
    MODE = 9
    OUTPUT = 10
    SENSOR = 11


def expm1(x: float) -> float:
    """exp(x) - 1 for blocks: the kernel puts a form in its place that runs in SIMD lanes."""
    return math.expm1(x)


def log1p(x: float) -> float:
    """log(1 + x) for blocks, likewise; where x <= -1 the value means nothing but raises nothing."""
    return math.log1p(x) if x > -1 else math.nan


def sin(x: float) -> float:
    """sin(x) for blocks, likewise; good to 1e-15 while |x| < 1e4."""
    return math.sin(x) if math.isfinite(x) else math.nan


def cos(x: float) -> float:
    """cos(x) for blocks, likewise; good to 1e-15 while |x| < 1e4."""
    return math.cos(x) if math.isfinite(x) else math.nan


class Block:
    """One box of the signal chain, acting on each axis with that axis' own parameters.

    prepare(*parameters[, dt][, span]) -> coefficients; dt in s, span the peak-to-peak drive of the axis.
    start(u, *coefficients) -> states.
    step(*states, u, *coefficients) -> (*states, y).

    What can be missing from a model is an effect and says more of itself: which effects leave the same trace, the
    experiment that tells them apart, and what to do about it on the rig.
    """

    name: ClassVar[str] = ""
    place: ClassVar[Place]
    oversample: ClassVar[int] = 1
    looks_like: ClassVar[tuple[str, ...]] = ()
    separate_by: ClassVar[str] = ""
    remedy: ClassVar[str] = ""

    def __init_subclass__(cls) -> None:
        for word, function in list(vars(cls).items()):
            if inspect.isfunction(function):
                setattr(cls, word, staticmethod(function))

    @classmethod
    def parameters(cls) -> dict[str, Parameter]:
        """Declared parameters by name, in the order of declaration; a counted one is its name with `_1`, `_2`, ..."""
        found = {}
        for owner in reversed(cls.__mro__):
            for word, declared in vars(owner).items():
                if isinstance(declared, Parameter):
                    names = [word] if declared.count is None else [f"{word}_{k + 1}" for k in range(declared.count)]
                    found.update(dict.fromkeys(names, declared))
        return found

    @classmethod
    @cache
    def arguments(cls) -> tuple[str, ...]:
        """What `prepare` asks for."""
        return tuple(inspect.signature(cls.prepare).parameters)  # type: ignore[attr-defined]


class Operator(Block):
    """A hysteresis operator in closed form on a monotone step of its drive.

    Its state, counted along the motion (q = h on a rising drive, -h on a falling one), follows an affine map
    q <- keep q + add in each of two regimes: `against` the motion, q < 0, and `along` it, q >= 0.

    prepare(*parameters) -> (shared, along, against), a tuple of coefficients each.
    travel(distance, *along or against) -> (keep, add) for a step of |dU| = distance.
    near(further, keep, add, *along or against) -> the same for distance + further, from those for distance, good to
    3e-13 while |rate further| <= 0.1, the rate being the first coefficient of a regime.
    exact(q, distance, along, against) -> q, through a sign change of q, for any q.
    output(h, u, *shared) -> y.
    """


class Bank(Block):
    """Branches in parallel under one input: `step` is one branch and returns its contribution to the total.

    prepare may ask for `branch`, counted from 0, and is given each branch its own of a counted parameter.
    output(u, total, *coefficients of the first branch) -> y.
    """

    branches: ClassVar[int]


class Coupling(Block):
    """Acts across axes: step(y, other, *coefficients) -> y, once for each other axis; `other` and the first y are the
    inputs. Its parameters exist once for each ordered pair of axes."""
