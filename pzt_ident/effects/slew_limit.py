"""Amplifier whose current limits how fast the voltage of a capacitive load can change."""

from math import inf

from pzt_ident.model.block import Block, Place
from pzt_ident.model.parameter import Parameter
from pzt_ident.model.registry import blocks


@blocks.register
class SlewLimit(Block):
    """The current limit bounds the rate of the voltage: |dU_a/dt| <= 1 / slowness, slowness = C / I_max.

    Fleming & Leang (2014), Design, Modeling and Control of Nanopositioning Systems. Exact for a command that is linear
    between samples: a command that returns may meet the lagging voltage within a sample and leave it behind again.
    """

    place = Place.SLEW
    sizes = tuple(1.25**-k for k in range(32))
    slowness = Parameter("s/drive", (0, 0.1), "Capacitance over the greatest current.", null=0)
    look_alikes = ("amplifier_lag", "sensor_lag")
    separate_by = "Sweep the amplitude at one frequency: this sets in where frequency times amplitude exceeds a limit."
    remedy = "Stay below the slew rate, round the corners of the drive, or use an amplifier with more current."

    def prepare(slowness, dt):
        return (dt / slowness if slowness != 0 else inf,)

    def start(u, limit):
        return u, u

    def step(y, before, u, limit):
        sign = 1.0 if before >= y else -1.0
        back = sign * (before - u)
        met = min(1.0, abs(before - y) / (limit + abs(back)))
        follows = u if abs(u - y) <= limit else y + (limit if u > y else -limit)
        y = y + sign * limit * (2 * met - 1) if back > limit else follows
        return y, u, y
