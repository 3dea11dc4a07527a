"""Supply of the amplifier that ends before the command, a fault of the set-up."""

from pzt_ident.model.block import Block, Place
from pzt_ident.model.parameter import Parameter
from pzt_ident.model.registry import blocks


@blocks.register
class Clipping(Block):
    """The amplifier's output stays within its supply: U_a = min(max(U, -1 / rail), 1 / rail).

    Fleming & Leang (2014), Design, Modeling and Control of Nanopositioning Systems. A fault of the
    set-up: a diagnosis tells it, and `improve` never adds it; a job may, as `effects: [clipping]`.
    """

    place = Place.SUPPLY
    in_setup = True
    solvable = False
    rail = Parameter("1/drive", (0, 4), "One over the largest output.", null=0)
    sizes = (0.2505, 0.255, 0.27, 0.3, 0.4, 0.505, 0.52, 0.56, 0.65, 0.85)
    look_alikes = ("saturation", "quadratic_gain", "asymmetry")
    separate_by = "Record the output of the amplifier beside the command: it stands still while the command goes on."
    remedy = "Raise the supply of the amplifier, or keep the command within what it can put out."

    def prepare(rail):
        return (rail,)

    def start(u, rail):
        return ()

    def step(u, rail):
        return u if abs(u) * rail <= 1 else (1 / rail if u > 0 else -1 / rail)
