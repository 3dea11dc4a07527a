"""Flexure that stiffens or softens as it bends."""

from pzt_ident.block import Term, expm1, log1p
from pzt_ident.hold import oscillate
from pzt_ident.mechanics._oscillator import mode
from pzt_ident.mechanics.lumped import Lumped
from pzt_ident.registry import blocks

SOFTEST = 0.19  # the slope of the spring is then 0.43 of what it is at x = 0


class Stiffening(Lumped):
    """m x'' + b x' + k (x + c x^3) = k f: the linear oscillator under f - c x^3, linear between samples.

    x is on both sides of a step: x + (1 + b1) c x^3 = p. A soft spring is linear from c x^2 = -SOFTEST on.
    """

    def prepare(mass, damping, stiffness, load, extra_damping, cubic, dt):
        return cubic, *mode(mass + load, damping + extra_damping, stiffness, dt)

    def start(u, cubic, r11, r12, r21, r22, b1, b2):
        return 0.0, 0.0, bent(u, cubic, 1.0)

    def step(w, v, f, u, cubic, r11, r12, r21, r22, b1, b2):
        x = bent(u + r11 * w + r12 * v + b1 * (u - f), cubic, 1 + b1)
        now = u - x * max(cubic * x * x, -SOFTEST)
        w, v = oscillate(w, v, now - f, r11, r12, r21, r22, b1, b2)
        return w, v, now, now + w


@blocks.register
class CubicStiffness(Term):
    """Flexure leaves also stretch as they bend: k x <- k (x + c x^3), c = k3 / k, in the equation of the mechanics.

    Awtar & Slocum (2007), J. Mech. Des. 129, 625. The resonance goes up with the bias: df / f = (3/2) c x0^2.
    """

    forms = {"lumped": Stiffening}
    sizes = tuple(0.005 * 1.5**k for k in range(12))
    looks_like = ("quadratic_gain", "saturation", "encoder_cyclic_error")
    separate_by = "Load the stage with a known force or change its preload, or measure the resonance at several biases."
    remedy = "Work on a smaller part of the range, or put the identified curve into the calibration or feedforward."


def bent(p, c, share):
    """x of x + share c x^3 = p, by s = x / p, s + z s^3 = 1, from (1 + 3 z)^(-1/3)."""
    most = share * SOFTEST
    z = max(share * c * p * p, -most * (1 - most) * (1 - most))
    return p * closer(closer(closer(1 + expm1(log1p(3 * z) / -3), z), z), z)


def closer(s, z):
    """Halley's step for s + z s^3 - 1 = 0: after three the error is of rounding for all z >= -1/8."""
    miss, slope = s + z * s * s * s - 1, 1 + 3 * z * s * s
    return s - miss * slope / (slope * slope - 3 * z * s * miss)
