"""Linear mechanics of many degrees of freedom as sections of second order in parallel."""

from typing import NamedTuple

import numpy as np

from pzt_ident.model.block import Bank, Place
from pzt_ident.model.first_order_hold import oscillate, oscillator


class Linear(Bank):
    """y = f + sum_i (share_i w_i + speed_i v_i), (w, v) of each section as in hold.oscillator: solved exactly for f
    linear on each step, at rest at the start. What the shares lack of one follows f at once.

    solve(own) -> (omega, zeta, share, speed), an array (branches,) each.
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
    slowest; one that is left over with one that has no part in the response."""
    if np.sum(poles.imag == 0) % 2:
        poles, residues = np.append(poles, 10 * poles.real.min()), np.append(residues, 0)
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


class Forms(NamedTuple):
    """What the well-posedness of M x'' + Q x' + K x = load F asks of its forms over V, whose inner product is `inner`.

    Smith et al., H1 to H5: sigma1 is bounded by c1, elliptic by c2 and symmetric up to `skew`; sigma2 is bounded by c3
    and elliptic by c4, which must be positive.
    """

    c1: float
    c2: float
    skew: float
    c3: float
    c4: float


def forms(damping, stiffness, inner):
    """The constants of the discretised forms: sigma1 is K, sigma2 is Q."""
    root = np.linalg.inv(np.linalg.cholesky(inner))
    first, second = (root @ form @ root.T for form in (stiffness, damping))
    bounds = [np.linalg.norm(form, 2) for form in (first, second)]
    floors = [np.linalg.eigvalsh((form + form.T) / 2)[0] for form in (first, second)]
    return Forms(bounds[0], floors[0], np.abs(first - first.T).max(), bounds[1], floors[1])
