"""Slow twin of the modal mechanics: all modes as one system of the first order, stepped by its exponential."""

from itertools import pairwise

import numpy as np
from scipy.linalg import expm


def modal(forces, dt, frequency, damping, push, shape):
    """Displacements (axes, samples) for forces (axes, samples) linear between samples, at rest under the first.

    frequency in Hz and damping, (modes,); push and shape, (axes, modes).
    """
    omega = 2 * np.pi * np.asarray(frequency, float)
    modes, axes = omega.size, len(forces)
    still = np.zeros((modes, modes))
    own = np.block([[still, np.diag(omega)], [-np.diag(omega), -2 * np.diag(damping * omega)]])
    enters = np.vstack([np.zeros((modes, axes)), omega[:, None] * np.transpose(push)])
    whole = np.zeros((2 * modes + 2 * axes, 2 * modes + 2 * axes))
    whole[: 2 * modes, : 2 * modes], whole[: 2 * modes, 2 * modes : -axes] = own * dt, enters * dt
    whole[2 * modes : -axes, -axes:] = np.eye(axes)
    step = expm(whole)[: 2 * modes]
    forces = np.transpose(forces)
    state, found = np.concatenate([forces[0] @ push, np.zeros(modes)]), []
    for now, after in pairwise([*forces, forces[-1]]):
        found.append(shape @ state[:modes])
        state = step @ np.concatenate([state, now, after - now])
    return np.transpose(found)
