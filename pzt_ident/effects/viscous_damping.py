"""Damping beyond that of the bare mechanics."""

from pzt_ident.model.block import Term
from pzt_ident.model.registry import blocks


@blocks.register
class ViscousDamping(Term):
    """Air films, cables and grease add damping: b <- b + extra_damping in the equation of the mechanics.

    Below the resonance the response lags by b omega / k, and ringing decays faster.
    """

    sizes = tuple(3e-4 * 1.5**k for k in range(20))
    look_alikes = ("amplifier_lag", "sensor_lag", "delay", "resonance")
    separate_by = "Chirp with small amplitude through the resonance: damping lowers its peak, a lag or delay does not."
    remedy = "Free the moving parts of films and cables, or keep it and put the lag into the feedforward."
