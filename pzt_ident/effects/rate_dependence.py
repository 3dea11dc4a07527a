"""Hysteresis that widens with the rate of the drive."""

from pzt_ident.model.block import Term
from pzt_ident.model.registry import blocks


@blocks.register
class RateDependence(Term):
    """Domain walls follow the field late: alpha <- alpha (1 + rate log10(|du/dt| / (100 V/s))).

    Logarithmic in the rate, as in Ang, Khosla & Riviere (2007), IEEE/ASME Trans. Mechatronics 12, 134. Unlike a lag,
    which is linear in rate and amplitude, it vanishes for small amplitudes. In data of one rate alpha absorbs it.
    """

    look_alikes = ("amplifier_lag", "sensor_lag", "viscous_damping", "thermal_relaxation")
    separate_by = "Repeat one loop at rates two decades apart, and a small amplitude at the fastest."
    remedy = "Run at the rate that the model was identified at, or schedule the feedforward on the rate."
