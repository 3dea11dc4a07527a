"""Power series in the lanes of a bank, by which branches are read that have smooth responses: one of many branches that
all follow how far their input has come in a tile of time, and one of a branch in its state.

A series begins at place `at` of the scratch c, in rows of WIDTH numbers: MIDDLE and HALF of its range, and one over the
half, PER_HALF; ARGUMENTS at the nodes, VALUES there, and POWERS, the coefficients of the powers of its argument in -1
to 1. The way of an input through a tile begins at another place: LOW and HIGH, its least and its largest value, the
LAST one ahead among them; the FIRST in the tile, and the one farthest from that, FAR; the farthest so far, REACHED,
and BACK, the most by which an input lies behind it. t: the tile, the input of which is in its first rows.
"""

from __future__ import annotations

import numpy as np
from numba.extending import register_jitable
from numpy.polynomial import chebyshev

from pzt_ident.engine.kernel import SERIES, WIDTH

MOST = max(SERIES)
MIDDLE, HALF, PER_HALF, ARGUMENTS, VALUES, POWERS = (i * WIDTH for i in (0, 1, 2, 3, 3 + MOST, 3 + 2 * MOST))
LOW, HIGH, LAST, FIRST, FAR, REACHED, BACK = (i * WIDTH for i in range(7))


def nodes_of(count: int) -> np.ndarray:
    """Those of Chebyshev on -1 to 1."""
    return np.cos(np.pi * (np.arange(count) + 0.5) / count)


def shares_of(count: int) -> np.ndarray:
    """The coefficients of a Chebyshev series by its values at the nodes, a cosine transform: (degrees, nodes)."""
    shares = 2 / count * chebyshev.chebvander(nodes_of(count), count - 1).T
    shares[0] /= 2
    return shares


def powers_of(count: int) -> np.ndarray:
    """The coefficients of the powers by those of a Chebyshev series: (powers, degrees)."""
    powers = np.zeros((count, count))
    for degree in range(count):
        powers[: degree + 1, degree] = chebyshev.cheb2poly(np.eye(count)[degree])[: degree + 1]
    return powers


NODES = np.concatenate([nodes_of(count) for count in SERIES])
SHARES = np.concatenate([shares_of(count).ravel() for count in SERIES])
TO_POWERS = np.concatenate([powers_of(count).ravel() for count in SERIES])


@register_jitable(forceinline=True)
def range_over(c, at, j, low, high):
    """Have a series go from one argument to another in a lane."""
    half = 0.5 * (high - low)
    c[at + MIDDLE + j], c[at + HALF + j] = 0.5 * (high + low), half
    c[at + PER_HALF + j] = 1 / half if half != 0.0 else 0.0


@register_jitable(forceinline=True)
def place(c, at, count, first, lanes):
    """The arguments at so many nodes, those of NODES from the first on, with values of zero. lanes: of a row."""
    for k in range(count):
        for j in range(lanes):
            c[at + ARGUMENTS + k * WIDTH + j] = c[at + MIDDLE + j] + c[at + HALF + j] * NODES[first + k]
            c[at + VALUES + k * WIDTH + j] = 0.0


@register_jitable(forceinline=True)
def fit(c, at, count, first, lanes):
    """The coefficients of the powers by the values at the nodes. first: of those of SHARES and TO_POWERS. lanes: of a
    row."""
    for m in range(count):
        for j in range(lanes):
            c[at + POWERS + m * WIDTH + j] = 0.0
        for k in range(count):
            for j in range(lanes):
                c[at + POWERS + m * WIDTH + j] += SHARES[first + m * count + k] * c[at + VALUES + k * WIDTH + j]
    for m in range(count):
        for j in range(lanes):
            c[at + POWERS + m * WIDTH + j] *= TO_POWERS[first + m * count + m]
        for k in range(m + 2, count, 2):
            for j in range(lanes):
                c[at + POWERS + m * WIDTH + j] += TO_POWERS[first + m * count + k] * c[at + POWERS + k * WIDTH + j]


@register_jitable(forceinline=True)
def bound(c, way, t, samples, fresh):
    """The least and the largest input."""
    for j in range(WIDTH):
        ahead = t[j] if fresh else c[way + LAST + j]
        c[way + LOW + j] = c[way + HIGH + j] = ahead
        c[way + LAST + j] = t[(samples - 1) * WIDTH + j]
    for i in range(samples):
        for j in range(WIDTH):
            c[way + LOW + j] = min(c[way + LOW + j], t[i * WIDTH + j])
            c[way + HIGH + j] = max(c[way + HIGH + j], t[i * WIDTH + j])


@register_jitable(forceinline=True)
def farther(c, way, j, u):
    """What is farther on the way, an input or the farthest so far."""
    reached = c[way + REACHED + j]
    return max(u, reached) if c[way + FAR + j] >= c[way + FIRST + j] else min(u, reached)


@register_jitable(forceinline=True)
def follow(c, way, t, samples):
    """The way of an input through a tile, from the first one to the one farthest from it."""
    for j in range(WIDTH):
        u, least, most = t[j], c[way + LOW + j], c[way + HIGH + j]
        c[way + FIRST + j] = c[way + REACHED + j] = u
        c[way + FAR + j] = most if most - u >= u - least else least
        c[way + BACK + j] = 0.0
    for i in range(samples):
        for j in range(WIDTH):
            u = t[i * WIDTH + j]
            reached = farther(c, way, j, u)
            c[way + REACHED + j] = reached
            c[way + BACK + j] = max(c[way + BACK + j], abs(reached - u))
