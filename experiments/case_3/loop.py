"""What the gains that Lin & Lin print are worth: the loop of each axis by itself."""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq

from experiments.case_3.tracking import DT
from experiments.rigs.table_7 import AXES, damping_of, table_7
from pzt_ident.control.continuous import error_dynamics, lyapunov_rate, routh_damping
from pzt_ident.control.plant import Plant, plant_of
from pzt_ident.control.tuning import Loop, tune

FINE = 256  # steps of the stage in a sample
KP, KI = 0.8e6, 480e6
WORTH = 0.01e-6  # m, of hysteresis that the feedforward misses


def plant(name: str, ratio: float) -> Plant:
    return plant_of(table_7(DT / FINE, "bouc_wen lumped", name, ratio), 0, (0.0, 130.0), FINE)


def radius(ratio: float, name: str, delay: int) -> float:
    """Largest closed-loop pole."""
    return Loop(plant(name, ratio), delay, KP, KI).radius


def facts(name: str) -> list[str]:
    """Cells of the table, one axis."""
    axis = AXES[name]
    parameters = axis.mass, damping_of(axis, 0.01), axis.stiffness, axis.gain, KP, KI
    slowest = -1 / np.linalg.eigvals(error_dynamics(*parameters)).real.max()
    least = brentq(lambda ratio: radius(ratio, name, 0) - 1, 1e-4, 0.02, xtol=1e-7)
    mu = lyapunov_rate(error_dynamics(*parameters))
    bound = 2 * axis.stiffness / axis.mass * WORTH / mu
    return [
        f"{routh_damping(axis.mass, axis.gain, KP, KI):.2f}",
        f"{1e3 * slowest:.1f}",
        f"{damping_of(axis, least):.1f}",
        f"{radius(0.0, name, 1):.3f}",
        f"{mu:.1e}",
        f"{bound:.0e}",
    ]


def gains(name: str, delay: int, found: Loop | None = None) -> list[str]:
    """Cells of a row: the published gains, or those found for a stage with a damping ratio of 0.02."""
    loop = found or Loop(plant(name, 0.02), delay, KP, KI)
    margins = loop.margins
    return [
        f"{1e-6 * loop.kp:.2f}",
        f"{1e-6 * loop.ki:.0f}",
        f"{margins.gain:.2f}",
        f"{margins.phase:.0f}",
        f"{margins.sensitivity:.2f}",
        f"{loop.radius:.3f}",
        f"{loop.bandwidth:.0f}",
    ]


def best(name: str, delay: int) -> Loop:
    return tune(plant(name, 0.02), delay, 2.0, 60.0)
