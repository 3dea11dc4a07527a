"""A second mode of the flexure."""

from dataclasses import replace
from math import pi

from pzt_ident.model.block import Beside, Block, Place
from pzt_ident.model.first_order_hold import oscillate, oscillator
from pzt_ident.model.parameter import Form, Parameter
from pzt_ident.model.registry import blocks


class SecondMode:
    """What all forms of a second mode declare."""

    form = Form("parallel", ("parallel", "series", "voltage"), "Where the second mode is, and what drives it.")
    trials = {"frequency": 160, "damping": 3}
    share = Parameter(
        "1",
        (-0.8, 0.8),
        "Part of the static response that the second mode carries.",
        null=0,
        limit="the main mode, and the mechanics of the job, if it has any, stand in for something else",
    )
    frequency = Parameter("Hz", (20, 2e4), "Natural frequency of the second mode.", scale="log")
    damping = Parameter("1", (1e-3, 0.3), "Damping ratio of the second mode, zeta.", scale="log")
    look_alikes = ("load_mass", "viscous_damping")
    separate_by = "Chirp with a small amplitude through all modes, sampled ten times faster than the highest."
    remedy = "Put a notch at the identified frequency, or shape the reference so that it does not ring."

    def prepare(share, frequency, damping, dt):
        return share, *oscillator(2 * pi * frequency, damping, dt)


@blocks.register
class Resonance(SecondMode, Beside):
    """A second mode in parallel to the first: y = (1 - share) x + share G2 f, G2 = 1 / (s^2/w^2 + 2 zeta s/w + 1).

    Solved exactly for f linear on each step. For a negative share the pole comes before the zero.
    """

    place = Place.MODE

    def start(f, share, r11, r12, r21, r22, b1, b2):
        return 0.0, 0.0, f

    def step(w, v, before, x, f, share, r11, r12, r21, r22, b1, b2):
        w, v = oscillate(w, v, f - before, r11, r12, r21, r22, b1, b2)
        return w, v, f, x + share * (f + w - x)


class Series(SecondMode, Block):
    """The force reaches the first mode partly through the second: f <- f + share (G2 - 1) f.

    Fleming & Leang (2014), Design, Modeling and Control of Nanopositioning Systems: modes in series.
    """

    place = Place.FLEXURE
    share = Parameter(
        "1",
        (-0.8, 1.2),
        "Part of the force that goes through the second mode: 1 where all of it does.",
        null=0,
        limit=SecondMode.share.limit,
    )

    def start(u, share, r11, r12, r21, r22, b1, b2):
        return 0.0, 0.0, u

    def step(w, v, before, u, share, r11, r12, r21, r22, b1, b2):
        w, v = oscillate(w, v, u - before, r11, r12, r21, r22, b1, b2)
        return w, v, u, u + share * w


class OfVoltage(Series):
    """The voltage drives the second mode, without the hysteresis: y = d (u + share (G2 - 1) u) - h.

    A mode of the stack, or of the amplifier with its load, ahead of the guide: Fleming & Leang (2014).
    """

    place = Place.READOUT
    solvable = False
    share = Parameter("1", (-0.4, 0.4), SecondMode.share.doc, null=0)
    frequency = replace(SecondMode.frequency, doc="Natural frequency of the stack or the amplifier.")


Resonance.forms = {"series": Series, "voltage": OfVoltage}
