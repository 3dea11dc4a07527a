"""Dead zone of an amplifier, a fault of the set-up."""

from pzt_ident.model.block import Block, Place
from pzt_ident.model.parameter import Parameter
from pzt_ident.model.registry import blocks


@blocks.register
class DeadZone(Block):
    """The amplifier's output stays where it is while the command crosses a zone: U_a = U - min(max(U - centre, -width),
    width).

    One transistor of an output stage takes over there from the other. Tao & Kokotovic (1996), Adaptive Control of
    Systems with Actuator and Sensor Nonlinearities, ch. 2. A fault of the set-up: a diagnosis tells it, and `improve`
    never adds it; a job may, as `effects: [dead_zone]`.
    """

    place = Place.SUPPLY
    in_setup = True
    solvable = False
    width = Parameter("drive", (0, 0.2), "Half the width of the zone.", null=0)
    centre = Parameter("drive", (-1, 1), "Command in the middle of the zone.")
    trials = {"centre": 80}
    sizes = (0.02, 0.1, 0.3)
    look_alikes = ("encoder_cyclic_error", "distributed_memory", "quadratic_gain")
    separate_by = "Record the output of the amplifier beside the command: it stands still while the command goes on."
    remedy = "Set the quiescent current of the amplifier's output stage, or keep the command on one side of the zone."

    def prepare(width, centre):
        return width, centre

    def start(u, width, centre):
        return ()

    def step(u, width, centre):
        return u - min(max(u - centre, -width), width)
