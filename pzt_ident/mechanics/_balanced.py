"""Balanced truncation of linear mechanics."""

import warnings

import numpy as np

from pzt_ident.errors import InputError
from pzt_ident.mechanics._linear import Linear, modes, paired
from pzt_ident.model.parameter import Setting

ROUNDING = 1e-9
"""Share of the first Hankel singular value below which a state is rounding (the root of that of a gramian)."""


class Balanced(Linear):
    """A few sections of second order that approximate a body, exact at rest; see `balanced`."""

    order = Setting(2, (1, 20), "Sections of second order that are kept.")

    def count(elements, order):
        if order > elements:
            message = f"{elements} elements do not have {order} sections"
            raise InputError(message, remedy=f"give `elements: {2 * order}` or more, or a lower order")
        return order


def balanced(order, *system):
    """The sections (order,) that approximate a system, exactly at rest, and all its Hankel singular values.

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
    reduced = paired(1 / times, -residues / times**2)
    blank = np.ones(order - len(reduced[0]))
    fillers = (reduced[0][-1], 1, 0, 0)
    padded = [np.concatenate([values, filler * blank]) for values, filler in zip(reduced, fillers, strict=True)]
    return tuple(padded), values


def reciprocal(mass, damping, stiffness, load, output):
    """A^-1, A^-1 B and -C A^-1 of z' = A z + B f, y = C z, with z = (omega q, q') over modes q and static gain one."""
    omega, shapes = modes(mass, stiffness)
    enters, leaves, modal_damping = shapes.T @ load, output @ shapes, shapes.T @ damping @ shapes
    static = leaves @ (enters / omega**2)
    periods, zeros = np.diag(1 / omega), np.zeros_like(modal_damping)
    inverse = np.block([[-modal_damping / np.outer(omega, omega), -periods], [periods, zeros]])
    no_force = np.zeros(omega.size)
    pushed = inverse @ np.concatenate([no_force, enters / static])
    return inverse, pushed, -np.concatenate([leaves / omega, no_force]) @ inverse


def projections(inverse, enters, leaves):
    """Left and right projections, not yet scaled, and the Hankel singular values, the same for G(1 / s) as for G(s)."""
    from scipy.linalg import solve_continuous_lyapunov

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # a mode with little damping beside the rate of the fastest
        controllability = root(solve_continuous_lyapunov(inverse, -np.outer(enters, enters)))
        observability = root(solve_continuous_lyapunov(inverse.T, -np.outer(leaves, leaves)))
    left, values, right = np.linalg.svd(observability.T @ controllability)
    return observability @ left, values, controllability @ right.T


def root(gramian):
    """A matrix R with R R^T = gramian."""
    squares, vectors = np.linalg.eigh((gramian + gramian.T) / 2)
    return vectors * np.sqrt(np.maximum(squares, 0))
