"""Slow twin of the rod: its elements assembled one by one, the whole state stepped by dense matrices."""

from itertools import pairwise

import numpy as np
from scipy.linalg import expm


def matrices(elements, rod):
    """M, Q, K of linear hats on a rod fixed at x = 0 (Smith et al., eq. 41), with what is at its end."""
    size = rod["length"] / elements
    mass, stiffness = np.zeros((2, elements + 1, elements + 1))
    for i in range(elements):
        pair = np.ix_([i, i + 1], [i, i + 1])
        mass[pair] += rod["density"] * rod["area"] * size / 6 * np.array([[2, 1], [1, 2]])
        stiffness[pair] += rod["area"] / size * np.array([[1, -1], [-1, 1]])
    mass, strain = mass[1:, 1:], stiffness[1:, 1:]
    damping, stiffness = rod["viscosity"] * strain, rod["modulus"] * strain
    for matrix, word in ((mass, "end_mass"), (damping, "end_damping"), (stiffness, "end_stiffness")):
        matrix[-1, -1] += rod[word]
    return mass, damping, stiffness


def system(elements, rod):
    """z' = A z + B F, z = (displacements, velocities), F the force at the end."""
    mass, damping, stiffness = matrices(elements, rod)
    inverse, still = np.linalg.inv(mass), np.zeros((elements, elements))
    a = np.block([[still, np.eye(elements)], [-inverse @ stiffness, -inverse @ damping]])
    return a, np.concatenate([np.zeros(elements), inverse[:, -1]])


def rest(elements, rod, force):
    """The state at rest under the first force."""
    return np.concatenate(
        [np.linalg.solve(matrices(elements, rod)[2], np.eye(elements)[-1] * force), np.zeros(elements)]
    )


def exact(elements, rod, force, dt):
    """Displacement of the end for a force that is linear between samples: the exponential of system and input."""
    a, b = system(elements, rod)
    n = 2 * elements
    whole = np.zeros((n + 2, n + 2))
    whole[:n, :n], whole[:n, n], whole[n, n + 1] = a * dt, b * dt, 1
    step = expm(whole)
    state, found = rest(elements, rod, force[0]), []
    for now, after in pairwise([*force, force[-1]]):
        found.append(state[elements - 1])
        state = (step @ np.concatenate([state, [now, after - now]]))[:n]
    return np.array(found)


def trapezoid(elements, rod, force, dt):
    """Eq. 42: z1 = W z0 + (F0 + F1) / 2 V B."""
    a, b = system(elements, rod)
    inverse = np.linalg.inv(np.eye(2 * elements) - dt / 2 * a)
    w, v = inverse @ (np.eye(2 * elements) + dt / 2 * a), dt * inverse
    state, found = rest(elements, rod, force[0]), []
    for now, after in pairwise([*force, force[-1]]):
        found.append(state[elements - 1])
        state = w @ state + (now + after) / 2 * (v @ b)
    return np.array(found)
