"""First-order lag, T y' + y = u, stepped exactly for an input that is linear between samples."""

from math import expm1

from pzt_ident.block import Block


class Lag(Block):
    """The state is w = y - u: over a sample w <- keep w - share du, keep = exp(-dt / T), share = (1 - keep) T / dt.

    At T = 0 both are exactly zero.
    """

    def prepare(tau, dt):
        return decay(tau, dt)

    def start(u, keep, share):
        return 0.0, u

    def step(w, before, u, keep, share):
        w = keep * w - share * (u - before)
        return w, u, u + w


def decay(tau, dt):
    """What a lag of the time constant `tau` keeps over a sample, and its share of the input's change."""
    if tau == 0:
        return 0.0, 0.0
    lost = -expm1(-dt / tau)
    return 1 - lost, lost * tau / dt
