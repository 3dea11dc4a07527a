"""Case III of Lin & Lin (2012), Mechatronics 22, 614: a triangle of 10 um on both axes of their Table 7."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from experiments.rigs.table_7 import AXES, COUPLING, table_7
from pzt_ident.control.inverse import Inverse
from pzt_ident.control.loop import PI, Tracking, closed_loop

Array = NDArray[np.float64]

DT, STEPS = 1e-3, 20  # s; steps of the stage in a sample
COUNT = 0.1e-6  # m, of the encoder
OFF = PI(np.zeros(2), np.zeros(2))
PUBLISHED = PI(np.full(2, 0.8e6), np.full(2, 480e6))  # V/m, V/(m s)
PAPER = {  # x - x_d of X and Y, um
    "open loop": ((-1.2, 0.7), (-0.9, 0.8)),
    "feedforward, eq. 23": ((-0.3, 0.2), (-0.2, 0.2)),
    "feedforward and PI": ((-0.1, 0.1), (-0.1, 0.1)),
}


def reference() -> Array:
    """Eq. 33: up to 10 um in a second, down again in another, and half a second of rest."""
    time = np.arange(2501) * DT
    return np.tile(1e-5 * np.interp(time, [0, 1, 2], [0, 1, 0]), (2, 1))


def feedforward(decoupled: bool) -> Array:
    """Eq. 23 of each axis by itself, or of both with the coupling in it."""
    return Inverse(table_7(DT), 130.0, decoupled=decoupled)(reference()).drive


def tracked(drive: Array, gains: PI = OFF) -> Tracking:
    """Under a drive that is held over each sample, and gains that answer the encoder a sample later."""
    return closed_loop(table_7(DT / STEPS), reference(), gains, drive, substeps=STEPS, delay=1, quantum=COUNT)


def runs() -> dict[str, Tracking]:
    alone, together = feedforward(False), feedforward(True)
    slope = np.array([[axis.gain] for axis in AXES.values()])
    return {
        "open loop": tracked(reference() / slope),
        "feedforward, eq. 23": tracked(alone),
        "feedforward with decoupling": tracked(together),
        "feedforward and PI": tracked(alone, PUBLISHED),
        "feedforward with decoupling and PI": tracked(together, PUBLISHED),
    }


def uncompensated() -> Array:
    """What the coupling adds where each axis is inverted by itself: k12 / k11 y_d and k21 / k22 x_d."""
    x, y = reference()
    return np.array([COUPLING[0][1] * y, COUPLING[1][0] * x])


def band(signal: Array) -> Array:
    """Lowest and highest of each axis, um: (axes, 2)."""
    return 1e6 * np.stack([signal.min(axis=1), signal.max(axis=1)], axis=1)
