"""Amplifier whose current limits how fast the voltage of a capacitive load can change."""

from math import exp, inf, sqrt

from pzt_ident.model.block import Block, Place, expm1, log1p
from pzt_ident.model.first_order_hold import decay
from pzt_ident.model.parameter import Form, Parameter
from pzt_ident.model.registry import blocks

SHORTEST = 1e-6  # of a sample: a time constant that follows at once
LINEAR = 1e-8  # of the pair's range: up to here its tanh is its argument
FAR = 300.0  # times that range, where sinh is half of exp in all digits


@blocks.register
class SlewLimit(Block):
    """The current limit bounds the rate of the voltage: |dU_a/dt| <= 1 / slowness, slowness = C / I_max.

    Fleming & Leang (2014), Design, Modeling and Control of Nanopositioning Systems. Exact for a command that is linear
    between samples: a command that returns may meet the lagging voltage within a sample and leave it behind again.
    """

    place = Place.SLEW
    form = Form(
        "clip",
        ("clip", "lag", "soft", "two_sided", "charge"),
        "How the voltage approaches the command, whether up and down alike, and into which capacitance.",
    )
    sizes = tuple(1.25**-k for k in range(50))
    slowness = Parameter("s/drive", (0, 1.8), "Capacitance over the greatest current.", null=0)
    look_alikes = ("amplifier_lag", "sensor_lag", "delay")
    separate_by = "Sweep the amplitude at one frequency: this sets in where frequency times amplitude exceeds a limit."
    remedy = "Stay below the slew rate, round the corners of the drive, or use an amplifier with more current."

    def prepare(slowness, dt):
        return (dt / slowness if slowness != 0 else inf,)

    def start(u, limit):
        return u, u

    def step(y, before, u, limit):
        sign = 1.0 if before >= y else -1.0
        back = sign * (before - u)
        met = min(1.0, abs(before - y) / (limit + abs(back)))
        follows = u if abs(u - y) <= limit else y + (limit if u > y else -limit)
        y = y + sign * limit * (2 * met - 1) if back > limit else follows
        return y, u, y


class SaturatingLag(SlewLimit):
    """An amplifier with a lag whose current saturates: dU_a/dt = (U - U_a) / tau, at most 1 / slowness.

    Fleming & Leang (2014), ch. 14. The voltage follows the lag wherever that is slow enough: exact there for a command
    that is linear between samples, and on the limit.
    """

    tau = Parameter("s", (0, 0.05), "Time constant below the limit.", null=0)
    contains = ("amplifier_lag",)

    def prepare(slowness, tau, dt):
        return dt / slowness if slowness != 0 else inf, *decay(tau, dt)

    def start(u, limit, keep, share):
        return u, u

    def step(y, before, u, limit, keep, share):
        lagging = u + keep * (y - before) - share * (u - before)
        y = lagging if abs(lagging - y) <= limit else y + (limit if lagging > y else -limit)
        return y, u, y


class SoftLimit(SaturatingLag):
    """An amplifier whose differential input pair saturates: dU_a/dt = tanh(slowness (U - U_a) / tau) / slowness.

    Solomon (1974), IEEE J. Solid-State Circuits 9, 314. Behind a held command sinh(slowness (U - U_a) / tau) fades by
    exp(-dt / tau); the change of the command comes in part ahead of that and in part behind it, so that a step is exact
    where the pair is linear, and second order in dt elsewhere.
    """

    def prepare(slowness, tau, dt):
        keep, share = decay(tau, dt)
        shortened = max(tau, SHORTEST * dt)
        return slowness / shortened, dt / shortened, (1 - share) / (1 - keep)

    def start(u, steep, fading, ahead):
        return u, u

    def step(y, before, u, steep, fading, ahead):
        behind = before - y + ahead * (u - before)
        x = steep * abs(behind)
        left = faded(x, fading) / steep if x > LINEAR else abs(behind) * exp(-fading)
        y = u - (left if behind > 0 else -left) - (1 - ahead) * (u - before)
        return y, u, y


def faded(x, fading):
    """asinh(sinh(x) exp(-fading)) for x > 0, also where sinh(x) overflows."""
    grown = expm1(min(x, FAR))
    sine = 0.5 * (grown + grown / (grown + 1)) * exp(-fading) if x < FAR else 0.5 * exp(min(x - fading, FAR))
    return x - fading if x - fading > FAR else log1p(sine + sine * sine / (1 + sqrt(1 + sine * sine)))


class TwoSided(SlewLimit):
    """An amplifier that sources another current than it sinks: slowness dU_a/dt <= 1,  ratio slowness dU_a/dt >= -1.

    Fleming & Leang (2014), ch. 14: the bridge charges and discharges the load through different transistors.
    """

    trials = {"ratio": 4}
    ratio = Parameter("1", (0.2, 10), "Slowness of a falling voltage over that of a rising one.", scale="log")

    def prepare(slowness, ratio, dt):
        return (dt / slowness, dt / (slowness * ratio)) if slowness != 0 else (inf, inf)

    def start(u, up, down):
        return u, u

    def step(y, before, u, up, down):
        y = limited(y, before, u, up, down)
        return y, u, y


def limited(y, before, u, up, down):
    """Where y comes to behind a command from `before` to u, at most `up` or `down`."""
    sign, toward, away = (1.0, up, down) if before >= y else (-1.0, down, up)
    back = sign * (before - u)
    met = min(1.0, abs(before - y) / (toward + abs(back)))
    most = up if u > y else down
    follows = u if abs(u - y) <= most else y + (most if u > y else -most)
    return y + sign * (toward * met - away * (1 - met)) if back > away else follows


class ChargeLimit(TwoSided):
    """The currents limit the rate of the charge of a capacitance that grows with the voltage:
    Q = U_a + growth U_a^2 / 2,  slowness dQ/dt <= 1,  ratio slowness dQ/dt >= -1.

    Fleming & Leang (2014), ch. 14, with a differential capacitance C (1 + growth U_a), as ferroelectric actuators have.
    Exact where the command is constant on a step, second order in dt elsewhere.
    """

    trials = {"ratio": 2, "growth": 2}
    growth = Parameter("1/drive", (0, 0.9), "Relative growth of the differential capacitance per voltage.")

    def prepare(slowness, ratio, growth, dt):
        return (dt / slowness, dt / (slowness * ratio), growth) if slowness != 0 else (inf, inf, growth)

    def start(u, up, down, growth):
        return charge(u, growth), charge(u, growth)

    def step(q, before, u, up, down, growth):
        asked = charge(u, growth)
        q = limited(q, before, asked, up, down)
        return q, asked, u if q == asked else voltage(q, growth)


def charge(u, growth):
    """Q(U), over the capacitance at 0 V."""
    return u + 0.5 * growth * u * u


def voltage(q, growth):
    """U(Q), the root that is 0 at 0."""
    return 2 * q / (1 + sqrt(max(1 + 2 * growth * q, 0.0)))


SlewLimit.forms = {"lag": SaturatingLag, "soft": SoftLimit, "two_sided": TwoSided, "charge": ChargeLimit}
