"""Hysteresis that decays with time."""

from pzt_ident.model.block import Term
from pzt_ident.model.parameter import Form
from pzt_ident.model.registry import blocks


@blocks.register
class ThermalRelaxation(Term):
    """Thermally activated switching lets the hysteretic part relax: dh/dt <- dh/dt - h / tau, or with log time.

    Smith, Seelecke, Ounaies & Smith (2003), J. Intell. Mater. Syst. Struct. 14, 719, in its simplest form:
    exponential for Bouc-Wen, logarithmic in time for the coercive fields of the homogenized energy model. Unlike creep
    it grows not with the step but with h, and a small step back stops it.
    """

    form = Form("linear", ("linear", "activated"), "How the rate goes with the hysteretic part.")
    look_alikes = ("creep", "drift", "rate_dependence")
    separate_by = "Step up, wait, step back by five percent and hold for a minute: relaxation stops, creep goes on."
    remedy = "End every approach with a small step back, which stops the relaxation."


class Activated(ThermalRelaxation):
    """The more hysteresis is left, the lower is the barrier to a jump: dh/dt <- dh/dt - sinh(a h) / (a tau).

    Rate of thermally activated jumps under a stress: Eyring (1936), J. Chem. Phys. 4, 283. Logarithmic in time while
    a h is large, a being `activation`, and exponential at the end.
    """

    sizes = (0.002, 0.05)
    trials = {"activation": 5}


ThermalRelaxation.forms = {"activated": Activated}
