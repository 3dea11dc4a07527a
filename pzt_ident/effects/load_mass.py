"""Payload on the stage."""

from pzt_ident.model.block import Term
from pzt_ident.model.registry import blocks


@blocks.register
class LoadMass(Term):
    """A load moves with the stage and lowers its resonance: m <- m + load in the equation of the mechanics.

    The resonance falls to w = w0 / sqrt(1 + load / m); slow records do not show it.
    """

    sizes = tuple(0.0003 * 1.04**k for k in range(207))
    look_alikes = ("resonance",)
    separate_by = "Chirp with small amplitude through the resonance, with and without a known mass on the stage."
    remedy = "Take the load off or fix it firmly, and lower the bandwidth or the notch to the resonance with the load."
