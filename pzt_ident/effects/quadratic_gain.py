"""A gain that changes with the voltage."""

from pzt_ident.model.block import Block, Place
from pzt_ident.model.parameter import Form, Parameter
from pzt_ident.model.registry import blocks


@blocks.register
class QuadraticGain(Block):
    """Electrostriction curves both branches the same way: y = d (u + curvature u^2) - h.

    Hall (2001), J. Mater. Sci. 36, 4575. The hysteretic part h is driven by u itself.
    """

    place = Place.READOUT
    form = Form("voltage", ("voltage", "displacement"), "What the gain grows with.")
    curvature = Parameter("1/drive", (-0.5, 0.5), "Growth of the gain per drive, over twice the gain.", null=0)
    look_alikes = ("saturation", "cubic_stiffness", "encoder_cyclic_error")
    separate_by = (
        "Drive to both polarities: the parabola is even, saturation odd; repeat under a known preload, and with the "
        "encoder shifted by half a pitch."
    )
    remedy = "Linearise the drive by the identified parabola, or drive by charge."

    def prepare(curvature):
        return (curvature,)

    def start(u, curvature):
        return ()

    def step(u, curvature):
        return u + curvature * u * u


class OfDisplacement(QuadraticGain):
    """The stroke itself, or its reading, curves: y = f + curvature f^2, f = d u - h.

    Gu, Zhu & Su (2014), IEEE Trans. Ind. Electron. 61, 1583: a polynomial behind the hysteresis.
    """

    place = Place.STATIC
    about_rest = True
    curvature = Parameter("1/response", (-0.5, 0.5), "Growth of the gain by displacement, over twice it.", null=0)


QuadraticGain.forms = {"displacement": OfDisplacement}
