"""Sensor that follows the stage through a low-pass filter."""

from pzt_ident.effects._lag import Lag
from pzt_ident.model.block import Place
from pzt_ident.model.parameter import Parameter
from pzt_ident.model.registry import blocks


@blocks.register
class SensorLag(Lag):
    """The reading follows the displacement through the sensor's low-pass: tau y' + y = x.

    Fleming (2013), Sensors and Actuators A 190, 106. Acts behind everything else.
    """

    place = Place.SENSOR
    tau = Parameter("s", (0, 5e-3), "Time constant of the sensor's filter.", null=0)
    look_alikes = ("amplifier_lag", "delay", "viscous_damping")
    separate_by = (
        "Change the filter of the sensor electronics, which changes this lag alone, or put a known capacitor in "
        "parallel with the stack, which does not."
    )
    remedy = "Widen the bandwidth of the sensor's filter, or take the identified lag out of the readings."
