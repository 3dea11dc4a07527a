"""A cylindrical shell: its parameters, and the matrices of cubic splines along it and one harmonic around it."""

from functools import cache

import numpy as np

from pzt_ident.mechanics._linear import Linear, sections
from pzt_ident.mechanics._solid import Solid, modes_resolved
from pzt_ident.model.parameter import Parameter, Setting

CLAMPED = ((1, 0), (1, 0), (2, 0))
"""Splines left out of u, v and w at x = 0 and at the free end: u = v = w = w_x = 0 at x = 0."""


class ShellData(Solid):
    """Donnell-Mushtari: N_x = h / (1 - nu^2) [Y (e_x + nu e_t) + C (.)'] - h / (1 - nu) a1 (P - P_R), likewise N_t, and
    moments without polarization. Smith et al., eq. 24 to 29, with the mass at the end in N_x = -m u_tt.
    """

    radius = Parameter("m", (1e-4, 1), "Radius of the middle surface.", scale="log")
    thickness = Parameter("m", (1e-5, 0.1), "Thickness of the wall.", scale="log")
    poisson = Parameter("1", (0, 0.49), "Poisson's ratio, nu.", value=0.3)


class ShellSplines(ShellData, Linear):
    """Cubic splines along the shell. f is the displacement of the end at rest: axial for harmonic 0, else radial."""

    elements = Setting(12, (4, 60), "Cubic spline elements along the shell.")
    harmonic = Setting(0, (0, 20), "Waves of the field around the shell: 0 lengthens it, 1 bends it.")
    modes = Setting(3, (1, 30), "Number of slowest modes that are simulated, the faster ones follow the force at once.")

    def count(elements, modes):
        return modes_resolved(elements, modes, 2, "shell")

    def solve(shell):
        return tuple(values[: shell.modes] for values in sections(*matrices(shell)))


@cache
def integrals(elements):
    """int B_i^(a) B_j^(b) over [0, 1], (a, b, elements + 3, elements + 3), a and b from 0 to 2: exact Gauss rules."""
    from scipy.interpolate import BSpline

    knots = np.concatenate([np.zeros(3), np.linspace(0, 1, elements + 1), np.ones(3)])
    points, weights = np.polynomial.legendre.leggauss(4)
    x = ((np.arange(elements)[:, None] + (points + 1) / 2) / elements).ravel()
    splines = BSpline(knots, np.eye(elements + 3), 3)
    values = np.array([splines(x, order) for order in range(3)])
    return np.einsum("aqi,bqj,q->abij", values, values, np.tile(weights / 2 / elements, elements))


def matrices(shell, clamped=CLAMPED):
    """M, Q, K, load and output of cos(m t) u, sin(m t) v (not for m = 0) and cos(m t) w, divided by R int cos^2."""
    m, r, nu = shell.harmonic, shell.radius, shell.poisson
    orders = np.add.outer(np.arange(3), np.arange(3))[:, :, None, None]
    products = integrals(shell.elements) * float(shell.length) ** (1 - orders)
    stretch = shell.modulus * shell.thickness / (1 - nu**2)
    bend, shear = stretch * shell.thickness**2 / 12, (1 - nu) / 2
    hoop = np.sum(products[0, 0], axis=1)
    uu = stretch * (products[1, 1] + shear * (m / r) ** 2 * products[0, 0])
    vv = stretch * ((m / r) ** 2 * products[0, 0] + shear * products[1, 1])
    ww = stretch / r**2 * products[0, 0] + bend * (products[2, 2] + (m / r) ** 4 * products[0, 0])
    ww += bend * (m / r) ** 2 * (4 * shear * products[1, 1] - nu * (products[2, 0] + products[0, 2]))
    uv, uw = stretch * m / r * (nu * products[1, 0] - shear * products[0, 1]), stretch * nu / r * products[1, 0]
    vw = stretch * m / r**2 * products[0, 0]
    stiffness = np.block([[uu, uv, uw], [uv.T, vv, vw], [uw.T, vw.T, ww]])
    mass = np.kron(np.eye(3), shell.density * shell.thickness * products[0, 0])
    size = len(hoop)
    mass[size - 1, size - 1] += (shell.end_mass + shell.load) / (2 * np.pi * r)
    load = np.concatenate([np.sum(products[1, 0], axis=1), m / r * hoop, hoop / r]) * shell.thickness / (1 - nu)
    output = np.eye(3 * size)[size - 1 if m == 0 else -1]
    degrees = [i * size + np.arange(first, size - last) for i, (first, last) in enumerate(clamped) if i != 1 or m > 0]
    free = np.concatenate(degrees)
    stiffness = stiffness[np.ix_(free, free)]
    damping = shell.viscosity / shell.modulus * stiffness
    return mass[np.ix_(free, free)], damping, stiffness, load[free], output[free]
