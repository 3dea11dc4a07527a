"""A gain that grows with the amplitude of the drive."""

from pzt_ident.effects._plays import Plays
from pzt_ident.model.block import Block, Place
from pzt_ident.model.parameter import Form, Parameter
from pzt_ident.model.registry import blocks

PLAYS = 20


class Growing:
    """What all forms of a gain that grows with the amplitude declare."""

    form = Form("record", ("record", "running", "rayleigh"), "What the amplitude is taken from.")
    growth = Parameter("1/drive", (-1, 1), "Relative growth of the gain per drive, peak to peak.", null=0)
    look_alikes = ("distributed_memory", "creep")
    separate_by = "Run equal loops at several amplitudes and several biases, and nested loops with revisits."
    remedy = "Calibrate at the amplitude that is used, or let the feedforward take the amplitude."


@blocks.register
class AmplitudeGain(Growing, Block):
    """Rayleigh's law, more domain walls move under a larger drive: y = (1 + growth U_pp) f.

    U_pp is the peak-to-peak drive of the axis in the record, of all of its samples. Damjanovic & Demartin (1996), J.
    Phys. D 29, 2057. In data of one amplitude the gain absorbs it.
    """

    place = Place.STATIC

    def prepare(growth, span):
        return (1 + growth * span,)

    def start(u, factor):
        return ()

    def step(u, factor):
        return u * factor


class Running(Growing, Block):
    """The gain grows with the widest swing so far: y = d u (1 + growth (max u - min u)) - h.

    Damjanovic & Demartin (1996), J. Phys. D 29, 2057.
    """

    place = Place.READOUT

    def prepare(growth):
        return (growth,)

    def start(u, growth):
        return u, u

    def step(low, high, u, growth):
        low, high = min(low, u), max(high, u)
        return low, high, u + u * growth * (high - low)


class Rayleigh(Growing, Plays):
    """Rayleigh's loops, with the hysteresis that belongs to them: y = d (u + growth int_0^peak F_r[u] dr) - h.

    F_r is a play of half-width r: the Preisach operator of a constant density. Damjanovic (1997), Phys. Rev. B 55,
    R649. Peak is the largest drive of the record.
    """

    place = Place.READOUT
    growth = Parameter("1/drive", (-5, 5), "Growth of the gain per amplitude of the drive.", null=0)
    branches = PLAYS

    def prepare(growth, peak, branch):
        return growth * peak / PLAYS, peak * (branch + 0.5) / PLAYS


AmplitudeGain.forms = {"running": Running, "rayleigh": Rayleigh}
