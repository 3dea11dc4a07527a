"""Sensor that follows the stage through a low-pass filter."""

from pzt_ident.effects._lag import Lag, SecondOrderLag, ThirdOrderLag
from pzt_ident.model.block import Place
from pzt_ident.model.parameter import Form, Parameter
from pzt_ident.model.registry import blocks


class Filtering:
    """What all forms of the sensor's lag declare."""

    place = Place.SENSOR
    form = Form("one_pole", ("one_pole", "second_order", "third_order"), "Order of the filter.")
    tau = Parameter("s", (0, 0.05), "Time constant of the sensor's filter.", null=0)
    look_alikes = ("amplifier_lag", "delay", "viscous_damping", "load_mass", "resonance", "creep")
    separate_by = (
        "Change the filter of the sensor electronics, which changes this lag alone, or put a known capacitor in "
        "parallel with the stack, which does not."
    )
    remedy = "Widen the bandwidth of the sensor's filter, or take the identified lag out of the readings."


@blocks.register
class SensorLag(Filtering, Lag):
    """The reading follows the displacement through the sensor's low-pass: tau y' + y = x.

    Fleming (2013), Sensors and Actuators A 190, 106. Acts behind everything else.
    """


class SecondOrderFilter(Filtering, SecondOrderLag):
    """A filter of second order: (tau^2 s^2 / (4 zeta^2) + tau s + 1) y = x, with the same lag at low frequency.

    Fleming (2013), Sensors and Actuators A 190, 106.
    """


class ThirdOrderFilter(Filtering, ThirdOrderLag):
    """A filter of third order: (share tau s + 1) (r^2 s^2 / (4 zeta^2) + r s + 1) y = x, r = (1 - share) tau.

    Fleming (2013), Sensors and Actuators A 190, 106: the output filter of a capacitive sensor.
    """


SensorLag.forms = {"second_order": SecondOrderFilter, "third_order": ThirdOrderFilter}
