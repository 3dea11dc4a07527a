"""A distributed rod, stepped as in the paper."""

from pzt_ident.mechanics._rod import RodElements
from pzt_ident.model.first_order_hold import trapezoid
from pzt_ident.model.registry import blocks


@blocks.register
class RodTrapezoid(RodElements):
    """z1 = W z0 + (F0 + F1) / 2 V B, the modified trapezoid rule on the finite elements of a rod.

    Smith, Hatch, De, Salapaka, del Rosario & Raye, Model Development for Atomic Force Microscope Stage Mechanisms, eq.
    42, applied to each section, which is equivalent. Second order in the step; `rod` is exact.
    """

    def prepare(omega, zeta, share, speed, dt):
        return *trapezoid(omega, zeta, dt), share, speed
