"""A response that saturates at large voltages."""

from pzt_ident.model.block import Block, Place, expm1
from pzt_ident.model.parameter import Form, Parameter
from pzt_ident.model.registry import blocks


@blocks.register
class Saturation(Block):
    """All domains are switched: y = d U tanh(u / U) - h, knee = 1 / U.

    Royston & Houston (1998), J. Acoust. Soc. Am. 104, 2814. Odd in u; y = d u (1 - (knee u)^2 / 3) - h for small u.
    """

    place = Place.READOUT
    form = Form("voltage", ("voltage", "displacement", "cubic"), "What saturates, and how.")
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


class OfDisplacement(Saturation):
    """The stroke levels off: y = F tanh(f / F), f = d u - h, knee = 1 / F.

    Royston & Houston (1998), J. Acoust. Soc. Am. 104, 2814, behind the hysteresis.
    """

    place = Place.STATIC
    about_rest = True
    knee = Parameter("1/response", (0, 2), "One over the displacement at which the response saturates.", null=0)


class Cubic(Saturation):
    """The first term of saturation alone: y = d (u - knee^2 u^3) - h.

    Wang & Zhu (2011), Smart Mater. Struct. 20, 035018: a polynomial in the voltage.
    """

    def step(u, knee):
        return u * (1 - knee * u * (knee * u))


Saturation.forms = {"displacement": OfDisplacement, "cubic": Cubic}
