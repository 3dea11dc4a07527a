"""A gain that grows with the amplitude of the drive."""

from pzt_ident.model.block import Block, Place
from pzt_ident.model.parameter import Parameter
from pzt_ident.model.registry import blocks


@blocks.register
class AmplitudeGain(Block):
    """Rayleigh's law, more domain walls move under a larger drive: y = (1 + growth U_pp) f.

    U_pp is the peak-to-peak drive of the record. Damjanovic & Demartin (1996), J. Phys. D 29, 2057. In data of one
    amplitude the gain absorbs it.
    """

    place = Place.STATIC
    growth = Parameter("1/drive", (-1, 1), "Relative growth of the gain per volt peak to peak.", null=0)
    look_alikes = ("distributed_memory", "creep")
    separate_by = "Run equal loops at several amplitudes and several biases, and nested loops with revisits."
    remedy = "Calibrate at the amplitude that is used, or let the feedforward take the amplitude."

    def prepare(growth, span):
        return (1 + growth * span,)

    def start(u, factor):
        return ()

    def step(u, factor):
        return u * factor
