"""A loop that is not point-symmetric about its centre."""

from pzt_ident.model.block import Term
from pzt_ident.model.parameter import Form
from pzt_ident.model.registry import blocks


@blocks.register
class Asymmetry(Term):
    """Domains switch more easily in one direction of the voltage: dh/dt <- dh/dt + delta u |du/dt|.

    Asymmetric Bouc-Wen operator of Zhu & Wang (2012), Sens. Actuators A 181, 51; delta is the parameter `asymmetry` of
    the operator times alpha d.
    """

    form = Form("voltage", ("voltage", "constant"), "How much more easily, by the voltage.")
    look_alikes = ("quadratic_gain", "creep")
    separate_by = "Cycle one loop until it has settled and compare one branch with the other rotated by 180 degrees."
    remedy = "Invert the asymmetric operator in the feedforward, or work on one branch only."


class Constant(Asymmetry):
    """One direction is easier at every voltage: dh/dt <- dh/dt + delta |du/dt|.

    Zhu & Wang (2012), Sens. Actuators A 181, 51, with a constant in the place of u; delta is `lean` times alpha d.
    """


Asymmetry.forms = {"constant": Constant}
