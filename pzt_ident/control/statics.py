"""The force that holds the stage at a displacement, where its mechanics are not linear."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pzt_ident.control.stage import MECHANICS, Stage

Array = NDArray[np.float64]

LEVELS = 801
FURTHEST = 2.0**10  # over the displacement, the largest force that is tried


def bending(stage: Stage, displacement: Array) -> Array:
    """The force (axes, samples) that holds a displacement at rest, beyond that of the linear mechanics about zero."""
    from scipy.interpolate import CubicSpline

    extra = np.zeros(displacement.shape)
    for axis in stage.model.measured:
        reach = float(np.abs(displacement[axis]).max())
        if is_linear(stage, axis, reach):
            continue
        force = reach * np.linspace(-1, 1, LEVELS)
        while np.abs(statics(stage, axis, force[[0, -1]])).min() < reach and force[-1] < FURTHEST * reach:
            force *= 2
        held = statics(stage, axis, force)
        if (np.diff(held) > 0).all():
            curve = CubicSpline(held, force)
            extra[axis] = curve(displacement[axis]) - curve(0.0, 1) * displacement[axis]
    return extra


def is_linear(stage: Stage, axis: int, reach: float) -> bool:
    force = reach * np.array([1e-3, 0.5, 1.0, -1.0])
    held = statics(stage, axis, force) / np.where(force != 0, force, 1.0)
    return bool(np.allclose(held, held[0], rtol=1e-9))


def statics(stage: Stage, axis: int, force: Array) -> Array:
    """Displacements of an axis at rest under row force, the others being free of force."""
    forces = np.zeros((force.size, len(stage.model.axes), 1))
    forces[:, axis, 0] = force
    mechanics = stage.part(MECHANICS)
    return np.array([mechanics.respond_from_rest(row)[axis, 0] for row in forces])
