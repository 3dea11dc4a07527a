"""Force of one axis that moves another one through the stiffness of the guide."""

from pzt_ident.model.block import Coupling, Place
from pzt_ident.model.parameter import Form, Parameter
from pzt_ident.model.registry import blocks


@blocks.register
class CrossCoupling(Coupling):
    """The guide transmits force from axis to axis: f1 <- f1 + (k12 / k11) f2, ahead of the mechanics of axis 1.

    Lin & Lin (2012), Mechatronics 22, 614, eq. 6 and 20; only the ratios k12 / k11 and k21 / k22 can be
    identified.
    """

    place = Place.COUPLING
    form = Form("force", ("force", "voltage"), "What of the other axis acts.")
    ratio = Parameter("1", (-5, 5), "Stiffness coupling k12 / k11 from the other axis.", null=0)
    look_alikes = ("kinematic_coupling",)
    separate_by = (
        "Chirp the other axis beyond the resonances of both with this one at rest: stiffness coupling rings at this "
        "axis' own resonance, a kinematic one at the other's."
    )
    remedy = "Feed the identified share of the other axis' drive forward, or decouple the axes in the controller."

    def prepare(ratio):
        return (ratio,)

    def step(y, other, ratio):
        return y + ratio * other


class OfVoltage(CrossCoupling):
    """The other axis' voltage acts, without its hysteresis: f1 <- f1 + d1 ratio u2.

    Stray field, leakage between the amplifiers' channels, or a transverse piezo coefficient: Yong, Moheimani, Kenton &
    Leang (2012), Rev. Sci. Instrum. 83, 121101.
    """

    place = Place.READOUT
    ratio = Parameter("1", (-5, 5), "Share of the other axis' voltage that acts on this axis.", null=0)


CrossCoupling.forms = {"voltage": OfVoltage}
