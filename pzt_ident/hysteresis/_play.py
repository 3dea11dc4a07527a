"""The play operator, without and with thermal activation."""

import math

from pzt_ident.model.block import expm1, log

FROZEN = 45.0  # fluctuation fields short of both edges: in a sample p moves by 3e-20 of one
BEYOND = 80.0  # fluctuation fields beyond an edge: from farther away it is reached in one sample


def play(p, u, half):
    """p <- max(u - r, min(u + r, p)), half = r: Krasnosel'skii & Pokrovskii (1989), Systems with Hysteresis."""
    return max(u - half, min(u + half, p))


def play_rides(p, first, last, back, half):
    """Whether p is on one edge of `play` from the first input on, however far it goes to the last and, on the way, back
    by `back` at most: it follows the farthest input so far."""
    on_edge = p <= first - half if last >= first else p >= first + half
    return on_edge & (back <= 2 * half)


def play_limits(p, low, high, half):
    """Between which values p stays for inputs between low and high."""
    return min(p, low + half), max(p, high - half)


def relaxation_coefficients(width, dt):
    """Fluctuation field f, f log(dt / 1 s) and 1 / f, the last arguments of `relaxed_play`; f is 1e-30 at least."""
    width = width if width > 1e-30 else 1e-30
    return width, width * math.log(dt), 1 / width


def relaxed_play(p, before, u, half, width, width_log_dt, per_width):
    """The play with thermal activation after a sample in which its input goes linearly from `before` to u:
    dp/dt = (f / 1 s) (exp((u - p - r) / f) - exp((p - u - r) / f)), r = half, f = width the fluctuation field.

    Bertotti (1998), Hysteresis in Magnetism, ch. 14. Each exponential alone is linear in exp(p / f), so a sample is a
    soft minimum at the upper edge, p <- p - f log(1 + X), and then a soft maximum at the lower, which together are
    p <- p + f log(1 / (1 + X) + Y): exact, apart from exp(-2 r / f), for any division into samples; X is `above`, Y
    `below`. In a hold p goes on with the logarithm of time. The half-width is r at an input rate of f per second, and
    r + f log(v 1 s / f) at a rate v. For f -> 0 the soft maximum is the maximum, and this is the play."""
    sign = 1.0 if u >= before else -1.0
    moved = min(max(abs(u - before) * per_width, 1e-12), 1e15)
    share = -expm1(-moved) / moved  # mean over the sample of what is 1 where it is nearest to the edge
    reach = half - width_log_dt
    upper, lower = sign * before + reach, sign * u - reach
    p = max(min(sign * p, upper + BEYOND * width), lower - BEYOND * width)
    above = share * (1 + expm1((p - upper) * per_width))
    below = share * (1 + expm1((lower - p) * per_width))
    return sign * (p + width * log(1 / (1 + above) + below))


def relaxed_rests(p, low, high, half, width, width_log_dt):
    """Whether `relaxed_play` keeps p to rounding for a thousand samples, while its input is between low and high."""
    reach = half - width_log_dt - FROZEN * width
    return high - p <= reach and p - low <= reach
