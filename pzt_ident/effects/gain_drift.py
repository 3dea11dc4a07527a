"""Gain of the electronics that changes as they warm up, a fault of the set-up."""

from pzt_ident.model.block import Block, Place
from pzt_ident.model.first_order_hold import decay
from pzt_ident.model.parameter import Parameter
from pzt_ident.model.registry import blocks


@blocks.register
class GainDrift(Block):
    """The gain changes from the start of each record on: y = x (1 + growth (1 - exp(-t / tau))).

    Temperature of sensor electronics or amplifier: Fleming (2013), Sensors and Actuators A 190, 106. A fault of the
    set-up: a diagnosis tells it, and `improve` never adds it; a job may, as `effects: [gain_drift]`.
    """

    place = Place.OUTPUT
    in_setup = True
    about_rest = True
    trials = {"tau": 12}
    growth = Parameter("1", (-0.3, 0.3), "Growth of the gain until it has settled, as a share.", null=0)
    tau = Parameter("s", (0.01, 1e4), "Time in which it settles.", scale="log")
    look_alikes = ("drift", "creep", "amplitude_gain")
    separate_by = "Repeat one loop without a pause: its height changes from loop to loop, and creep leaves it as it is."
    remedy = "Let the electronics warm up before the record, or calibrate the sensor's gain at its start and end."

    def prepare(growth, tau, dt):
        return growth, decay(tau, dt)[0]

    def start(u, growth, keep):
        return (1 / keep if keep > 0 else 1.0,)

    def step(left, u, growth, keep):
        left *= keep
        return left, u * (1 + growth * (1 - left))
