"""Lags of first and second order, stepped exactly for an input that is linear between samples."""

from pzt_ident.model.block import Block
from pzt_ident.model.first_order_hold import decay, oscillate, oscillator
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
        end="upper",
    )

    def prepare(tau, damping, dt):
        return oscillator(2 * damping / tau, damping, dt) if tau != 0 else (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


class ThirdOrderLag(Block):
    """A low-pass of third order that lags by tau at low frequency: a pole with a share of that lag, then the low-pass
    of second order, each exact for an input that is linear between samples. At tau = 0 there is none.
    """

    sizes = Lag.sizes
    trials = {"share": 2, "damping": 2}
    share = Parameter(
        "1", (0.1, 0.8), "Part of the lag that the single pole has: 0.5 Butterworth, 0.43 Bessel.", end="both"
    )
    damping = Parameter(
        "1", (0.3, 2), "Damping ratio of the others, zeta: 0.5 Butterworth, 0.72 Bessel.", scale="log", end="upper"
    )

    def prepare(tau, share, damping, dt):
        omega = 2 * damping / ((1 - share) * tau) if tau != 0 else 0.0
        two = oscillator(omega, damping, dt) if tau != 0 else (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        return *decay(share * tau, dt), *two

    def start(u, keep, part, r11, r12, r21, r22, b1, b2):
        return 0.0, u, 0.0, 0.0, u

    def step(p, before, w, v, f, u, keep, part, r11, r12, r21, r22, b1, b2):
        p = keep * p - part * (u - before)
        w, v = oscillate(w, v, u + p - f, r11, r12, r21, r22, b1, b2)
        return p, u, w, v, u + p, u + p + w
