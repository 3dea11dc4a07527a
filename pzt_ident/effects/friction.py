"""Dry friction in the guide."""

from pzt_ident.block import Block, Place, expm1, log1p
from pzt_ident.parameter import Parameter
from pzt_ident.registry import blocks


@blocks.register
class Friction(Block):
    """Bristles of the guide bend, then slide (Dahl): x + F = f,  dF/dx = (force - F sgn dx/dt) / reach.

    Dahl (1976), AIAA J. 14, 1675; F is the friction over the stiffness, F = 0 at the start. A monotone step over
    |dx| = d turns q = F sgn dx into force - (force - q) exp(-d / reach), so that d is the root of
    d + (force - q) (1 - exp(-d / reach)) = |df|, found by Halley's method.
    """

    place = Place.GUIDE
    sizes = (0.02, 0.1, 0.5)
    force = Parameter("response", (0, 0.1), "Sliding friction over the stiffness.", null=0)
    reach = Parameter("response", (1e-3, 0.5), "Displacement over which friction builds up.", scale="log")
    looks_like = ("distributed_memory", "delay", "amplifier_lag")
    separate_by = "Hold the voltage and push the stage by an external force or another axis: only friction has a loop."
    remedy = "Free cables and guides, lubricate or change the preload, drive turning points slower or close the loop."

    def prepare(force, reach):
        return force / reach, reach

    def start(u, force, reach):
        return 0.0, u

    def step(friction, before, u, force, reach):
        sign = 1.0 if u >= before else -1.0
        push = abs(u - before) / reach
        slack = force - sign * friction
        above = 1 + max(slack - push, 0.0)
        d = max(push - slack, log1p(min(push, slack) / above))
        d = closer(closer(closer(d, slack, push), slack, push), slack, push)
        friction = sign * (force + slack * -(1 + expm1(-d)))
        return friction, u, u - friction * reach


def closer(d, slack, push):
    """Halley's step for d + slack (1 - exp(-d)) = push: after three the error is of rounding for slack <= 1000."""
    bent = expm1(-d)
    stiff = slack * (1 + bent)
    miss, slope = d - slack * bent - push, 1 + stiff
    return d - miss * slope / (slope * slope + miss * stiff / 2)
