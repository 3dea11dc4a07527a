"""Hysteresis that widens with the rate of the drive."""

from pzt_ident.model.block import Term
from pzt_ident.model.parameter import Form
from pzt_ident.model.registry import blocks


@blocks.register
class RateDependence(Term):
    """Domain walls follow the field late: alpha <- alpha (1 + rate log10(|du/dt| / (100 V/s))), alpha of Bouc-Wen; of
    Prandtl-Ishlinskii likewise the half-widths of all plays.

    Down to 0.01 V/s, below which alpha is constant. Logarithmic in the rate, as in Ang, Khosla & Riviere (2007),
    IEEE/ASME Trans. Mechatronics 12, 134; half-widths: Al Janaideh & Krejci (2013), IEEE/ASME Trans. Mechatronics 18,
    1498. Unlike a lag, which is linear in rate and amplitude, it vanishes for small amplitudes. In data of one rate
    alpha absorbs it. Of a drive in another unit than volts both rates are in its SI unit, as 100 A/s.
    """

    form = Form(
        "logarithm", ("logarithm", "onset", "power", "level", "alike"), "How the hysteresis grows with the rate."
    )
    look_alikes = ("amplifier_lag", "sensor_lag", "viscous_damping", "thermal_relaxation")
    separate_by = "Repeat one loop at rates two decades apart, and a small amplitude at the fastest."
    remedy = "Run at the rate that the model was identified at, or schedule the feedforward on the rate."


class Onset(RateDependence):
    """Below a rate v0 the hysteresis does not change: alpha <- alpha (1 + c log10(1 + |du/dt| / v0)).

    Ang, Khosla & Riviere (2007), with a rate from which on it counts. Written relative to 100 V/s, so that alpha keeps
    its meaning: alpha <- alpha (1 + rate log10((|du/dt| + v0) / (100 V/s + v0))), v0 being `onset`. Half-widths of
    plays are those at rest times 1 + rate log10(1 + |du/dt| / v0).
    """

    trials = {"onset": 5}


class Power(RateDependence):
    """A power of the rate: alpha <- alpha (1 + rate / (p log 10) ((|du/dt| / (100 V/s))^p - 1)), p being `exponent`.

    With rate = p log 10 the pure power that aging and activated switching give; the logarithm for p = 0. Ang, Khosla &
    Riviere (2007). Half-widths of plays are those at rest times 1 + rate (|du/dt| / (100 V/s))^p / (p log 10), which
    for p = 1 is linear in the rate.
    """

    trials = {"exponent": 4}


class Level(RateDependence):
    """The growth levels off: alpha <- alpha (1 + rate 4 / log 10 (x / (1 + x) - x1 / (1 + x1))), x = |du/dt| / level,
    x1 that of 100 V/s; `rate` is the growth per decade at the level.

    A law of this package: about the level it grows as the logarithm of Ang, Khosla & Riviere (2007), IEEE/ASME Trans.
    Mechatronics 12, 134, and it ends on either side. Half-widths of plays are those at rest times 1 + rate 4 / log 10
    x / (1 + x).
    """

    trials = {"level": 6}


class Alike(RateDependence):
    """All half-widths of plays grow by the same: r_i <- r_i + rate r_8 x^p, x = |du/dt| / (100 V/s), p being `order`.

    r_8 is the widest. Al Janaideh & Krejci (2013), IEEE/ASME Trans. Mechatronics 18, 1498, where p is 1. Of other
    operators it is the first form.
    """

    trials = {"order": 3}


RateDependence.forms = {"onset": Onset, "power": Power, "level": Level, "alike": Alike}
