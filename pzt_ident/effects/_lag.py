"""Lags of first and second order, stepped exactly for an input that is linear between samples."""

from pzt_ident.model.block import Block
from pzt_ident.model.first_order_hold import decay, oscillator
from pzt_ident.model.parameter import Parameter
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


class SecondOrderLag(SecondOrder):
    """A low-pass of second order that lags by tau at low frequency: with omega = 2 zeta / tau,
    y'' / omega^2 + 2 zeta y' / omega + y = u. At tau = 0 there is none.
    """

    sizes = Lag.sizes
    trials = {"damping": 3}
    damping = Parameter(
        "1",
        (0.5, 5),
        "Damping ratio, zeta: 0.71 of a Butterworth filter, 1 of two equal poles, more of two unequal ones.",
        scale="log",
    )

    def prepare(tau, damping, dt):
        return oscillator(2 * damping / tau, damping, dt) if tau != 0 else (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
