"""Memory of many past reversals."""

from math import tanh

from pzt_ident.effects._plays import Plays
from pzt_ident.model.block import Place, expm1
from pzt_ident.model.parameter import Form, Parameter
from pzt_ident.model.registry import blocks

PLAYS = 10


@blocks.register
class DistributedMemory(Plays):
    """Domains of many coercive voltages: y = d (u + sum_i w_i F_i[u]) - h, plays of half-width r_i = reach i / 10.

    Prandtl-Ishlinskii plays, p <- max(u - r, min(u + r, p)); Kuhnen (2003), Eur. J. Control 9, 407. Plays
    close nested loops, Bouc-Wen drifts through them.
    """

    place = Place.READOUT
    form = Form(
        "plays", ("plays", "fine_plays", "stops", "bent_plays", "two_plays"), "How many plays, and what each adds."
    )
    refines = ("prandtl_ishlinskii",)
    branches = PLAYS
    weight = Parameter("1", (-0.5, 0.5), "Weight of the i-th play over the gain.", null=0, count=PLAYS)
    reach = Parameter("drive", (0.05, 1), "Half-width of the widest play.", value=0.4)
    look_alikes = ("amplitude_gain",)
    leaves = ("amplitude_gain",)
    separate_by = "Run nested loops that come back to the same voltages: plays close them, Bouc-Wen does not."
    remedy = "Use a Prandtl-Ishlinskii or Preisach inverse in the feedforward, or return over a full loop."

    def prepare(weight, reach, branch):
        return weight, reach * (branch + 1) / PLAYS


class FinePlays(DistributedMemory):
    """Twice as many plays, half as far apart: y = d (u + sum_i w_i F_i[u]) - h, r_i = reach i / 20.

    Kuhnen (2003), Eur. J. Control 9, 407, with a finer grid of half-widths.
    """

    branches = 2 * PLAYS
    weight = Parameter("1", (-0.5, 0.5), "Weight of the i-th play over the gain.", null=0, count=2 * PLAYS)

    def prepare(weight, reach, branch):
        return weight, reach * (branch + 1) / (2 * PLAYS)


class Stops(DistributedMemory):
    """Elastic elements that slip take part of the prompt response back, and of a long stroke nothing: y = d (u - sum_i
    w_i (u - F_i[u])) - h, stops of half-width r_i = reach i / 10.

    Maxwell slip elements: Goldfarb & Celanovic (1997), IEEE Control Syst. Mag. 17, 69. A stop is what a play leaves of
    its input, so that these are plays beside another gain: d is that of a long stroke, not of a small one.
    """

    weight = Parameter("1", (-0.5, 0.5), "Weight of the i-th stop over the gain.", null=0, count=PLAYS)

    def step(p, u, weight, half):
        p = max(u - half, min(u + half, p))
        return p, weight * (p - u)


class BentPlays(DistributedMemory):
    """Plays whose share levels off about a centre, so that equal loops differ with the bias as in a Preisach operator:
    y = d (u + sum_i w_i b_i) - h, b_i = e(F_i[u] - centre) - e(-centre), e(v) = tanh(knee v) / knee.

    Generalised Prandtl-Ishlinskii operator with envelopes: Al Janaideh, Rakheja & Su (2011), IEEE/ASME Trans.
    Mechatronics 16, 734. For relays with normally distributed interaction fields tanh stands for erf: Smith et al.,
    Model Development for AFM Stage Mechanisms, eq. 7 to 14.
    """

    refines = ()
    trials = {"knee": 5, "centre": 3}
    knee = Parameter("1/drive", (0, 10), "One over the voltage over which the share of a play levels off.", null=0)
    centre = Parameter("drive", (-1, 1), "Voltage about which it levels off.")

    def prepare(weight, reach, knee, centre, branch):
        rest = tanh(knee * centre) / knee if knee != 0 else centre
        return weight, reach * (branch + 1) / PLAYS, knee, centre, rest

    def start(u, weight, half, knee, centre, rest):
        return (max(u - half, min(u + half, 0.0)),)

    def step(p, u, weight, half, knee, centre, rest):
        p = max(u - half, min(u + half, p))
        v = p - centre
        x = knee * v
        grown = expm1(2 * min(max(x, -20.0), 20.0))
        return p, weight * (v * (grown / ((grown + 2) * x) if abs(x) > 1e-3 else 1 - x * x / 3) + rest)

    def output(u, total, weight, half, knee, centre, rest):
        return u + total


class TwoPlays(DistributedMemory):
    """Two plays, as of joints with backlash: y = d (u + w_1 F_1[u] + w_2 F_2[u]) - h, r_1 = inner reach, r_2 = reach.

    Kuhnen (2003), Eur. J. Control 9, 407, with half-widths that are fitted.
    """

    branches = 2
    trials = {"reach": 6, "inner": 4}
    weight = Parameter("1", (-1, 1), "Weight of the i-th play over the gain.", null=0, count=2)
    reach = Parameter("drive", (0.02, 0.6), "Half-width of the second play.", scale="log")
    inner = Parameter("1", (0.05, 1), "Half-width of the first play over that of the second.")

    def prepare(weight, reach, inner, branch):
        return weight, reach if branch else reach * inner


DistributedMemory.forms = {"fine_plays": FinePlays, "stops": Stops, "bent_plays": BentPlays, "two_plays": TwoPlays}
