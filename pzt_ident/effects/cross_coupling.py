"""Force of one axis that moves another one through the stiffness of the guide."""

from math import pi

from pzt_ident.model.block import Coupling, Place
from pzt_ident.model.first_order_hold import mode, oscillate, oscillator
from pzt_ident.model.parameter import Form, Parameter
from pzt_ident.model.registry import blocks


@blocks.register
class CrossCoupling(Coupling):
    """The guide transmits force from axis to axis: f1 <- f1 + (k12 / k11) f2, ahead of the mechanics of axis 1.

    Lin & Lin (2012), Mechatronics 22, 614, eq. 6 and 20; only the ratios k12 / k11 and k21 / k22 can be
    identified.
    """

    place = Place.COUPLING
    form = Form(
        "force",
        ("force", "voltage", "displacement", "linear_displacement", "stiffness"),
        "What of the other axis acts.",
    )
    ratio = Parameter("1", (-5, 5), "Stiffness coupling k12 / k11 from the other axis.", null=0)
    look_alikes = ("kinematic_coupling",)
    separate_by = (
        "Chirp the other axis beyond the resonances of both with this one at rest: stiffness coupling rings at this "
        "axis' own resonance, a kinematic one at the other's."
    )
    remedy = "Feed the identified share of the other axis' drive forward, or decouple the axes in the controller."

    def prepare(ratio):
        return (ratio,)

    def start(y, other, ratio):
        return ()

    def step(y, other, ratio):
        return y + ratio * other


class OfVoltage(CrossCoupling):
    """The other axis' voltage acts, without its hysteresis: f1 <- f1 + d1 ratio u2.

    Stray field, leakage between the amplifiers' channels, or a transverse piezo coefficient: Yong, Moheimani, Kenton &
    Leang (2012), Rev. Sci. Instrum. 83, 121101.
    """

    place = Place.READOUT
    ratio = Parameter("1", (-5, 5), "Share of the other axis' voltage that acts on this axis.", null=0)


class OfDisplacement(CrossCoupling):
    """The other axis' displacement acts, with the resonance of that axis: f1 <- f1 + ratio G2 f2,
    G2 = 1 / (s^2/w^2 + 2 zeta s/w + 1), solved exactly for f2 linear on each step.

    A guide that the other axis shears pushes ahead of this axis' own mechanics: Yong, Moheimani, Kenton & Leang (2012),
    Rev. Sci. Instrum. 83, 121101.
    """

    trials = {"frequency": 160, "damping": 3}
    frequency = Parameter("Hz", (20, 2e4), "Natural frequency of the other axis.", scale="log")
    damping = Parameter("1", (1e-3, 0.3), "Damping ratio of the other axis, zeta.", scale="log")

    def prepare(ratio, frequency, damping, dt):
        return ratio, *oscillator(2 * pi * frequency, damping, dt)

    def start(y, other, ratio, r11, r12, r21, r22, b1, b2):
        return 0.0, 0.0, other

    def step(w, v, before, y, other, ratio, r11, r12, r21, r22, b1, b2):
        w, v = oscillate(w, v, other - before, r11, r12, r21, r22, b1, b2)
        return w, v, other, y + ratio * (other + w)


class OfLinearDisplacement(OfDisplacement):
    """The other axis' displacement acts, which has no hysteresis: f1 <- f1 + d1 ratio G2 u2.

    A second axis with charge drive: Fleming & Leang (2014), Design, Modeling and Control of Nanopositioning Systems.
    """

    place = Place.READOUT
    ratio = OfVoltage.ratio


class OfStiffness(CrossCoupling):
    """Both axes on one guide, M x'' + B x' + K x = k f with K's elements beside the diagonal, each way:
    m1 x1'' + b1 x1' + k1 (x1 - ratio x2) = k1 f1, ratio = -k12 / k11. The modes of the stage move both axes; with more
    than two axes the way over a third one is left out.

    Of each pair of axes d1 = G1 ratio12 x2 and d2 = G2 ratio21 x1 are solved with the mechanics G of the model, exactly
    for x linear on each step. Yong, Moheimani, Kenton & Leang (2012), Rev. Sci. Instrum. 83, 121101.
    """

    place = Place.MECHANICS
    of_mechanics = ("mass", "damping", "stiffness", "load", "extra_damping")
    ratio = Parameter("1", (-0.9, 0.9), "Stiffness coupling -k12 / k11 to the other axis.", null=0)

    def prepare(
        ratio,
        mass,
        damping,
        stiffness,
        load,
        extra_damping,
        other_ratio,
        other_mass,
        other_damping,
        other_stiffness,
        other_load,
        other_extra_damping,
        dt,
    ):
        own = mode(mass + load, damping + extra_damping, stiffness, dt)
        there = mode(other_mass + other_load, other_damping + other_extra_damping, other_stiffness, dt)
        return ratio, *own, other_ratio, *there

    def start(y, other, a, r11, r12, r21, r22, b1, b2, b, s11, s12, s21, s22, c1, c2):
        moved = (y + a * other) / (1 - a * b)
        return 0.0, 0.0, moved - y, 0.0, 0.0, b * moved

    def step(w, v, push, p, q, back, y, other, a, r11, r12, r21, r22, b1, b2, b, s11, s12, s21, s22, c1, c2):
        here, there = r11 * w + r12 * v - b1 * push, s11 * p + s12 * q - c1 * back
        near, far = (1 + b1) * a, (1 + c1) * b
        x = (y + here + near * (other + there)) / (1 - near * far)
        now, then = a * (other + there + far * x), b * x
        w, v = oscillate(w, v, now - push, r11, r12, r21, r22, b1, b2)
        p, q = oscillate(p, q, then - back, s11, s12, s21, s22, c1, c2)
        return w, v, now, p, q, then, x


CrossCoupling.forms = {
    "voltage": OfVoltage,
    "displacement": OfDisplacement,
    "linear_displacement": OfLinearDisplacement,
    "stiffness": OfStiffness,
}
