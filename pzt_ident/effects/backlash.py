"""Clearance in the linkage between stage and sensor, a fault of the set-up."""

from pzt_ident.model.block import Block, Place
from pzt_ident.model.parameter import Parameter
from pzt_ident.model.registry import blocks


@blocks.register
class Backlash(Block):
    """The target of the sensor moves once the stage has crossed a gap 2 r: y = min(max(x - r, y), x + r).

    Tao & Kokotovic (1996), Adaptive Control of Systems with Actuator and Sensor Nonlinearities, ch. 2. The stage starts
    in the middle of the gap. A fault of the set-up: a diagnosis tells it, and `improve` never adds it; a job may, as
    `effects: [backlash]`.
    """

    place = Place.OUTPUT
    in_setup = True
    clearance = Parameter("response", (0, 0.2), "Half the gap in the linkage, r.", null=0)
    sizes = (0.02, 0.1, 0.5)
    loops = True
    look_alikes = ("friction", "distributed_memory")
    separate_by = "Read the stage with a second sensor that needs no linkage: only a backlash is not in its loops."
    remedy = "Tighten or preload the linkage between stage and sensor, or clamp the target to the stage."

    def prepare(clearance):
        return (clearance,)

    def start(u, clearance):
        return (u,)

    def step(y, u, clearance):
        y = min(max(u - clearance, y), u + clearance)
        return y, y
