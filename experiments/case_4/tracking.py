"""Case IV of Lin & Lin (2012), Mechatronics 22, 614: a coarse stage steps after a sine of 1 mm, the fine one does the
rest, as soon as it is told."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from experiments.rigs.table_7 import table_7
from pzt_ident.control.inverse import Inverse
from pzt_ident.control.loop import PI, closed_loop

Array = NDArray[np.float64]

DT, STEPS = 1e-3, 20  # s; steps of the fine stage in a sample
COUNT = 0.1e-6  # m, of the encoder
AMPLITUDE, FREQUENCY = 1e-3, 0.02  # m, Hz: 126 um/s at most
LOW, HIGH = -1.76e-6, 3.76e-6  # m, residual at which the coarse stage starts a step
STEP, RISE = 5.5e-6, 0.03  # m, s: half a cosine
PUBLISHED = PI(np.array([0.8e6]), np.array([480e6]))  # V/m, V/(m s)
DELAYS = (0, 1, 2, 3, 5, 10)


class Followed(NamedTuple):
    """What is left of the sine once both stages have moved, (samples,), m."""

    delay: int
    error: Array


def sine(periods: float) -> Array:
    return AMPLITUDE * np.sin(2 * np.pi * FREQUENCY * DT * np.arange(round(periods / (FREQUENCY * DT))))


def coarse(target: Array) -> Array:
    """Steps of one size, each a smooth motion of its own, taken whenever the target is too far off."""
    rise = round(RISE / DT)
    shape = STEP * (1 - np.cos(np.pi * np.arange(1, rise + 1) / rise)) / 2
    place, at, moving = np.zeros(target.size), 0.0, 0
    for i, wanted in enumerate(target):
        if moving == 0 and not LOW < wanted - at < HIGH:
            moving, sign = rise, np.sign(wanted - at)
        if moving:
            moving -= 1
            place[i] = at + sign * shape[rise - 1 - moving]
            at = place[i] if moving == 0 else at
        else:
            place[i] = at
    return place


def followed(residual: Array, delay: int, gains: PI = PUBLISHED) -> Followed:
    """The fine stage, axis X of Table 7, follows a residual that it is told `delay` samples late: feedforward of
    eq. 23, which needs no preview, and PI on the encoder. Its bias is left out: only changes of the drive count."""
    told = np.concatenate([np.full(delay, residual[0]), residual[: residual.size - delay]])[None]
    drive = Inverse(table_7(DT, "bouc_wen", "x"), 130.0)(told).drive
    fine = table_7(DT / STEPS, "bouc_wen lumped", "x")
    found = closed_loop(fine, told, gains, drive, substeps=STEPS, delay=0, quantum=COUNT)
    return Followed(delay, found.displacement[0] - residual)


def expected(residual: Array, delay: int) -> float:
    """How far the residual moves until it is followed: its fastest rate times the delay and half a sample of hold."""
    return float(np.abs(np.diff(residual)).max() * (delay + 0.5))
