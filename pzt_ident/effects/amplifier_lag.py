"""Amplifier that charges the stack through its output resistance."""

from pzt_ident.effects._lag import Lag, SecondOrderLag
from pzt_ident.model.block import Place
from pzt_ident.model.parameter import Form, Parameter
from pzt_ident.model.registry import blocks


class Charging:
    """What all forms of the amplifier's lag declare."""

    place = Place.AMPLIFIER
    form = Form("one_pole", ("one_pole", "two_poles"), "Order of the low-pass.")
    tau = Parameter("s", (0, 0.05), "Time constant of output resistance and capacitance.", null=0)
    look_alikes = ("sensor_lag", "delay", "viscous_damping", "creep")
    separate_by = (
        "Put a known capacitor in parallel with the stack, which lengthens this lag alone, or record the amplifier's "
        "monitor output instead of the command."
    )
    remedy = "Use the monitor output as the drive, or an amplifier of lower output resistance; else invert the lag."


@blocks.register
class AmplifierLag(Charging, Lag):
    """The voltage follows the command through output resistance and capacitance: tau U_a' + U_a = U, tau = R C.

    Fleming & Leang (2014), Design, Modeling and Control of Nanopositioning Systems. Acts ahead of the hysteresis.
    """


class TwoPoles(Charging, SecondOrderLag):
    """Two stages behind each other: (tau^2 s^2 / (4 zeta^2) + tau s + 1) U_a = U, with the same lag at low frequency.

    Fleming & Leang (2014), Design, Modeling and Control of Nanopositioning Systems.
    """


AmplifierLag.forms = {"two_poles": TwoPoles}
