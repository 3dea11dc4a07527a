"""Flexure that stiffens or softens as it bends."""

from pzt_ident.model.block import Block, Place, Term
from pzt_ident.model.cubic_spring import cubic_root
from pzt_ident.model.parameter import Form, Parameter
from pzt_ident.model.registry import blocks


class Bending:
    """What both forms declare."""

    about_rest = True
    form = Form("motion", ("motion", "rest"), "Whether the spring is bent in the equation of motion, or at rest.")
    look_alikes = ("quadratic_gain", "saturation", "encoder_cyclic_error")
    leaves = ("saturation",)
    separate_by = "Load the stage with a known force or change its preload, or measure the resonance at several biases."
    remedy = "Work on a smaller part of the range, or put the identified curve into the calibration or feedforward."


@blocks.register
class CubicStiffness(Bending, Term):
    """Flexure leaves also stretch as they bend: k x <- k (x + c x^3), c = k3 / k, in the equation of the mechanics.

    Awtar & Slocum (2007), J. Mech. Des. 129, 625. The resonance goes up with the bias: df / f = (3/2) c x0^2.
    """

    sizes = tuple(0.00125 * 1.5**k for k in range(15))


class AtRest(Bending, Block):
    """The equilibrium of the flexure, below all resonances: x + c x^3 = f, f = d u - h, for a model without mechanics.

    Awtar & Slocum (2007), J. Mech. Des. 129, 625. A softening spring is linear beyond c x^2 = -0.19.
    """

    place = Place.STATIC
    sizes = (0.005, 0.025, 0.1, 0.4)
    cubic = Parameter("1/response^2", (-0.4, 2), "Cubic over linear stiffness, k3 / k.", null=0)

    def prepare(cubic):
        return (cubic,)

    def start(u, cubic):
        return ()

    def step(u, cubic):
        return cubic_root(u, cubic, 1.0)


CubicStiffness.forms = {"rest": AtRest}
