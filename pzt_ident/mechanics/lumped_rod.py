"""One mass, damper and spring from the data of a rod."""

from pzt_ident.mechanics._oscillator import Oscillator
from pzt_ident.mechanics._rod import RodData
from pzt_ident.model.first_order_hold import mode
from pzt_ident.model.registry import blocks


@blocks.register
class LumpedRod(RodData, Oscillator):
    """m x'' + b x' + k x = k f, m = rho A l + m_l, b = C A / l + c_l, k = Y A / l + k_l, solved as `lumped`.

    Smith, Hatch, De, Salapaka, del Rosario & Raye, Model Development for Atomic Force Microscope Stage Mechanisms, eq.
    21 and 22. The whole mass of the rod moves with its end; a third of it would be consistent with a uniform strain.
    `rod` is distributed.
    """

    def prepare(
        density,
        area,
        length,
        modulus,
        viscosity,
        end_mass,
        end_damping,
        end_stiffness,
        load,
        extra_damping,
        dt,
    ):
        mass = density * area * length + end_mass + load
        damping = viscosity * area / length + end_damping + extra_damping
        stiffness = modulus * area / length + end_stiffness
        return mode(mass, damping, stiffness, dt)
