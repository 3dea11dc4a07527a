"""Flexure that stiffens or softens as it bends."""

from pzt_ident.block import Block, Place, expm1, log1p
from pzt_ident.parameter import Parameter
from pzt_ident.registry import blocks


@blocks.register
class CubicStiffness(Block):
    """Flexure leaves also stretch as they bend: x + c x^3 = f, c = k3 / k, ahead of the mechanics.

    Awtar & Slocum (2007), J. Mech. Des. 129, 625. Static: the shift of the resonance with the bias is not in it. Solved
    for s = x / f, s + z s^3 = 1 with z = c f^2, by Halley's method from (1 + 3 z)^(-1/3). A soft spring has no rest
    beyond z = -4/27; from z = -1/8 on s stays what it is there.
    """

    place = Place.GUIDE
    sizes = (0.02, 0.2)
    cubic = Parameter("1/response^2", (-0.1, 0.5), "Cubic over linear stiffness, k3 / k.", null=0)
    looks_like = ("quadratic_gain", "saturation", "encoder_cyclic_error")
    separate_by = "Load the stage with a known force or change its preload, or measure the resonance at several biases."
    remedy = "Work on a smaller part of the range, or put the identified curve into the calibration or feedforward."

    def prepare(cubic):
        return (cubic,)

    def start(u, cubic):
        return ()

    def step(u, cubic):
        z = cubic * u * u
        z = z if z > -0.125 else -0.125 + 0 * z
        return u * closer(closer(closer(1 + expm1(log1p(3 * z) / -3), z), z), z)


def closer(s, z):
    """Halley's step for s + z s^3 - 1 = 0: after three the error is of rounding for all z >= -1/8."""
    miss, slope = s + z * s * s * s - 1, 1 + 3 * z * s * s
    return s - miss * slope / (slope * slope - 3 * z * s * miss)
