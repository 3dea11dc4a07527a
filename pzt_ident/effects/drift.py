"""Thermal drift of stage, frame and sensor."""

from pzt_ident.model.block import Addition, Block, Place, expm1
from pzt_ident.model.parameter import Form, Parameter
from pzt_ident.model.registry import blocks


class Drifting:
    """What all forms of drift declare."""

    place = Place.OUTPUT
    form = Form(
        "exponential",
        ("exponential", "ramp", "curve", "read"),
        "The course of the drift, and whether a sensor reads it.",
    )
    size = Parameter("response", (-1, 1), "Final drift of a record.", null=0, per_record=True)
    look_alikes = ("creep", "thermal_relaxation")
    separate_by = (
        "Record at a constant voltage that has rested for as long before: drift shows there too, creep and relaxation "
        "do not."
    )
    remedy = "Let the rig warm up, shield it from draughts, and re-zero it before and after each record."


@blocks.register
class Drift(Drifting, Addition):
    """Stage and frame warm up and expand, whatever the drive: y = x + size (1 - exp(-t / tau)), t from the start.

    Fleming & Leang (2014), Design, Modeling and Control of Nanopositioning Systems. Nearly a ramp for a long tau.
    """

    tau = Parameter("s", (1, 3000), "Thermal time constant, one for all records.", scale="log", end="upper")

    def basis(t, tau):
        return (-expm1(-t / tau),)


class Ramp(Drifting, Addition):
    """A steady drift with a rate of its own in each record: y = x + size t / T, T the length of the record.

    Fleming & Leang (2014), Design, Modeling and Control of Nanopositioning Systems. Records of one day see it go up and
    down: together they are a random walk.
    """

    def basis(t, duration):
        return (t / duration,)


class Curve(Drifting, Addition):
    """A room that warms and cools drifts to and fro: y = x + size s + bend s^2 + turn s^3,  s = t / T, T the length of
    the record.

    Mokaberi & Requicha (2006), IEEE Trans. Autom. Sci. Eng. 3, 199: drift is slow and smooth, whatever its course. To
    third order it is followed over a quarter of a period of an air-conditioning, and in most of a half.
    """

    flexible = True
    bend = Parameter("response", (-1, 1), "Part that grows as the square of time.", null=0, per_record=True)
    turn = Parameter("response", (-1, 1), "Part that grows as the cube of time.", null=0, per_record=True)

    def basis(t, duration):
        s = t / duration
        return s, s * s, s * s * s


class Read(Drifting, Block):
    """The stage is elsewhere, and the sensor reads that with an error of its own: y = g(x + size (1 - exp(-t / tau))),
    t from the start, with g the blocks of the sensor.

    Fleming & Leang (2014), Design, Modeling and Control of Nanopositioning Systems. Behind a grating it moves the
    cyclic error along the stroke.
    """

    ahead_of = Place.SENSOR
    tau = Parameter("s", (1, 3000), "Thermal time constant, one for all records.", scale="log", end="upper")

    def prepare(size, tau, dt):
        return size, -expm1(-dt / tau)

    def start(u, size, rate):
        return (0.0,)

    def step(share, u, size, rate):
        return share + rate * (1 - share), u + size * share


Drift.forms = {"ramp": Ramp, "curve": Curve, "read": Read}
