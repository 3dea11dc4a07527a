"""The homogenized energy model with thermal activation: loops depend on the rate, and the response creeps."""

from math import erf, erfc, exp, expm1, log, pi, sqrt

from pzt_ident.hysteresis._play import play
from pzt_ident.hysteresis.homogenized_energy import HomogenizedEnergy, refuse_negative_spread, rest
from pzt_ident.model.block import Place, Relays
from pzt_ident.model.parameter import Parameter
from pzt_ident.model.registry import blocks

COERCIVES, INTERACTIONS, COLUMNS = Relays.coercives, Relays.interactions, Relays.columns
SHELL = 0.1  # width of the shell about the inflection point from which domains switch, over the thermal width s


@blocks.register
class ThermalHomogenizedEnergy(Relays):
    """y = a1 (P - P_R) + a2 (P - P_R)^2,  P = int int nu1(Ec) nu2(EI) (x P_up + (1 - x) P_down) dEI dEc,
    dx/dt = r_up (1 - x) - r_down x.

    Smith et al., Model Development for Atomic Force Microscope Stage Mechanisms, eqs. 8 to 12 and 15: x, P_up and
    r_down are x+, <P+> and p+- there. With the thermal width s = 1 / sqrt(B eta), B = V / kT, and with
    a = -(E + EI + Ec) / (eta s), g(a) = sqrt(2 / pi) / erfcx(a / sqrt(2)), the polarization of a domain that points up
    is P_up = P_R + (E + EI) / eta + s g(a), and the rate at which it leaves r_down = (1 / T) N / (N + s / g(a)), N the
    integral of the Boltzmann density over a shell of 0.1 s behind the inflection point. The energy is approximated as
    linear over the shell, a relative error of r_down of (0.1)^2 / 6 Ec / (eta P_R - Ec). P_down and r_up are the mirror
    images. There are 64 lognormal coercive fields of equal probability below eta P_R; beyond it a domain has no
    inflection point, and its mass is left out. The spacing of the interaction fields is an eighth of their standard
    deviation. Rest, where y is counted from it, is that without thermal activation. For loops and for larger steps its
    error is small (4 % of the creep); creep after a step of a thirtieth of the standard deviation is off by about 8 %,
    after a hundredth by 20 to 30 %. A record begins virgin at zero field, from where it goes to `poled`, then to the
    first drive, without thermal activation.
    """

    place = Place.OPERATOR
    compared_with_drive = ("coercive",)
    gain, remanence = HomogenizedEnergy.gain, HomogenizedEnergy.remanence
    coercive, spread, interaction = HomogenizedEnergy.coercive, HomogenizedEnergy.spread, HomogenizedEnergy.interaction
    thermal = Parameter(
        "1", (0.002, 0.1), "Thermal width of the polarization over its remanence, s / P_R.", scale="log"
    )
    dwell = Parameter("s", (1e-6, 1), "Time constant of a domain without a barrier, T.", scale="log")
    quadratic, poled, bias = HomogenizedEnergy.quadratic, HomogenizedEnergy.poled, HomogenizedEnergy.bias

    refuse = refuse_negative_spread("thermal_homogenized_energy")

    def prepare(
        gain, remanence, coercive, spread, interaction, thermal, dwell, quadratic, poled, bias, dt, peak, from_rest
    ):
        least = 2 * (peak + abs(bias) + remanence) / (COLUMNS - INTERACTIONS)
        spacing = max(8 * interaction / INTERACTIONS, least)
        below = normal(log(remanence / coercive) / spread)
        shape = spacing, coercive, spread, below, interaction, poled - bias, bias
        zero = rest(gain, remanence, coercive, spread, interaction, quadratic, poled, bias) if from_rest else 0.0
        return shape, (remanence, thermal * remanence, dwell, dt), (gain, remanence, quadratic, bias, zero)

    def field(u, spacing, coercive, spread, below, interaction, poled, bias):
        return u - bias

    def coercive_field(i, spacing, coercive, spread, below, interaction, poled, bias):
        return coercive * exp(spread * quantile((i + 0.5) / COERCIVES * below))

    def mass(low, high, spacing, coercive, spread, below, interaction, poled, bias):
        covered = erf(INTERACTIONS * spacing / (2 * sqrt(2.0) * interaction))
        return below * (normal(high / interaction) - normal(low / interaction)) / covered

    def start(field, half, low, high, spacing, coercive, spread, below, interaction, poled, bias):
        return min(max((high + play(play(0.0, poled, half), field, half)) / (high - low), 0.0), 1.0)

    def leave(further, remanence, width, dwell, dt):
        ahead = further / width
        hazard = sqrt(2 / pi) / erfcx(-ahead / sqrt(2.0))
        odds = SHELL * hazard * shell(SHELL * ahead)
        rate = max(odds / (1 + odds) / dwell, 1e-300)
        return rate, exp(-rate * dt), remanence + width * hazard

    def output(u, total, gain, remanence, quadratic, bias, zero):
        field = u - bias + total - remanence
        return (gain + quadratic * field) * field - zero


def normal(z):
    """Phi, the standard normal distribution function."""
    return 0.5 * (1 + erf(z / sqrt(2.0)))


def quantile(p):
    """Inverse of Phi by Newton's method; steps from 0 do not overshoot, since Phi is concave above, convex below."""
    z = 0.0
    for _ in range(16):
        z += min(max((p - normal(z)) * sqrt(2 * pi) * exp(0.5 * z * z), -2.0), 2.0)
    return z


def erfcx(y):
    """Scaled complementary error function exp(y^2) erfc(y), relative error 3e-12."""
    if y > 20:
        v = 0.5 / (y * y)
        return (1 - v * (1 - 3 * v * (1 - 5 * v * (1 - 7 * v)))) / (sqrt(pi) * y)
    y = max(y, -26.0)
    return exp(y * y) * erfc(y)


def shell(v):
    """(1 - exp(-v)) / v: mean Boltzmann factor over the shell, in which the energy falls linearly by v."""
    v = max(v, -600.0)
    return -expm1(-v) / v if abs(v) > 1e-9 else 1.0
