"""Lags of first and second order, stepped exactly for an input that is linear between samples."""

from pzt_ident.model.block import Block
from pzt_ident.model.first_order_hold import decay, oscillator
from pzt_ident.model.second_order import SecondOrder


class Lag(Block):
    """T y' + y = u with the state w = y - u: over a sample w <- keep w - share du, keep = exp(-dt / T),
    share = (1 - keep) T / dt. At T = 0 both are exactly zero.
    """

    sizes = tuple(4e-4 * 1.5**k for k in range(20))

    def prepare(tau, dt):
        return decay(tau, dt)

    def start(u, keep, share):
        return 0.0, u

    def step(w, before, u, keep, share):
        w = keep * w - share * (u - before)
        return w, u, u + w


def second_order(tau, zeta, dt):
    """Coefficients of y'' / omega^2 + 2 zeta y' / omega + y = u, 2 zeta / omega = tau, for `oscillate`; all zero at
    tau = 0."""
    return oscillator(2 * zeta / tau, zeta, dt) if tau != 0 else (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


class SecondOrderLag(SecondOrder):
    """A low-pass of second order that lags by tau at low frequency."""

    sizes = Lag.sizes
