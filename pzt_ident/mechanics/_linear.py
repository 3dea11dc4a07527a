"""Linear mechanics of many degrees of freedom as sections of second order in parallel."""

import numpy as np

from pzt_ident.block import Bank, Place
from pzt_ident.hold import oscillate, oscillator


class Linear(Bank):
    """y = f + sum_i (share_i w_i + speed_i v_i), (w, v) of each section as in hold.oscillator: solved exactly for f
    linear on each step, at rest at the start. What the shares lack of one follows f at once.

    solve(*parameters) -> (omega, zeta, share, speed), an array (branches,) each.
    """

    place = Place.MECHANICS
    solved = ("omega", "zeta", "share", "speed")

    def prepare(omega, zeta, share, speed, dt):
        return *oscillator(omega, zeta, dt), share, speed

    def start(u, r11, r12, r21, r22, b1, b2, share, speed):
        return 0.0, 0.0, u

    def step(w, v, before, u, r11, r12, r21, r22, b1, b2, share, speed):
        w, v = oscillate(w, v, u - before, r11, r12, r21, r22, b1, b2)
        return w, v, u, share * w + speed * v

    def output(u, total, r11, r12, r21, r22, b1, b2, share, speed):
        return u + total


def modes(mass, stiffness):
    """Natural frequencies in rad/s, slowest first, and the shapes Phi with Phi^T M Phi = 1 as columns.

    mass, stiffness: (n, n), symmetric and positive definite. Raises LinAlgError where they are not.
    """
    lower = np.linalg.inv(np.linalg.cholesky(mass))
    squares, shapes = np.linalg.eigh(lower @ stiffness @ lower.T)
    if not squares[0] > 0:
        raise np.linalg.LinAlgError("the stiffness is not positive")
    return np.sqrt(squares), lower.T @ shapes


def sections(mass, damping, stiffness, load, output):
    """omega, zeta, share and speed, slowest first, of M x'' + Q x' + K x = F load, y = output x at F = f / (static y).

    Modes where they do not feel each other's damping, else pairs of poles, found to about 1e-8 where two coincide.
    """
    omega, shapes = modes(mass, stiffness)
    enters, leaves, rubs = shapes.T @ load, output @ shapes, shapes.T @ damping @ shapes
    static = leaves @ (enters / omega**2)
    own = np.diag(rubs)
    if np.abs(rubs - np.diag(own)).max() <= 1e-12 * own.max():
        return omega, own / (2 * omega), leaves * enters / (static * omega**2), np.zeros(omega.size)
    turn, still = np.diag(omega), np.zeros_like(rubs)
    poles, vectors = np.linalg.eig(np.block([[still, turn], [-turn, -rubs]]))
    pushed = np.linalg.solve(vectors, np.concatenate([np.zeros(omega.size), enters / static]))
    return paired(poles, np.concatenate([leaves / omega, np.zeros(omega.size)]) @ vectors * pushed)


def paired(poles, residues):
    """omega, zeta, share and speed, slowest first, of sum r / (s - p): conjugates, and the fastest real pole with the
    slowest."""
    upper, real = poles.imag > 0, np.flatnonzero(poles.imag == 0)
    real = real[np.argsort(poles[real].real)]
    fast, slow = real[: real.size // 2], real[::-1][: real.size // 2]
    p, q = (np.concatenate([one, poles[i]]) for one, i in ((poles[upper], fast), (poles[upper].conj(), slow)))
    r, s = (np.concatenate([one, residues[i]]) for one, i in ((residues[upper], fast), (residues[upper].conj(), slow)))
    square = (p * q).real
    omega = np.sqrt(square)
    order = np.argsort(omega)
    found = omega, -(p + q).real / (2 * omega), -(r * q + s * p).real / square, (r + s).real / omega
    return tuple(each[order] for each in found)
