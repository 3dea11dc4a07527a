"""A response that saturates at large voltages."""

from pzt_ident.model.block import Block, Place, expm1
from pzt_ident.model.parameter import Parameter
from pzt_ident.model.registry import blocks


@blocks.register
class Saturation(Block):
    """All domains are switched: y = d U tanh(u / U) - h, knee = 1 / U.

    Royston & Houston (1998), J. Acoust. Soc. Am. 104, 2814. Odd in u; u (1 - (knee u)^2 / 3) for small u.
    """

    place = Place.READOUT
    sizes = (0.1, 0.3, 0.8)
    knee = Parameter("1/drive", (0, 2), "One over the voltage at which the response saturates.", null=0)
    look_alikes = ("quadratic_gain", "cubic_stiffness", "encoder_cyclic_error")
    separate_by = "Drive to both polarities up to the limits of the amplifier, and repeat under a known preload."
    remedy = "Keep to smaller voltages, or linearise the drive by the identified curve."

    def prepare(knee):
        return (knee,)

    def start(u, knee):
        return ()

    def step(u, knee):
        x = knee * u
        grown = expm1(2 * x)
        return u * (grown / ((grown + 2) * x)) if abs(x) > 1e-3 else u * (1 - x * x / 3 * (1 - 0.4 * x * x))
