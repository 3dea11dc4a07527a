"""What the stage went through before a record, as far as its hysteresis remembers it."""

from itertools import product

from pzt_ident.model.block import Block, Place
from pzt_ident.model.parameter import Form, Parameter
from pzt_ident.model.registry import blocks

LEAD = 4  # samples, as many as a kernel steps in one pass
FAR = 3  # times the drive of a record: a virgin memory must go further than one that was cycled
SHARES = tuple(share / FAR for share in (-1, -0.5, -0.2, 0.2, 0.5, 1))  # plays notice no reversal next to the start


@blocks.register
class History(Block):
    """A record that starts in motion: the hysteresis came from v = u(0) + last, the last reversal, to v = u(0).

    Visintin (1994), Differential Models of Hysteresis: of what was before, a memory keeps reversals alone. At the first
    of those that are followed it is virgin. One is all that Bouc-Wen can tell. `lumped` may be under way, and all else
    is at rest.
    """

    place = Place.SUPPLY
    lead = LEAD
    form = Form("one", ("one", "two"), "How many reversals ahead of a record.")
    last = Parameter("drive", (-FAR, FAR), "Last reversal ahead of a record, from u(0).", null=0, per_record=True)
    starts = {"last": SHARES}

    def prepare(last, lead):
        return last, lead

    def start(u, last, lead):
        return (0.0,)

    def step(i, u, last, lead):
        return i + 1, u + (last if i < lead else 0.0)


class Two(History):
    """The last two reversals, v = u(0) + earlier and v = u(0) + last: plays and a Preisach operator remember both.

    Visintin (1994), Differential Models of Hysteresis.
    """

    earlier = Parameter("drive", (-FAR, FAR), "Reversal before the last one, likewise.", null=0, per_record=True)
    starts = dict(zip(("last", "earlier"), zip(*product(SHARES, SHARES), strict=True), strict=True))

    def prepare(last, earlier, lead):
        return last, earlier, lead

    def start(u, last, earlier, lead):
        return (0.0,)

    def step(i, u, last, earlier, lead):
        return i + 1, u + (earlier if i < lead / 2 else (last if i < lead else 0.0))


History.forms = {"two": Two}
