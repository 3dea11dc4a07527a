"""Dead time between command and voltage."""

from pzt_ident.model.block import Place, Shift
from pzt_ident.model.parameter import Parameter
from pzt_ident.model.registry import blocks


@blocks.register
class Delay(Shift):
    """Transport and sampling delay of command or reading: y(t) = u(t - time), for any fraction of a sample.

    Its phase lag is proportional to frequency, without the loss of amplitude of a lag. Ahead of the hysteresis or
    behind it is one: the whole response is later.
    """

    place = Place.DELAY
    sizes = tuple(2e-4 * 1.5**k for k in range(22))
    time = Parameter("s", (0, 0.1), "Dead time.", null=0)
    look_alikes = ("amplifier_lag", "sensor_lag", "viscous_damping", "creep")
    separate_by = "Chirp with a small amplitude beyond 500 Hz, sampled ten times faster than these records."
    remedy = "Record the voltage at the amplifier, or shift the reference ahead by the delay."

    def prepare(time, dt):
        return (time / dt,)
