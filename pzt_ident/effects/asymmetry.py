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

    form = Form("voltage", ("voltage", "constant", "polynomial", "branches"), "What is easier in one direction.")
    look_alikes = ("quadratic_gain", "creep")
    separate_by = "Cycle one loop until it has settled and compare one branch with the other rotated by 180 degrees."
    remedy = "Invert the asymmetric operator in the feedforward, or work on one branch only."


class Constant(Asymmetry):
    """One direction is easier at every voltage: dh/dt <- dh/dt + delta |du/dt|.

    Zhu & Wang (2012), Sens. Actuators A 181, 51, with a constant in the place of u; delta is `lean` times alpha d.
    """


class Polynomial(Asymmetry):
    """It changes with the voltage along a curve: dh/dt <- dh/dt + alpha d (skew u + skew_2 u^2 + skew_3 u^3) |du/dt|.

    Zhu & Wang (2012), Sens. Actuators A 181, 51, with the next powers of u, as of an exponential or of what levels off.
    """


class Branches(Asymmetry):
    """Another forgetting on each branch: dh <- dh - |h| (beta_2 sgn(x v) + beta_3 sgn(x h) + beta_4 sgn(v) +
    beta_5 sgn(h) + beta_6 sgn(x)) du, v = du/dt, x = u - centre.

    Generalised Bouc-Wen operator of Song & Der Kiureghian (2006), J. Eng. Mech. 132, 610, whose beta_1 is beta.
    """

    sizes = (0.06,)
    trials = {"centre": 8}


Asymmetry.forms = {"constant": Constant, "polynomial": Polynomial, "branches": Branches}
