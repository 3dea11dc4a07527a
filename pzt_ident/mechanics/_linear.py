"""Linear mechanics of many degrees of freedom as sections of second order in parallel."""

from typing import NamedTuple

import numpy as np

from pzt_ident.model.block import Bank, Place
from pzt_ident.model.first_order_hold import oscillate, oscillator


class Linear(Bank):
    """y = f + sum_i (share_i w_i + speed_i v_i), (w, v) of each section as in first_order_hold.oscillator: solved
    exactly for f linear on each step, at rest at the start. The rest of the static response, one minus the sum of the
    shares, follows f at once.

    solve(values) -> (omega, zeta, share, speed), an array (branches,) each.
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

    These are the modes if the damping does not couple them, otherwise pairs of poles, accurate to about 1e-8 where two
    coincide.
    """
    omega, shapes = modes(mass, stiffness)
    enters, leaves, modal_damping = shapes.T @ load, output @ shapes, shapes.T @ damping @ shapes
    static = leaves @ (enters / omega**2)
    uncoupled = np.diag(modal_damping)
    if np.abs(modal_damping - np.diag(uncoupled)).max() <= 1e-12 * uncoupled.max():
        return omega, uncoupled / (2 * omega), leaves * enters / (static * omega**2), np.zeros(omega.size)
    frequencies, zeros = np.diag(omega), np.zeros_like(modal_damping)
    poles, vectors = np.linalg.eig(np.block([[zeros, frequencies], [-frequencies, -modal_damping]]))
    pushed = np.linalg.solve(vectors, np.concatenate([np.zeros(omega.size), enters / static]))
    return paired(poles, np.concatenate([leaves / omega, np.zeros(omega.size)]) @ vectors * pushed)


def paired(poles, residues):
    """omega, zeta, share and speed, slowest first, of sum r / (s - p). Pairs are complex conjugates, and the fastest
    real pole with the slowest; the last of an odd number of real poles is paired with one of residue zero."""
    if np.sum(poles.imag == 0) % 2:
        poles, residues = np.append(poles, 10 * poles.real.min()), np.append(residues, 0)
    upper, real = poles.imag > 0, np.flatnonzero(poles.imag == 0)
    real = real[np.argsort(poles[real].real)]
    fast, slow = real[: real.size // 2], real[::-1][: real.size // 2]
    p, q = (np.concatenate([part, poles[i]]) for part, i in ((poles[upper], fast), (poles[upper].conj(), slow)))
    r, s = (
        np.concatenate([part, residues[i]]) for part, i in ((residues[upper], fast), (residues[upper].conj(), slow))
    )
    square = (p * q).real
    omega = np.sqrt(square)
    order = np.argsort(omega)
    sections = omega, -(p + q).real / (2 * omega), -(r * q + s * p).real / square, (r + s).real / omega
    return tuple(values[order] for values in sections)


class Forms(NamedTuple):
    """Constants of the bilinear forms of M x'' + Q x' + K x = load F on V, the conditions of well-posedness.

    Smith et al., H1 to H5: sigma1 is bounded by c1, elliptic with c2 and symmetric up to `skew`; sigma2 is bounded by
    c3 and elliptic with c4. c2 and c4 must be positive.
    """

    c1: float
    c2: float
    skew: float
    c3: float
    c4: float


def forms(damping, stiffness, inner):
    """The constants of the discretised forms: sigma1 is K, sigma2 is Q. inner: Gram matrix of V."""
    root = np.linalg.inv(np.linalg.cholesky(inner))
    first, second = (root @ form @ root.T for form in (stiffness, damping))
    bounds = [np.linalg.norm(form, 2) for form in (first, second)]
    floors = [np.linalg.eigvalsh((form + form.T) / 2)[0] for form in (first, second)]
    return Forms(bounds[0], floors[0], np.abs(first - first.T).max(), bounds[1], floors[1])
