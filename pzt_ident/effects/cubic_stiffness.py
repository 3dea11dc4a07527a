"""Flexure that stiffens or softens as it bends."""

from pzt_ident.model.block import Term
from pzt_ident.model.registry import blocks


@blocks.register
class CubicStiffness(Term):
    """Flexure leaves also stretch as they bend: k x <- k (x + c x^3), c = k3 / k, in the equation of the mechanics.

    Awtar & Slocum (2007), J. Mech. Des. 129, 625. The resonance goes up with the bias: df / f = (3/2) c x0^2.
    """

    sizes = tuple(0.005 * 1.5**k for k in range(12))
    look_alikes = ("quadratic_gain", "saturation", "encoder_cyclic_error")
    separate_by = "Load the stage with a known force or change its preload, or measure the resonance at several biases."
    remedy = "Work on a smaller part of the range, or put the identified curve into the calibration or feedforward."
