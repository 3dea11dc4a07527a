"""Amplifier that charges the stack through its output resistance."""

from pzt_ident.effects._lag import Lag
from pzt_ident.model.block import Place
from pzt_ident.model.parameter import Parameter
from pzt_ident.model.registry import blocks


@blocks.register
class AmplifierLag(Lag):
    """The voltage follows the command through output resistance and capacitance: tau U_a' + U_a = U, tau = R C.

    Fleming & Leang (2014), Design, Modeling and Control of Nanopositioning Systems. Acts ahead of the hysteresis.
    """

    place = Place.AMPLIFIER
    tau = Parameter("s", (0, 5e-3), "Time constant of output resistance and capacitance.", null=0)
    look_alikes = ("sensor_lag", "delay", "viscous_damping")
    separate_by = (
        "Put a known capacitor in parallel with the stack, which lengthens this lag alone, or record the amplifier's "
        "monitor output instead of the command."
    )
    remedy = "Use the monitor output as the drive, or an amplifier of lower output resistance; else invert the lag."
