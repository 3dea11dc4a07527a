"""The loop of Lin & Lin (2012) in continuous time: a lumped stage under PI control, eq. 25 to 32, signs corrected."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def routh_damping(mass: float, gain: float, kp: float, ki: float) -> float:
    """The damping, N s/m, above which the error dies out: b > m d Ki / (1 + d Kp) (Routh); d: gain, m/V."""
    return mass * gain * ki / (1 + gain * kp)


def error_dynamics(mass: float, damping: float, stiffness: float, gain: float, kp: float, ki: float) -> Array:
    """A of z' = A z + (0, 0, 1) xi for z = (integral of e, e, e'); xi = x_d'' + b/m x_d' + k/m (h - h_ff)."""
    last = [-stiffness * gain * ki, -stiffness * (1 + gain * kp), -damping]
    return np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], np.divide(last, mass)])


def lyapunov_rate(a: Array) -> float:
    """mu = least eigenvalue of Q / largest of P, 1/s, where A'P + PA = -Q = -1 (the paper's eq. 30, its minus lost).

    V = z'Pz then falls while |z| > 2 |xi| / mu, so the error stays within that bound. It says little: P is as badly
    conditioned as the time constants are apart, so that mu is some 1e-9 /s where the loop settles in 27 ms, and the
    bound for 0.01 um of hysteresis that the feedforward misses is 8e9 m. Where A is not Hurwitz, as with the identified
    damping of zero, there is no such P, and mu is NaN.
    """
    from scipy.linalg import solve_continuous_lyapunov

    if not np.linalg.eigvals(a).real.max() < 0:
        return float("nan")
    scale = np.array([1.0, (-a[2, 1]) ** 0.5, -a[2, 1]])  # of z, for the sake of rounding
    p = solve_continuous_lyapunov((a / scale[:, None] * scale).T, -np.diag(scale**2)) / np.outer(scale, scale)
    return float(1 / np.linalg.eigvalsh(p).max())
