"""Prandtl-Ishlinskii hysteresis: weighted plays."""

from math import log

from pzt_ident.hysteresis._rate import FASTEST, SLOW, growth, rate_terms
from pzt_ident.model.block import Bank, Place
from pzt_ident.model.parameter import Parameter
from pzt_ident.model.registry import blocks

PLAYS = 8
STANDING = 1e-13  # V/s, a rate of which no power counts


@blocks.register
class PrandtlIshlinskii(Bank):
    """y = w0 u + sum_i w_i F_i[u], F_i the play of half-width r_i = reach i / 8: p <- max(u - r, min(u + r, p)).

    Krasnosel'skii & Pokrovskii (1989), Systems with Hysteresis; Kuhnen (2003), Eur. J. Control 9, 407. A record begins
    as if its plays came from zero to the first drive without a reversal: each is at zero if that is within its
    half-width. Linear in the weights. Minor loops close.

    Effects, each without influence at zero: r_i <- r_i (1 + rate L), L as in Bouc-Wen; counted from rest where it has
    an onset or is a power, or r_i + rate reach (|du/dt| / (100 V/s))^order.
    """

    place = Place.OPERATOR
    branches = PLAYS
    gain = Parameter("response/drive", (0, 3), "Weight of the drive itself, w0.")
    weight = Parameter("response/drive", (-0.5, 1.5), "Weight of the i-th play, w_i.", count=PLAYS)
    reach = Parameter("drive", (0.05, 1), "Half-width of the widest play.", value=0.5)
    rate = Parameter("1", (-0.6, 0.6), "Growth of half-widths per decade of drive rate.", 0, effect="rate_dependence")
    onset = Parameter(
        "V/s", (SLOW, FASTEST), "Drive rate at which they begin to grow.", SLOW, "log", effect="rate_dependence.onset"
    )
    exponent = Parameter("1", (0, 1), "Power of the drive rate.", 0, effect="rate_dependence.power")
    level = Parameter(
        "V/s", (1.0, FASTEST), "Drive rate at half of the growth.", FASTEST, "log", effect="rate_dependence.level"
    )
    order = Parameter("1", (0.2, 2), "Power of the drive rate.", 1, effect="rate_dependence.alike")

    def threshold(reach, branch):
        return reach * (branch + 1) / PLAYS

    def prepare(gain, weight, reach, branch):
        return gain, weight, reach * (branch + 1) / PLAYS

    def start(u, gain, weight, half):
        return (max(u - half, min(u + half, 0.0)),)

    def step(p, u, gain, weight, half):
        p = max(u - half, min(u + half, p))
        return p, weight * p

    def output(u, total, gain, weight, half):
        return gain * u + total


class Widening(PrandtlIshlinskii):
    """p <- max(u - r, min(u + r, p)), r = r_i (1 + rate L) of the rate in the step: half-widths that grow with the
    rate of the drive.

    Al Janaideh & Krejci (2013), IEEE/ASME Trans. Mechatronics 18, 1498, with the law of rate of Bouc-Wen here.
    """

    def prepare(gain, weight, reach, rate, onset, exponent, level, branch, dt):
        return gain, weight, reach * (branch + 1) / PLAYS, 1.0, *rate_terms(rate, onset, exponent, level, dt)

    def start(u, gain, weight, half, least, rate, faster, slow, exponent, root, per, share):
        return max(u - half, min(u + half, 0.0)), u

    def step(p, before, u, gain, weight, half, least, rate, faster, slow, exponent, root, per, share):
        wide = half * max(least + growth(abs(u - before), rate, faster, slow, exponent, root, per, share), 0.01)
        p = max(u - wide, min(u + wide, p))
        return p, u, weight * p

    def output(u, total, gain, weight, half, least, rate, faster, slow, exponent, root, per, share):
        return gain * u + total


class WideningFromRest(Widening):
    """Half-widths that are r_i at rest: r = r_i (1 + rate (L - L(0)))."""

    def prepare(gain, weight, reach, rate, onset, exponent, level, branch, dt):
        terms = rate_terms(rate, onset, exponent, level, dt)
        return gain, weight, reach * (branch + 1) / PLAYS, 1 - growth(0.0, *terms), *terms


class WideningAlike(Widening):
    """r = r_i + rate reach (|du/dt| / (100 V/s))^order: half-widths that all grow by the same.

    Al Janaideh & Krejci (2013), IEEE/ASME Trans. Mechatronics 18, 1498, where the order is 1.
    """

    def prepare(gain, weight, reach, rate, order, branch, dt):
        share = (branch + 1) / PLAYS
        terms = rate_terms(rate / share * order * log(10), STANDING, order, FASTEST, dt)
        return gain, weight, reach * share, 1 - growth(0.0, *terms), *terms


PrandtlIshlinskii.forms = {
    "rate_dependence.alike": WideningAlike,
    "rate_dependence.onset": WideningFromRest,
    "rate_dependence.power": WideningFromRest,
    "rate_dependence.level": WideningFromRest,
    "rate_dependence": Widening,
}
