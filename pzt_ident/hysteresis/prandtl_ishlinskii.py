"""Prandtl-Ishlinskii hysteresis: weighted plays."""

from pzt_ident.model.block import Bank, Place
from pzt_ident.model.parameter import Parameter
from pzt_ident.model.registry import blocks

PLAYS = 8


@blocks.register
class PrandtlIshlinskii(Bank):
    """y = w0 u + sum_i w_i F_i[u], F_i the play of half-width r_i = reach i / 8: p <- max(u - r, min(u + r, p)).

    Krasnosel'skii & Pokrovskii (1989), Systems with Hysteresis; Kuhnen (2003), Eur. J. Control 9, 407. The initial
    state is virgin: each play is at zero if the first input is within its half-width. Linear in the weights. Minor
    loops close.
    """

    place = Place.OPERATOR
    branches = PLAYS
    gain = Parameter("response/drive", (0, 3), "Weight of the drive itself, w0.")
    weight = Parameter("response/drive", (-0.5, 1.5), "Weight of the i-th play, w_i.", count=PLAYS)
    reach = Parameter("drive", (0.05, 1), "Half-width of the widest play.", value=0.5)

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
