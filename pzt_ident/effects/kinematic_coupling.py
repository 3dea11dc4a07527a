"""Displacement of another axis that the sensor of one axis sees."""

from pzt_ident.model.block import Coupling, Place
from pzt_ident.model.parameter import Form, Parameter
from pzt_ident.model.registry import blocks


@blocks.register
class KinematicCoupling(Coupling):
    """The sensor of axis 1 is misaligned or has an Abbe offset: y1 <- x1 + ratio x2, behind the mechanics.

    Yong, Moheimani, Kenton & Leang (2012), Rev. Sci. Instrum. 83, 121101.
    """

    place = Place.OUTPUT
    form = Form("displacement", ("displacement", "voltage"), "What moves the other axis as the sensor sees it.")
    ratio = Parameter("1", (-5, 5), "Share of the other axis' displacement in this axis' reading.", null=0)
    look_alikes = ("cross_coupling",)
    separate_by = (
        "Chirp the other axis beyond the resonances of both with this one at rest: this coupling rings at the other "
        "axis' resonance, stiffness coupling at this axis' own."
    )
    remedy = "Align the sensors with the axes, or take the identified share of the other axis out of the readings."

    def prepare(ratio):
        return (ratio,)

    def start(y, other, ratio):
        return ()

    def step(y, other, ratio):
        return y + ratio * other


class OfVoltage(KinematicCoupling):
    """The other axis follows its voltage without hysteresis, as under charge control or in closed loop, and is as fast
    as this one: y1 <- M1 (f1 + d1 ratio u2) with the mechanics M1 of axis 1.

    Yong, Moheimani, Kenton & Leang (2012), Rev. Sci. Instrum. 83, 121101.
    """

    place = Place.READOUT
    equation_of = "cross_coupling.voltage"
    ratio = Parameter("1", (-5, 5), "Share of the other axis, moving by its voltage, in this axis' reading.", null=0)


KinematicCoupling.forms = {"voltage": OfVoltage}
