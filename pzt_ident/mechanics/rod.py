"""A distributed rod, stepped exactly."""

from pzt_ident.mechanics._rod import RodElements
from pzt_ident.model.registry import blocks


@blocks.register
class Rod(RodElements):
    """rho A u_tt = (Y A u_x + C A u_xt)_x + F delta(x - l), u(0) = 0, with mass, damper and spring at the end.

    Smith, Hatch, De, Salapaka, del Rosario & Raye, Model Development for Atomic Force Microscope Stage Mechanisms, eq.
    17 to 20 and 40 to 41: linear finite elements, whose modes are solved exactly for a force that is linear on each
    step. The input f is the static displacement of the end under the force.
    """
