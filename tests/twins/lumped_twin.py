"""Slow twin of the lumped mechanics: the matrix exponential of the system with its input."""

from itertools import pairwise

import numpy as np
from scipy.linalg import expm


def lumped(force, dt, mass, damping, stiffness):
    """m x'' + b x' + k x = k f for f linear between samples (first-order hold), at rest on x(0) = f(0).

    Lin & Lin (2012), Mechatronics 22, 614, eq. 2. The input is taken into the state: (x, x' / omega, f, change of f in
    the sample), with time counted in samples, so that one exponential of a 4 x 4 matrix steps it exactly.
    """
    force = np.asarray(force, float)
    omega = np.sqrt(stiffness / mass)
    zeta = damping / (2 * np.sqrt(stiffness * mass))
    system = np.zeros((4, 4))
    system[0, 1] = system[1, 2] = omega * dt
    system[1, 0] = -omega * dt
    system[1, 1] = -2 * zeta * omega * dt
    system[2, 3] = 1.0
    step = expm(system)
    state = np.array([force[0], 0.0, force[0], 0.0])
    displacement = [force[0]]
    for now, after in pairwise(force):
        state[2:] = now, after - now
        state = step @ state
        displacement.append(state[0])
    return np.array(displacement)
