"""Hysteresis that forgets with time."""

from pzt_ident.model.block import Term
from pzt_ident.model.registry import blocks


@blocks.register
class ThermalRelaxation(Term):
    """Domains that switch by heat let the hysteretic part relax: dh/dt <- dh/dt - h / tau, or the logarithm of time.

    Smith, Seelecke, Ounaies & Smith (2003), J. Intell. Mater. Syst. Struct. 14, 719, in its simplest form: of
    Bouc-Wen an exponential, of plays a logarithm. Unlike creep it does not grow with the step but with h, and a small
    step back arrests it.
    """

    look_alikes = ("creep", "drift", "rate_dependence")
    separate_by = "Step up, wait, step back by five percent and hold for a minute: relaxation stops, creep goes on."
    remedy = "End every approach with a small step back, which arrests the relaxation."
