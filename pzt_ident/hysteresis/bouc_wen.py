"""Bouc-Wen hysteresis driven by the voltage."""

from math import exp, inf

from pzt_ident.hysteresis._rate import FASTEST, SLOW, growth, rate_terms
from pzt_ident.model.block import Operator, Place, expm1, log1p
from pzt_ident.model.parameter import Parameter
from pzt_ident.model.registry import blocks


@blocks.register
class BoucWen(Operator):
    """y = d u - h,  dh/dt = alpha d du/dt - beta |du/dt| h - gamma du/dt |h|.

    Lin & Lin (2012), Mechatronics 22, 614, eq. 5. The state is h / (alpha d), a drive. On a monotone step of length s
    the state along the motion, q, is q(s) = q0 exp(-r s) + (1 - exp(-r s)) / r, with r = beta - gamma where q < 0 and
    r = beta + gamma where q > 0. A record begins without a memory: h = 0 at the first drive.

    Effects, each without influence at zero:
    dh/dt = alpha d (1 + rate L) du/dt + (lean + asymmetry u + skew_2 u^2 + skew_3 u^3) alpha d |du/dt| - ...
    - relaxation h,
    L = log10((|du/dt| + onset) / (100 V/s + onset)), or (10^(exponent L) - 1) / (exponent log 10), or what levels off.
    Over a step the factors on du/dt keep their value in the middle, and h relaxes after it: second order in the step,
    first order in dt * relaxation.
    """

    place = Place.OPERATOR
    wrong_way = "Bouc-Wen does so after a reversal where alpha max(1, 2 beta / (beta + gamma)) > 1"
    gain = Parameter("response/drive", (0, 3), "Displacement per drive without hysteresis, d.")
    alpha = Parameter("1", (0, 1), "Share of the prompt response that hysteresis takes back just after a rest.")
    beta = Parameter("1/drive", (0, 60), "Decay of h per drive on both branches.")
    gamma = Parameter("1/drive", (-30, 60), "Decay of h per drive, with the sign of h along the motion.")

    asymmetry = Parameter(
        "1/drive", (-2, 2), "Part of the drive term that grows with the voltage.", 0, effect="asymmetry.voltage"
    )
    lean = Parameter("1", (-0.9, 0.9), "Part of the drive term in one direction.", 0, effect="asymmetry.constant")
    rate = Parameter("1", (-0.6, 0.6), "Growth of alpha per decade of drive rate.", 0, effect="rate_dependence")
    onset = Parameter(
        "V/s", (SLOW, FASTEST), "Drive rate at which alpha begins to grow.", SLOW, "log", effect="rate_dependence.onset"
    )
    exponent = Parameter("1", (-0.5, 0.5), "Power of the drive rate.", 0, effect="rate_dependence.power")
    level = Parameter(
        "V/s", (1.0, FASTEST), "Drive rate at half of the growth.", FASTEST, "log", effect="rate_dependence.level"
    )
    skew = Parameter("1/drive", (-2, 2), "Part that grows with the voltage.", 0, effect="asymmetry.polynomial")
    skew_2 = Parameter("1/drive^2", (-4, 4), "Part that grows with its square.", 0, effect="asymmetry.polynomial")
    skew_3 = Parameter("1/drive^3", (-8, 8), "Part that grows with its cube.", 0, effect="asymmetry.polynomial")
    beta_2 = Parameter("1/drive", (-10, 10), "Decay of h by sgn(x du).", 0, effect="asymmetry.branches")
    beta_3 = Parameter("1/drive", (-10, 10), "Decay of h by sgn(x h).", 0, effect="asymmetry.branches")
    beta_4 = Parameter("1/drive", (-10, 10), "Decay of h by sgn(du).", 0, effect="asymmetry.branches")
    beta_5 = Parameter("1/drive", (-10, 10), "Decay of h by sgn(h).", 0, effect="asymmetry.branches")
    beta_6 = Parameter("1/drive", (-10, 10), "Decay of h by sgn(x).", 0, effect="asymmetry.branches")
    centre = Parameter("drive", (-1, 1), "Voltage from which x counts.", effect="asymmetry.branches")
    relaxation = Parameter("1/s", (0, 1), "Decay rate of h, 1 / tau.", 0, effect="thermal_relaxation")
    activation = Parameter(
        "1/drive", (0, 50), "One over the h at which relaxation is faster.", 0, effect="thermal_relaxation.activated"
    )

    def prepare(gain, alpha, beta, gamma):
        return (gain, alpha * gain), regime(beta + gamma), regime(beta - gamma)

    def start(u):
        return (0.0,)

    def travel(distance, rate, length):
        lost = -expm1(-rate * distance)
        return 1 - lost, lost * length

    def reach(q, rate, length):
        return log1p(-q * rate) * length if -q * rate > -1 else inf

    def output(h, u, gain, slope):
        return gain * u - slope * h

    def terms(asymmetry, lean, skew, skew_2, skew_3, rate, onset, exponent, level, relaxation, activation, dt):
        return (
            asymmetry + skew,
            lean,
            skew_2,
            skew_3,
            *rate_terms(rate, onset, exponent, level, dt),
            exp(-dt * relaxation),
            activation,
        )

    def lift(
        distance,
        u,
        sign,
        asymmetry,
        lean,
        square,
        cube,
        rate,
        faster,
        slow,
        exponent,
        root,
        per,
        share,
        keep,
        activation,
    ):
        grown = growth(distance, rate, faster, slow, exponent, root, per, share)
        lean = lean + u * (asymmetry + u * (square + u * cube))
        return max(1 + sign * lean + grown, 0.01)

    def fade(h, asymmetry, lean, square, cube, rate, faster, slow, exponent, root, per, share, keep, activation):
        return keep


class ByBranch(BoucWen):
    """dh/dt = alpha d du/dt - |h| psi du/dt, psi = gamma + beta sgn(v h) + beta_2 sgn(x v) + beta_3 sgn(x h) +
    beta_4 sgn(v) + beta_5 sgn(h) + beta_6 sgn(x), v = du/dt, x = u - centre; over a step sgn(x) is its mean.

    Song & Der Kiureghian (2006), J. Eng. Mech. 132, 610.
    """

    def prepare(gain, alpha, beta, gamma, beta_2, beta_3, beta_4, beta_5, beta_6, centre):
        shared = gain, alpha * gain, beta_2, beta_3, beta_4, beta_5, beta_6, centre
        return shared, regime(beta + gamma), regime(beta - gamma)

    def output(h, u, gain, slope, beta_2, beta_3, beta_4, beta_5, beta_6, centre):
        return gain * u - slope * h

    def quadrant(way, rate, distance, u, sign, gain, slope, beta_2, beta_3, beta_4, beta_5, beta_6, centre):
        side = max(-1.0, min(1.0, 2 * (u - centre) / (distance + 1e-300)))
        of_x_and_v, of_h = (beta_2 * side + beta_4) * sign + beta_6 * side, beta_3 * side + beta_5
        return regime(rate + way * of_x_and_v + of_h * sign)


class Activated(BoucWen):
    """dh/dt = ... - relaxation sinh(activation h) / activation: the barrier to a jump falls with h, so that h relaxes
    with the logarithm of time while it is large; over a sample tanh(activation h / 2) fades by exp(-dt relaxation).

    Eyring (1936), J. Chem. Phys. 4, 283. `activation` is one over the h at which the rate has grown by 1.2.
    """

    def fade(h, asymmetry, lean, square, cube, rate, faster, slow, exponent, root, per, share, keep, activation):
        x = min(activation * abs(h), 40.0)
        grown = expm1(x)
        left = keep * grown / (grown + 2)
        return log1p(2 * left / (1 - left)) / x if x > 1e-100 else keep


BoucWen.forms = {"asymmetry.branches": ByBranch, "thermal_relaxation.activated": Activated}


def regime(rate):
    """Rate and its inverse, the rate 1e-200 at least in magnitude."""
    rate = rate if abs(rate) > 1e-200 else 1e-200
    return rate, 1 / rate
