"""Memory of many past reversals."""

from pzt_ident.model.block import Bank, Place
from pzt_ident.model.parameter import Parameter
from pzt_ident.model.registry import blocks

PLAYS = 10


@blocks.register
class DistributedMemory(Bank):
    """Domains of many coercive voltages: y = d (u + sum_i w_i F_i[u]) - h, plays of half-width r_i = reach i / 10.

    Prandtl-Ishlinskii plays, p <- max(u - r, min(u + r, p)); Kuhnen (2003), Eur. J. Control 9, 407. Plays
    close nested loops, Bouc-Wen drifts through them.
    """

    place = Place.READOUT
    branches = PLAYS
    weight = Parameter("1", (-0.5, 0.5), "Weight of the i-th play over the gain.", null=0, count=PLAYS)
    reach = Parameter("drive", (0.05, 1), "Half-width of the widest play.", value=0.4)
    look_alikes = ("amplitude_gain",)
    separate_by = "Run nested loops that come back to the same voltages: plays close them, Bouc-Wen does not."
    remedy = "Use a Prandtl-Ishlinskii or Preisach inverse in the feedforward, or return over a full loop."

    def prepare(weight, reach, branch):
        return weight, reach * (branch + 1) / PLAYS

    def start(u, weight, half):
        return (max(u - half, min(u + half, 0.0)),)

    def step(p, u, weight, half):
        p = max(u - half, min(u + half, p))
        return p, weight * p

    def output(u, total, weight, half):
        return u + total
