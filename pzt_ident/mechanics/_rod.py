"""A rod along its axis: its parameters, and the matrices of its finite elements."""

import numpy as np

from pzt_ident.mechanics._linear import Linear, sections
from pzt_ident.mechanics._solid import Solid, modes_resolved
from pzt_ident.model.parameter import Parameter, Setting


class RodData(Solid):
    """Parameters of a rod that is fixed at x = 0, with a mass, a damper and a spring at its end.

    rho A u_tt = N_x, N = Y A u_x + C A u_xt - A a1 (P - P_R), N(l) = -k u - c u_t - m u_tt. The polarization is
    uniform over the length, so it acts as a force at the end. Smith, Hatch, De, Salapaka, del Rosario & Raye, Model
    Development for Atomic Force Microscope Stage Mechanisms, eq. 17 to 20; the area, missing
    in their N and eq. 42, is included here.
    """

    area = Parameter("m^2", (1e-8, 1e-2), "Area of the cross section.", scale="log")
    end_damping = Parameter("N*s/m", (0, 1e6), "Damper at the end.", value=0)
    end_stiffness = Parameter("N/m", (0, 1e9), "Spring at the end.", value=0)
    extra_damping = Parameter(
        "N*s/m",
        (0, 3e4),
        "Added to the damper at the end.",
        null=0,
        effect="viscous_damping",
        adds_to="end_damping",
    )


class RodElements(RodData, Linear):
    """Linear finite elements of the same length, eq. 40 to 41. f is the displacement of the end at rest."""

    elements = Setting(8, (1, 100), "Linear finite elements.")
    modes = Setting(
        0, (0, 100), "Number of slowest modes that are simulated, the faster ones follow the force at once; 0 for all."
    )

    def count(elements, modes):
        return modes_resolved(elements, modes, 3, "rod")

    def solve(rod):
        end = np.eye(rod.elements)[-1]
        return tuple(values[: rod.modes or rod.elements] for values in sections(*matrices(rod), end, end))


def matrices(rod):
    """M, Q and K of eq. 41 with mass, damper and spring at the end, (elements, elements) each."""
    mass, strain = hats(rod.elements, rod.length)
    mass, damping = rod.density * rod.area * mass, rod.viscosity * rod.area * strain
    stiffness = rod.modulus * rod.area * strain
    mass[-1, -1] += rod.end_mass + rod.load
    damping[-1, -1] += rod.end_damping + rod.extra_damping
    stiffness[-1, -1] += rod.end_stiffness
    return mass, damping, stiffness


def hats(elements, length):
    """int phi_i phi_j and int phi_i' phi_j' over the length, (elements, elements) each: linear hats, none at x = 0."""
    size = length / elements
    beside = np.eye(elements, k=1) + np.eye(elements, k=-1)
    mass, stiffness = 4 * np.eye(elements) + beside, 2 * np.eye(elements) - beside
    mass[-1, -1], stiffness[-1, -1] = 2, 1
    return mass * size / 6, stiffness / size
