"""Balanced truncation of linear mechanics."""

import warnings

import numpy as np

from pzt_ident.errors import InputError
from pzt_ident.mechanics._linear import Linear, modes, paired
from pzt_ident.model.parameter import Setting

ROUNDING = 1e-9
"""Share of the first Hankel singular value below which a state is rounding, a root of a gramian's own."""


class Balanced(Linear):
    """The few sections of second order that come near all of a body, exactly at rest; see `balanced`."""

    order = Setting(2, (1, 20), "Sections of second order that are kept.")

    def count(elements, order):
        if order > elements:
            message = f"{elements} elements have no {order} sections"
            raise InputError(message, remedy=f"give `elements: {2 * order}` or more, or a lower order")
        return order


def balanced(order, *system):
    """The sections (order,) that come near a system, at rest exactly the same, and all its Hankel singular values.

    system: M, Q, K, load and output as in _linear.sections. The transfer functions differ by at most twice the sum of
    the values left out, sigma_i with i > 2 order, at any frequency. Singular perturbation of the balanced system (Liu &
    Anderson 1989, Int. J. Control 50, 1379), as truncation of G(1 / s); gramians by Lyapunov's equation.
    """
    inverse, enters, leaves = reciprocal(*system)
    left, values, right = projections(inverse, enters, leaves)
    kept = min(2 * order, int(np.sum(values > ROUNDING * values[0])))
    scale = 1 / np.sqrt(values[:kept])
    first, last = scale[:, None] * left[:, :kept].T, right[:, :kept] * scale
    times, vectors = np.linalg.eig(first @ inverse @ last)
    residues = (leaves @ last @ vectors) * np.linalg.solve(vectors, first @ enters)
    found = paired(1 / times, -residues / times**2)
    blank = np.ones(order - len(found[0]))
    padded = [np.concatenate([each, empty * blank]) for each, empty in zip(found, (found[0][-1], 1, 0, 0), strict=True)]
    return tuple(padded), values


def reciprocal(mass, damping, stiffness, load, output):
    """A^-1, A^-1 B and -C A^-1 of z' = A z + B f, y = C z, with z = (omega q, q') over modes q and static gain one."""
    omega, shapes = modes(mass, stiffness)
    enters, leaves, rubs = shapes.T @ load, output @ shapes, shapes.T @ damping @ shapes
    static = leaves @ (enters / omega**2)
    turn, still = np.diag(1 / omega), np.zeros_like(rubs)
    inverse = np.block([[-rubs / np.outer(omega, omega), -turn], [turn, still]])
    none = np.zeros(omega.size)
    pushed = inverse @ np.concatenate([none, enters / static])
    return inverse, pushed, -np.concatenate([leaves / omega, none]) @ inverse


def projections(inverse, enters, leaves):
    """Left and right directions, not scaled yet, and the Hankel singular values, which G(1 / s) shares with G(s)."""
    from scipy.linalg import solve_continuous_lyapunov

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # a mode that is hardly damped, against the rate of the fastest
        reached = root(solve_continuous_lyapunov(inverse, -np.outer(enters, enters)))
        seen = root(solve_continuous_lyapunov(inverse.T, -np.outer(leaves, leaves)))
    turned, values, other = np.linalg.svd(seen.T @ reached)
    return seen @ turned, values, reached @ other.T


def root(gramian):
    """R with R R^T the gramian."""
    squares, vectors = np.linalg.eigh((gramian + gramian.T) / 2)
    return vectors * np.sqrt(np.maximum(squares, 0))
