"""Hysteresis that decays with time."""

from pzt_ident.model.block import Term
from pzt_ident.model.registry import blocks


@blocks.register
class ThermalRelaxation(Term):
    """Thermally activated switching lets the hysteretic part relax: dh/dt <- dh/dt - h / tau, or with log time.

    Smith, Seelecke, Ounaies & Smith (2003), J. Intell. Mater. Syst. Struct. 14, 719, in its simplest form:
    exponential for Bouc-Wen, logarithmic in time for plays. Unlike creep it grows not with the step but with h, and a
    small step back stops it.
    """

    look_alikes = ("creep", "drift", "rate_dependence")
    separate_by = "Step up, wait, step back by five percent and hold for a minute: relaxation stops, creep goes on."
    remedy = "End every approach with a small step back, which stops the relaxation."
