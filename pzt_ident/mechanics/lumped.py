"""One mass, damper and spring."""

from pzt_ident.mechanics._oscillator import Oscillator, mode
from pzt_ident.parameter import Parameter
from pzt_ident.registry import blocks


@blocks.register
class Lumped(Oscillator):
    """m x'' + b x' + k x = k f, solved exactly for f linear on each step (first-order hold), at rest at the start.

    Lin & Lin (2012), Mechatronics 22, 614, eq. 2.
    """

    mass = Parameter("kg", (0.01, 10), "Moving mass.", scale="log")
    damping = Parameter("N*s/m", (0, 1e4), "Viscous damping.")
    stiffness = Parameter("N/m", (1e5, 1e9), "Stiffness of flexure and actuator together.", scale="log")
    load = Parameter("kg", (0, 1), "Mass of a payload, added to the moving mass.", null=0, effect="load_mass")
    extra_damping = Parameter("N*s/m", (0, 1e3), "Added to the damping.", null=0, effect="viscous_damping")
    cubic = Parameter(
        "1/response^2", (-0.1, 0.5), "Cubic over linear stiffness, k3 / k.", null=0, effect="cubic_stiffness"
    )

    def prepare(mass, damping, stiffness, load, extra_damping, dt):
        return mode(mass + load, damping + extra_damping, stiffness, dt)
