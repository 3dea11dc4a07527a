"""The homogenized energy model without thermal activation, as plays with a nonlinear readout."""

from dataclasses import replace
from math import exp, sqrt
from statistics import NormalDist

from pzt_ident.errors import InputError
from pzt_ident.hysteresis._play import play, relaxed, relaxing
from pzt_ident.model.block import Bank, Place, erf
from pzt_ident.model.parameter import Form, Parameter, Setting
from pzt_ident.model.registry import blocks

NODES = 64
QUANTILES = tuple(NormalDist().inv_cdf((i + 0.5) / NODES) for i in range(NODES))


def spread_of(block):
    """Refuses a standard deviation below zero."""

    def refuse(least, most):
        if least.spread < 0:
            remedy = "give a value or lower bound of zero or more"
            said = f"a standard deviation of {least.spread:g} is below zero"
            raise InputError(said, where=f"{block}.spread", remedy=remedy)

    return refuse


@blocks.register
class HomogenizedEnergy(Bank):
    """y = a1 (P - P_R) + a2 (P - P_R)^2,  P = E / eta + P_R int nu1(Ec) (2 Phi2(F_Ec[E]) - 1) dEc.

    Smith et al., Model Development for Atomic Force Microscope Stage Mechanisms, eqs. 7, 12 and 15, with u for E.
    nu1 is lognormal, nu2 normal. The domains of one coercive field that point up are those of interaction fields above
    -F_Ec, F_Ec the play p <- max(E - Ec, min(E + Ec, p)) (Krasnosel'skii & Pokrovskii 1989): exact in the interaction
    field. Coercive fields are taken at 64 nodes of equal probability. P is counted as the field eta P.

    E is the drive less the bias. Before the first sample the material was taken from its virgin state to `poled` and
    from there to the sample. Responses of different kinds, such as P itself and a displacement, may share all but gain
    and quadratic.
    """

    place = Place.OPERATOR
    density = Form(
        "lognormal",
        ("lognormal", "free", "shared"),
        "Of the coercive fields; `free` weighs nodes that lie evenly, `shared` does so once for all responses.",
    )
    seen = ("coercive",)
    branches = NODES
    gain = Parameter("response/drive", (0, 3), "Response per field of a domain that does not switch, a1 / eta.")
    remanence = Parameter("drive", (0.05, 10), "Remanent polarization of a domain as the field eta P_R.", scale="log")
    coercive = Parameter("drive", (0.005, 5), "Median of the coercive fields.", scale="log")
    spread = Parameter("1", (0.1, 2), "Standard deviation of the logarithm of the coercive field.")
    interaction = Parameter("drive", (0.01, 5), "Standard deviation of the interaction field.", scale="log")
    quadratic = Parameter("response/drive^2", (-3, 3), "Response per square of the field, a2 / eta^2.", value=0)
    poled = Parameter("drive", (-3, 3), "Field that the material had seen before, 0 where it is virgin.", value=0)
    bias = Parameter("drive", (-0.5, 0.5), "Part of the drive that is no field in the material.", value=0)
    fluctuation = Parameter(
        "drive",
        (0, 0.1),
        "Growth of coercive fields with the rate, a factor of e.",
        null=0,
        effect="thermal_relaxation",
    )

    refuse = spread_of("homogenized_energy")

    def prepare(gain, remanence, coercive, spread, interaction, quadratic, poled, bias, branch):
        per_width = 1 / (sqrt(2.0) * interaction)
        half = coercive * exp(spread * QUANTILES[int(branch)]) * per_width
        before = play(0.0, (poled - bias) * per_width, half)
        return gain, remanence, quadratic, bias, per_width, half, before

    def start(u, gain, remanence, quadratic, bias, per_width, half, before):
        return (play(before, (u - bias) * per_width, half),)

    def step(p, u, gain, remanence, quadratic, bias, per_width, half, before):
        p = play(p, (u - bias) * per_width, half)
        return p, erf(p)

    def rests(p, low, high, gain, remanence, quadratic, bias, per_width, half, before):
        return (low - bias) * per_width >= p - half and (high - bias) * per_width <= p + half

    def output(u, total, gain, remanence, quadratic, bias, per_width, half, before):
        field = u - bias + remanence * (total / NODES - 1)
        return (gain + quadratic * field) * field


class FreeDensity(Bank):
    """y = a1 / eta E + sum_i w_i (2 Phi2(F_i[E]) - 1),  F_i the play of half-width Ec_i = reach (i - 1/2) / nodes.

    Smith et al., eqs. 12 and 15, of a1 alone, with the weights w_i = a1 P_R nu1(Ec_i) reach / nodes in the place of a
    form of nu1. The plays do not depend on them: gain and weights are solved for by non-negative least squares, inside
    the search over the width of the interaction field, with their squared second differences beside the errors.
    """

    place = Place.OPERATOR
    density = HomogenizedEnergy.density
    nodes = Setting(22, (4, 128), "Coercive fields, evenly from 0 to `reach`.")  # with gain and none one group of lanes
    seen = ("reach",)
    gain = Parameter("response/drive", (0, 3), HomogenizedEnergy.gain.doc, linear=True)
    weight = Parameter(
        "response", (0, 1), "Response to all domains of one coercive field that turn, half of it.",
        count="nodes", linear=True, smooth="smoothness",
    )  # fmt: skip
    interaction = HomogenizedEnergy.interaction
    reach = Parameter("drive", (0.05, 1), "Field that the coercive fields lie below.", value=0.5)
    smoothness = Parameter(
        "1", (1e-9, 1e3), "Weight of the squared second differences of the weights.", scale="log", value=1e-3
    )
    poled, bias = HomogenizedEnergy.poled, HomogenizedEnergy.bias

    def count(nodes):
        return nodes

    def stands(reach, nodes, branch):
        return reach * (branch + 0.5) / nodes

    def prepare(gain, weight, interaction, reach, nodes, poled, bias, branch):
        per_width = 1 / (sqrt(2.0) * interaction)
        half = reach * (branch + 0.5) / nodes * per_width
        before = play(0.0, (poled - bias) * per_width, half)
        return gain, weight, bias, per_width, half, before

    def start(u, gain, weight, bias, per_width, half, before):
        return (play(before, (u - bias) * per_width, half),)

    def step(p, u, gain, weight, bias, per_width, half, before):
        p = play(p, (u - bias) * per_width, half)
        return p, weight * erf(p)

    def rests(p, low, high, gain, weight, bias, per_width, half, before):
        return (low - bias) * per_width >= p - half and (high - bias) * per_width <= p + half

    def output(u, total, gain, weight, bias, per_width, half, before):
        return gain * (u - bias) + total


class SharedDensity(FreeDensity):
    """The same weights and plays for all responses, such as P itself and a strain a1 (P - P_R):
    y = a1 / eta E + ratio sum_i w_i (2 Phi2(F_i[E]) - 1), the ratio that of a response to the first one."""

    weight = replace(FreeDensity.weight, each="stage")
    interaction, reach = replace(FreeDensity.interaction, each="stage"), replace(FreeDensity.reach, each="stage")
    smoothness = replace(FreeDensity.smoothness, each="stage")
    poled, bias = replace(FreeDensity.poled, each="stage"), replace(FreeDensity.bias, each="stage")
    ratio = Parameter(
        "response/first", (-3, 3), "Response to the domains over that of the first axis.", null=1, each="later axis"
    )

    def prepare(gain, weight, interaction, reach, nodes, poled, bias, ratio, branch):
        per_width = 1 / (sqrt(2.0) * interaction)
        half = reach * (branch + 0.5) / nodes * per_width
        before = play(0.0, (poled - bias) * per_width, half)
        return gain, ratio * weight, bias, per_width, half, before


class Relaxing(HomogenizedEnergy):
    """The same with plays that heat helps along. Coercive fields are those that are met at the rate of one fluctuation
    field a second; in a hold the domains go on with the logarithm of time."""

    rests = None

    def prepare(gain, remanence, coercive, spread, interaction, quadratic, poled, bias, fluctuation, branch, dt):
        per_width = 1 / (sqrt(2.0) * interaction)
        half = coercive * exp(spread * QUANTILES[int(branch)]) * per_width
        before = play(0.0, (poled - bias) * per_width, half)
        heat = relaxing(fluctuation * per_width, dt)
        return gain, remanence, quadratic, bias, per_width, half, before, *heat

    def start(u, gain, remanence, quadratic, bias, per_width, half, before, width, waited):
        field = (u - bias) * per_width
        return play(before, field, half), field

    def step(p, last, u, gain, remanence, quadratic, bias, per_width, half, before, width, waited):
        field = (u - bias) * per_width
        p = relaxed(p, last, field, half, width, waited)
        return p, field, erf(p)

    def output(u, total, gain, remanence, quadratic, bias, per_width, half, before, width, waited):
        field = u - bias + remanence * (total / NODES - 1)
        return (gain + quadratic * field) * field


HomogenizedEnergy.forms = {"free": FreeDensity, "shared": SharedDensity, "thermal_relaxation": Relaxing}
