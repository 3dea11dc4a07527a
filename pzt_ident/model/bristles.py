"""Laws of friction under a spring, stepped implicitly: bristles that bend, then slide (LuGre), Coulomb's, and elements
that stretch, then slip (Maxwell)."""

from pzt_ident.model.elementary import expm1, log1p, rough_log

TINY = 1e-300  # a friction of nothing has no stiffness
PLAY = "a play, as a backlash between stage and sensor is"  # friction that does not give before it slides


def bend(friction, pull, level, per_reach):
    """Friction F after bristles were pulled: F <- s + (F - s) exp(-|pull| / reach), s = level sgn pull: Dahl (1976)."""
    slid = level if pull >= 0 else -level
    return friction - (slid - friction) * expm1(-abs(pull) * per_reach)


def rub(friction, pull, force, reach, stiction, fast, share):
    """Friction F after a step dx, the root of dx + share (F(dx) - F) = pull, pull being dx if F stayed as it was.

    dF/dx = (g - F sgn dx) / (reach g / force), g = force (1 + stiction exp(-(v / stribeck)^2)), v = pull / dt and
    fast = 1 / (stribeck dt). A monotone step of |dx| = d r, r = reach g / force, changes q = F sgn dx to
    g - (g - q) exp(-d), so that d is the root of d + share (g - q) / r (1 - exp(-d)) = |pull| / r.
    """
    sign = 1.0 if pull >= 0 else -1.0
    move = abs(pull)
    level = 1 + stiction * (1 + expm1(-move * fast * move * fast))
    per = 1 / (reach * level)
    push = move * per
    gap = force / reach - sign * friction * per
    return sign * level * (force - reach * gap * left(push, share * gap))


def bend_and_slide(friction, pull, force, reach, stiction, elastic, fast, share):
    """The same with bristles that only bend up to a share `elastic` of g: dF/dx = force / reach as long as F sgn dx is
    less, beyond it force / reach (g - F sgn dx) / (g - elastic g)."""
    sign = 1.0 if pull >= 0 else -1.0
    move = abs(pull)
    most = force * (1 + stiction * (1 + expm1(-move * fast * move * fast)))
    stiff = force / reach
    line = min(move, max(elastic * most - sign * friction, 0.0) * (1 + share * stiff) / max(stiff, TINY))
    bent = sign * friction + stiff * line / (1 + share * stiff)
    per = stiff / max((1 - elastic) * most, TINY)
    gap = most - bent
    return sign * (most - gap * left((move - line) * per, share * gap * per))


def left(push, slack):
    """exp(-d) at the root of d + slack (1 - exp(-d)) = push."""
    above = 1 + max(slack - push, 0.0)
    d = max(push - slack, rough_log(1 + max(min(push, slack), 0.0) / above))
    d += halley_step(d, expm1(-d), slack, push)
    d += halley_step(d, expm1(-d), slack, push)
    bent = expm1(-d)
    last = halley_step(d, bent, slack, push)
    return (1 + bent) * (1 - last * (1 - last / 2))


def halley_step(d, bent, slack, push):
    """Halley's step for d + slack (1 - exp(-d)) = push, bent = exp(-d) - 1: for 0 <= slack <= 1000 the third is below
    3e-6, and the error that it leaves is rounding."""
    stiff = slack * (1 + bent)
    value, slope = d - slack * bent - push, 1 + stiff
    return -value * slope / (slope * slope + value * stiff / 2)


def slide(load, pull):
    """tanh(y) at the root of y + load tanh(y) = pull: Coulomb's law over the speed y, in units of its smoothing."""
    push = abs(pull)
    y = max(push - load, log1p(2 * min(push, load) / (1 + max(load - push, 0.0))) / 2)
    y = coulomb_step(coulomb_step(coulomb_step(y, load, push), load, push), load, push)
    return tanh(y) if pull >= 0 else -tanh(y)


def coulomb_step(y, load, push):
    """Halley's step for y + load tanh(y) = push, its terms times powers of b = 2 - g, g = 1 - exp(-2 y), so that
    tanh(y) = g / b needs no division: after three the error is rounding for load <= 1000."""
    grown = -expm1(-2 * y)
    base = 2 - grown
    stiff = 4 * load * (1 - grown)
    value, slope = base * (y - push) + load * grown, base * base + stiff
    return y - value * slope * base / (slope * slope + value * stiff * grown)


def tanh(y):
    grown = expm1(2 * min(y, 20.0))
    return grown / (grown + 2)


def stretched(pull, a, b, c, d, ka, kb, kc, kd, most, share):
    """Forces of four elements of these stiffnesses, which slip at the force `most`, after a step dx, the root of
    dx + share (F(dx) - F) = pull."""
    sign = 1.0 if pull >= 0 else -1.0
    a, b, c, d = sign * a, sign * b, sign * c, sign * d
    dx = stretch(abs(pull), a, b, c, d, ka, kb, kc, kd, most, share)
    a, b, c, d = min(a + ka * dx, most), min(b + kb * dx, most), min(c + kc * dx, most), min(d + kd * dx, most)
    return sign * a, sign * b, sign * c, sign * d


def stretch(pull, a, b, c, d, ka, kb, kc, kd, most, share):
    """|dx| of the root of dx + share (F(dx) - F) = pull, F the sum of four elements of these stiffnesses, which follow
    dx up to the force `most` of each. a to d are their forces along the pull: F rises ever less steeply, so that each
    step from below passes a slip or is the root.
    """
    push = pull + share * (a + b + c + d)
    x = stretch_step(0.0, push, a, b, c, d, ka, kb, kc, kd, most, share)
    for _ in range(4):
        x = stretch_step(x, push, a, b, c, d, ka, kb, kc, kd, most, share)
    return x


def stretch_step(x, push, a, b, c, d, ka, kb, kc, kd, most, share):
    """Newton's step for x + share F(x) = push."""
    held = min(a + ka * x, most) + min(b + kb * x, most) + min(c + kc * x, most) + min(d + kd * x, most)
    stiff = (
        (ka if a + ka * x < most else 0.0)
        + (kb if b + kb * x < most else 0.0)
        + (kc if c + kc * x < most else 0.0)
        + (kd if d + kd * x < most else 0.0)
    )
    return x + (push - x - share * held) / (1 + share * stiff)
