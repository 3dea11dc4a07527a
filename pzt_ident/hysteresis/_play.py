"""The play, and the play whose domains are helped over their barriers by heat."""

from math import log

from pzt_ident.model.block import expm1, log1p


def play(p, u, half):
    """p <- max(u - r, min(u + r, p)), r the half-width: Krasnosel'skii & Pokrovskii (1989), Systems with Hysteresis."""
    return max(u - half, min(u + half, p))


def relaxing(width, dt):
    """What `relaxed` takes of the fluctuation field and the sample time: the field, and the field times log(dt / 1 s).

    A field of zero is taken as one too small to matter."""
    width = width if width > 1e-30 else 1e-30
    return width, width * log(dt)


def relaxed(p, before, u, half, width, waited):
    """The play of half-width r after a sample in which u goes from `before` to u in a straight line, with
    dp/dt = (f / 1 s) (exp((u - p - r) / f) - exp((p - u - r) / f)), f the fluctuation field `width`.

    Each exponential alone is linear in exp(p / f), so a sample is a soft minimum at its one edge and then a soft
    maximum at the other: exact however it is divided, but for exp(-2 r / f). In a hold p goes on with the logarithm of
    time, and r is met at a rate of f per second: at another rate v it is r + f log(v 1 s / f). Bertotti (1998),
    Hysteresis in Magnetism, chapter 14. As f goes to zero the soft maximum is the maximum, and this the play."""
    way = 1.0 if u >= before else -1.0
    moved = min(max(abs(u - before) / width, 1e-12), 1e15)
    reach = half - waited - width * log1p(-expm1(-moved) / moved - 1)
    p = -softer(-way * p, -way * before - reach, width)
    return way * softer(p, way * u - reach, width)


def softer(a, b, width):
    """f log(exp(a / f) + exp(b / f))."""
    return max(a, b) + width * log1p(1 + expm1(-abs(a - b) / width))
