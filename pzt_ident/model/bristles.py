"""Bristles that bend, then slide, under a spring: the LuGre law of friction, stepped implicitly."""

from pzt_ident.model.elementary import expm1, log1p


def rub(friction, pull, force, reach, stiction, fast, share):
    """Friction F after a step dx, the root of dx + share (F(dx) - F) = pull, pull being dx if F stayed as it was.

    dF/dx = (g - F sgn dx) / (reach g / force), g = force (1 + stiction exp(-(v / stribeck)^2)), v = pull / dt and
    fast = 1 / (stribeck dt). A monotone step of |dx| = d r, r = reach g / force, changes q = F sgn dx to
    g - (g - q) exp(-d), so that d is the root of d + share (g - q) / r (1 - exp(-d)) = |pull| / r.
    """
    sign = 1.0 if pull >= 0 else -1.0
    move = abs(pull)
    level = 1 + stiction * (1 + expm1(-move * fast * move * fast))
    push = move / (reach * level)
    gap = force / reach - sign * friction / (reach * level)
    slack = share * gap
    above = 1 + max(slack - push, 0.0)
    d = max(push - slack, log1p(max(min(push, slack), 0.0) / above))
    d = halley_step(halley_step(halley_step(d, slack, push), slack, push), slack, push)
    return sign * level * (force + reach * gap * -(1 + expm1(-d)))


def halley_step(d, slack, push):
    """Halley's step for d + slack (1 - exp(-d)) = push: after three the error is rounding for slack <= 1000."""
    bent = expm1(-d)
    stiff = slack * (1 + bent)
    value, slope = d - slack * bent - push, 1 + stiff
    return d - value * slope / (slope * slope + value * stiff / 2)
