"""The homogenized energy model without thermal activation, as plays with a nonlinear readout."""

from dataclasses import replace
from math import exp, sqrt
from statistics import NormalDist

from pzt_ident.errors import InputError
from pzt_ident.hysteresis._play import (
    play,
    play_limits,
    play_rides,
    relaxation_coefficients,
    relaxed_play,
    relaxed_rests,
)
from pzt_ident.model.block import Bank, Place, erf
from pzt_ident.model.parameter import Form, Parameter, Setting
from pzt_ident.model.registry import blocks

NODES, WIDER = 64, 1.5  # coercive fields; times the spread of the density, over which they are placed
PLACES = tuple(WIDER * NormalDist().inv_cdf((i + 0.5) / NODES) for i in range(NODES))
DENSITIES = [NormalDist().pdf(z) / NormalDist(0, WIDER).pdf(z) for z in PLACES]
SHARES = tuple(density / sum(DENSITIES) for density in DENSITIES)


def refuse_negative_spread(block):
    """The `refuse` of a block with the parameter `spread`, a standard deviation."""

    def refuse(least, most):
        if least.spread < 0:
            remedy = "give a value or lower bound of zero or more"
            message = f"a standard deviation of {least.spread:g} is below zero"
            raise InputError(message, where=f"{block}.spread", remedy=remedy)

    return refuse


def rest(gain, remanence, coercive, spread, interaction, quadratic, poled, bias):
    """y at zero drive, of a material that is virgin or was `poled`."""
    per_width, total = 1 / (sqrt(2.0) * interaction), 0.0
    for i in range(NODES):
        half = coercive * exp(spread * PLACES[i]) * per_width
        total += SHARES[i] * erf(play(play(0.0, (poled - bias) * per_width, half), -bias * per_width, half))
    field = remanence * (total - 1) - bias
    return (gain + quadratic * field) * field


@blocks.register
class HomogenizedEnergy(Bank):
    """y = a1 (P - P_R) + a2 (P - P_R)^2,  P = E / eta + P_R int nu1(Ec) (2 Phi2(F_Ec[E]) - 1) dEc.

    Smith et al., Model Development for Atomic Force Microscope Stage Mechanisms, eqs. 7, 12 and 15, with u for E. The
    density of the coercive fields, nu1, is lognormal, that of the interaction fields, nu2, normal: a Preisach operator
    whose density is their product. Of one coercive field the domains with an interaction field above -F_Ec point up,
    F_Ec the play p <- max(E - Ec, min(E + Ec, p)) (Krasnosel'skii & Pokrovskii 1989), which is exact in the interaction
    field. There are 64 coercive fields, coercive exp(1.5 spread q_i) with the quantiles q_i = (i + 1/2) / 64 of the
    standard normal, and each has the share of the domains that is the density there over that of the places: in the
    tail, where those of equal probability are far apart, they are closer. The polarization is computed as the field
    eta P.

    E is the drive minus the bias. A record begins virgin at zero field, from where it goes to `poled`, then to the
    first drive.
    Responses of different kinds, such as P itself and a displacement, may share all parameters but gain and quadratic.
    Ahead of what is nonlinear in the displacement y is counted from that at rest, in which a flexure is not bent.
    """

    place = Place.OPERATOR
    density = Form(
        "lognormal",
        ("lognormal", "free", "shared"),
        "Density of the coercive fields; `free`: a weight for each, `shared`: the same weights for all responses.",
    )
    compared_with_drive = ("coercive",)
    branches = NODES
    gain = Parameter("response/drive", (0, 3), "Response per field of a domain that does not switch, a1 / eta.")
    remanence = Parameter("drive", (0.05, 10), "Remanent polarization of a domain as the field eta P_R.", scale="log")
    coercive = Parameter("drive", (0.005, 5), "Median of the coercive fields.", scale="log")
    spread = Parameter("1", (0.1, 2), "Standard deviation of the logarithm of the coercive field.")
    interaction = Parameter("drive", (0.01, 5), "Standard deviation of the interaction field.", scale="log")
    quadratic = Parameter("response/drive^2", (-3, 3), "Response per square of the field, a2 / eta^2.", value=0)
    poled = Parameter("drive", (-3, 3), "Field that the material was poled at before, 0 if it is virgin.", value=0)
    bias = Parameter("drive", (-0.5, 0.5), "Part of the drive that is not a field in the material.", value=0)
    fluctuation = Parameter(
        "drive",
        (0, 0.1),
        "Growth of the coercive fields for a rate higher by a factor of e.",
        null=0,
        effect="thermal_relaxation",
    )

    refuse = refuse_negative_spread("homogenized_energy")

    def prepare(gain, remanence, coercive, spread, interaction, quadratic, poled, bias, branch, from_rest):
        counted = from_rest * (branch == 0)  # the first branch gives `output` its coefficients
        zero = rest(gain, remanence, coercive, spread, interaction, quadratic, poled, bias) if counted else 0.0
        per_width = 1 / (sqrt(2.0) * interaction)
        half = coercive * exp(spread * PLACES[int(branch)]) * per_width
        before = play(0.0, (poled - bias) * per_width, half)
        return gain, remanence, quadratic, bias, zero, per_width, half, before, SHARES[int(branch)]

    def start(u, gain, remanence, quadratic, bias, zero, per_width, half, before, share):
        return (play(before, (u - bias) * per_width, half),)

    def step(p, u, gain, remanence, quadratic, bias, zero, per_width, half, before, share):
        p = play(p, (u - bias) * per_width, half)
        return p, share * erf(p)

    def rests(p, low, high, gain, remanence, quadratic, bias, zero, per_width, half, before, share):
        return (low - bias) * per_width >= p - half and (high - bias) * per_width <= p + half

    def rides(p, first, last, back, gain, remanence, quadratic, bias, zero, per_width, half, before, share):
        return play_rides(p, (first - bias) * per_width, (last - bias) * per_width, back * per_width, half)

    def limits(p, low, high, gain, remanence, quadratic, bias, zero, per_width, half, before, share):
        return play_limits(p, (low - bias) * per_width, (high - bias) * per_width, half)

    def read(p, gain, remanence, quadratic, bias, zero, per_width, half, before, share):
        return share * erf(p)

    def bend(gain, remanence, quadratic, bias, zero, per_width, half, before, share):
        return 1 / per_width

    def output(u, total, gain, remanence, quadratic, bias, zero, per_width, half, before, share):
        field = u - bias + remanence * (total - 1)
        return (gain + quadratic * field) * field - zero


class FreeDensity(Bank):
    """y = a1 / eta E + sum_i w_i (2 Phi2(F_i[E]) - 1),  F_i the play of half-width Ec_i = reach (i - 1/2) / nodes.

    Smith et al., eqs. 12 and 15, with a2 = 0 and the weights w_i = a1 P_R nu1(Ec_i) reach / nodes instead of a
    lognormal nu1. The plays do not depend on the weights: gain and weights are solved for by non-negative least
    squares inside the search over the interaction field, with their squared second differences as a smoothness prior.
    """

    place = Place.OPERATOR
    density = HomogenizedEnergy.density
    nodes = Setting(
        22, (4, 128), "Number of coercive fields, each in the middle of one of as many equal parts of 0 to `reach`."
    )  # with gain and none one group of lanes
    compared_with_drive = ("reach",)
    gain = Parameter("response/drive", (0, 3), HomogenizedEnergy.gain.doc, linear=True)
    weight = Parameter(
        "response", (0, 1), "Half of the response to switching all domains of one coercive field.",
        count="nodes", linear=True, smooth="smoothness",
    )  # fmt: skip
    interaction = HomogenizedEnergy.interaction
    reach = Parameter("drive", (0.05, 1), "Upper limit of the coercive fields.", value=0.5)
    smoothness = Parameter(
        "1",
        (1e-9, 1e3),
        "How much the squared second differences of the weights count beside the squared errors, each weight as the "
        "response that it makes in the median.",
        scale="log",
        value=1e-3,
    )
    poled, bias = HomogenizedEnergy.poled, HomogenizedEnergy.bias

    def count(nodes):
        return nodes

    def threshold(reach, nodes, branch):
        return reach * (branch + 0.5) / nodes

    def prepare(gain, weight, interaction, reach, nodes, poled, bias, branch, from_rest):
        per_width = 1 / (sqrt(2.0) * interaction)
        half = reach * (branch + 0.5) / nodes * per_width
        before = play(0.0, (poled - bias) * per_width, half)
        zero = from_rest * erf(play(before, -bias * per_width, half))
        return gain, weight, bias, (1 - from_rest) * gain * bias, zero, per_width, half, before

    def start(u, gain, weight, bias, below, zero, per_width, half, before):
        return (play(before, (u - bias) * per_width, half),)

    def step(p, u, gain, weight, bias, below, zero, per_width, half, before):
        p = play(p, (u - bias) * per_width, half)
        return p, weight * (erf(p) - zero)

    def rests(p, low, high, gain, weight, bias, below, zero, per_width, half, before):
        return (low - bias) * per_width >= p - half and (high - bias) * per_width <= p + half

    def rides(p, first, last, back, gain, weight, bias, below, zero, per_width, half, before):
        return play_rides(p, (first - bias) * per_width, (last - bias) * per_width, back * per_width, half)

    def limits(p, low, high, gain, weight, bias, below, zero, per_width, half, before):
        return play_limits(p, (low - bias) * per_width, (high - bias) * per_width, half)

    def read(p, gain, weight, bias, below, zero, per_width, half, before):
        return weight * (erf(p) - zero)

    def bend(gain, weight, bias, below, zero, per_width, half, before):
        return 1 / per_width

    def output(u, total, gain, weight, bias, below, zero, per_width, half, before):
        return gain * u - below + total


class SharedDensity(FreeDensity):
    """The same weights and plays for all responses, such as P itself and a strain a1 (P - P_R):
    y = a1 / eta E + ratio sum_i w_i (2 Phi2(F_i[E]) - 1), with the ratio of each response to the first one."""

    weight = replace(FreeDensity.weight, per="stage")
    interaction, reach = replace(FreeDensity.interaction, per="stage"), replace(FreeDensity.reach, per="stage")
    smoothness = replace(FreeDensity.smoothness, per="stage")
    poled, bias = replace(FreeDensity.poled, per="stage"), replace(FreeDensity.bias, per="stage")
    ratio = Parameter(
        "response/first", (-3, 3), "Response to the domains over that of the first axis.", null=1, per="later axis"
    )

    def prepare(gain, weight, interaction, reach, nodes, poled, bias, ratio, branch, from_rest):
        per_width = 1 / (sqrt(2.0) * interaction)
        half = reach * (branch + 0.5) / nodes * per_width
        before = play(0.0, (poled - bias) * per_width, half)
        zero = from_rest * erf(play(before, -bias * per_width, half))
        return gain, ratio * weight, bias, (1 - from_rest) * gain * bias, zero, per_width, half, before


class Relaxing(HomogenizedEnergy):
    """The model with thermally activated plays (`relaxed_play`). The coercive fields are those at a field rate of one
    fluctuation field per second; in a hold the polarization goes on with the logarithm of time."""

    rides = limits = read = bend = None

    def prepare(
        gain, remanence, coercive, spread, interaction, quadratic, poled, bias, fluctuation, branch, dt, from_rest
    ):
        counted = from_rest * (branch == 0)
        zero = rest(gain, remanence, coercive, spread, interaction, quadratic, poled, bias) if counted else 0.0
        per_width = 1 / (sqrt(2.0) * interaction)
        half = coercive * exp(spread * PLACES[int(branch)]) * per_width
        before = play(0.0, (poled - bias) * per_width, half)
        heat = relaxation_coefficients(fluctuation * per_width, dt)
        return gain, remanence, quadratic, bias, zero, per_width, half, before, SHARES[int(branch)], *heat

    def start(u, gain, remanence, quadratic, bias, zero, per_width, half, before, share, width, width_log_dt, per_heat):
        field = (u - bias) * per_width
        return play(before, field, half), field

    def step(
        p,
        last,
        u,
        gain,
        remanence,
        quadratic,
        bias,
        zero,
        per_width,
        half,
        before,
        share,
        width,
        width_log_dt,
        per_heat,
    ):
        field = (u - bias) * per_width
        p = relaxed_play(p, last, field, half, width, width_log_dt, per_heat)
        return p, field, share * erf(p)

    def rests(
        p,
        last,
        low,
        high,
        gain,
        remanence,
        quadratic,
        bias,
        zero,
        per_width,
        half,
        before,
        share,
        width,
        width_log_dt,
        per_heat,
    ):
        least, most = min(last, (low - bias) * per_width), max(last, (high - bias) * per_width)
        return relaxed_rests(p, least, most, half, width, width_log_dt)

    def output(
        u, total, gain, remanence, quadratic, bias, zero, per_width, half, before, share, width, width_log_dt, per_heat
    ):
        field = u - bias + remanence * (total - 1)
        return (gain + quadratic * field) * field - zero


HomogenizedEnergy.forms = {"free": FreeDensity, "shared": SharedDensity, "thermal_relaxation": Relaxing}
