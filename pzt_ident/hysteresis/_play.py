"""The play operator, without and with thermal activation."""

from math import log

from pzt_ident.model.block import expm1, log1p


def play(p, u, half):
    """p <- max(u - r, min(u + r, p)), half = r: Krasnosel'skii & Pokrovskii (1989), Systems with Hysteresis."""
    return max(u - half, min(u + half, p))


def relaxation_coefficients(width, dt):
    """Fluctuation field f and f log(dt / 1 s), the last arguments of `relaxed_play`; f is 1e-30 at least."""
    width = width if width > 1e-30 else 1e-30
    return width, width * log(dt)


def relaxed_play(p, before, u, half, width, width_log_dt):
    """The play with thermal activation after a sample in which its input goes linearly from `before` to u:
    dp/dt = (f / 1 s) (exp((u - p - r) / f) - exp((p - u - r) / f)), r = half, f = width the fluctuation field.

    Bertotti (1998), Hysteresis in Magnetism, ch. 14. Each exponential alone is linear in exp(p / f), so a sample is a
    soft minimum at one edge and then a soft maximum at the other: exact, apart from exp(-2 r / f), for any division
    into samples. In a hold p goes on with the logarithm of time. The half-width is r at an input rate of f per second,
    and r + f log(v 1 s / f) at a rate v. For f -> 0 the soft maximum is the maximum, and this is the play."""
    sign = 1.0 if u >= before else -1.0
    moved = min(max(abs(u - before) / width, 1e-12), 1e15)
    reach = half - width_log_dt - width * log1p(-expm1(-moved) / moved - 1)
    p = -soft_maximum(-sign * p, -sign * before - reach, width)
    return sign * soft_maximum(p, sign * u - reach, width)


def soft_maximum(a, b, width):
    """f log(exp(a / f) + exp(b / f))."""
    return max(a, b) + width * log1p(1 + expm1(-abs(a - b) / width))
