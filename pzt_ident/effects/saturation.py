"""A response that saturates at large voltages."""

from pzt_ident.model.block import Block, Place, expm1, log1p
from pzt_ident.model.parameter import Form, Parameter
from pzt_ident.model.registry import blocks


@blocks.register
class Saturation(Block):
    """All domains are switched: y = d U tanh(u / U) - h, knee = 1 / U.

    Royston & Houston (1998), J. Acoust. Soc. Am. 104, 2814. Odd in u; y = d u (1 - (knee u)^2 / 3) - h for small u.
    """

    place = Place.READOUT
    form = Form("voltage", ("voltage", "displacement", "cubic", "knee"), "What saturates, and how.")
    sizes = (0.1, 0.3, 0.8)
    knee = Parameter("1/drive", (0, 2), "One over the voltage at which the response saturates.", null=0)
    look_alikes = ("quadratic_gain", "cubic_stiffness", "encoder_cyclic_error")
    leaves = ("cubic_stiffness",)
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
    """The stroke, or its sensor, levels off: y = F tanh(f / F), f = d u - h, knee = 1 / F.

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


class Knee(OfDisplacement):
    """The stroke levels off, sharply or softly: y = f / (1 + |f / F|^p)^(1 / p), f = d u - h, knee = 1 / F.

    Rapp (1991), Proc. 2nd European Conf. on Satellite Communications, 179. p = 1.4 is near an arctangent, p = 2.4 near
    a hyperbolic tangent, and a large p a stop.
    """

    sizes = tuple(0.24 * 1.09**k for k in range(15))  # a sharp knee shows from where the response comes to it
    trials = {"sharpness": 3}
    knee = Parameter("1/response", (0, 4), "One over the displacement at which the response saturates.", null=0)
    sharpness = Parameter("1", (1.2, 500), "How sharply the response turns to its limit, p.", scale="log", end="upper")

    def prepare(knee, sharpness):
        return knee, sharpness

    def start(u, knee, sharpness):
        return ()

    def step(u, knee, sharpness):
        x = abs(knee * u)
        far = 1 + expm1(-sharpness * abs(log1p(max(x, 1e-12) - 1)))
        return u * (1 + expm1(-log1p(far) / sharpness)) / max(x, 1.0)


Saturation.forms = {"displacement": OfDisplacement, "cubic": Cubic, "knee": Knee}
