"""Dry friction in the guide."""

from pzt_ident.model.block import Block, Place, expm1, log1p
from pzt_ident.model.parameter import Parameter
from pzt_ident.model.registry import blocks


@blocks.register
class Friction(Block):
    """Bristles of the guide bend, then slide (LuGre): x + F = f,  dF/dx = (g - F sgn dx/dt) / (reach g / force),
    g = force (1 + stiction exp(-(v / stribeck)^2)).

    Canudas de Wit, Olsson, Astrom & Lischinsky (1995), IEEE Trans. Autom. Control 40, 419, eq. 2 to 5, with no friction
    that grows with speed; without stiction Dahl (1976), AIAA J. 14, 1675. F is the friction over the stiffness, F = 0
    at the start; v is the speed that the force asks for, which is that of the stage once it slides. A monotone step
    over |dx| = d turns q = F sgn dx into g - (g - q) exp(-d / r), r = reach g / force, so that d is the root of
    d + (g - q) (1 - exp(-d / r)) = |df|, found by Halley's method.
    """

    place = Place.GUIDE
    sizes = (0.02, 0.1, 0.5)
    trials = {"stribeck": 1}
    force = Parameter("response", (0, 0.1), "Sliding friction over the stiffness.", null=0)
    reach = Parameter("response", (1e-3, 0.5), "Displacement over which friction builds up.", scale="log")
    stiction = Parameter("1", (0, 0.5), "What break-away takes above sliding friction, as a share of it.", null=0)
    stribeck = Parameter("response/s", (1e-3, 100), "Speed at which the bristles let go.", scale="log")
    look_alikes = ("distributed_memory", "delay", "amplifier_lag")
    separate_by = "Hold the voltage and push the stage by an external force or another axis: only friction has a loop."
    remedy = "Free cables and guides, lubricate or change the preload, drive turning points slower or close the loop."

    def prepare(force, reach, stiction, stribeck, dt):
        return force, reach, stiction, 1 / (stribeck * dt)

    def start(u, force, reach, stiction, fast):
        return 0.0, u

    def step(friction, before, u, force, reach, stiction, fast):
        sign = 1.0 if u >= before else -1.0
        move = abs(u - before)
        level = 1 + stiction * (1 + expm1(-move * fast * move * fast))
        push = move / (reach * level)
        slack = force / reach - sign * friction / (reach * level)
        above = 1 + max(slack - push, 0.0)
        d = max(push - slack, log1p(max(min(push, slack), 0.0) / above))
        d = closer(closer(closer(d, slack, push), slack, push), slack, push)
        friction = sign * level * (force + reach * slack * -(1 + expm1(-d)))
        return friction, u, u - friction


def closer(d, slack, push):
    """Halley's step for d + slack (1 - exp(-d)) = push: after three the error is of rounding for slack <= 1000."""
    bent = expm1(-d)
    stiff = slack * (1 + bent)
    miss, slope = d - slack * bent - push, 1 + stiff
    return d - miss * slope / (slope * slope + miss * stiff / 2)
