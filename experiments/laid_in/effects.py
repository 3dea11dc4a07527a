"""Effects laid into a measured response, by NumPy and SciPy alone. A response is (samples,) in um (charge: relative),
its step `dt` in s; `periodic` says that it is one period of a steady state."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.signal import lfilter

Array = NDArray[np.float64]


class Response(NamedTuple):
    """One response of a measurement; rest: samples at its start over which it rests; scored: those that count."""

    values: Array
    dt: float
    periodic: bool = False
    rest: int = 1
    scored: slice = slice(None)


def low_pass(response: Response, tau: float) -> Array:
    """tau y' + y = x from rest, x a line between samples; of a period, its steady state."""
    x, dt = response.values, response.dt
    if response.periodic:
        return filtered(response, lambda s: 1 / (1 + tau * s))
    keep = np.exp(-dt / tau)
    late = tau / dt * (1 - keep)
    start = x[: response.rest].mean()
    moved = x - start
    ahead = np.concatenate([[0.0], moved[:-1]])
    return start + lfilter([1.0], [1.0, -keep], (1 - late) * moved + (late - keep) * ahead)


def filtered(response: Response, transfer) -> Array:
    """One period of the steady state behind a transfer function of s."""
    x = response.values
    lines = np.fft.rfft(x)
    gain = transfer(2j * np.pi * np.fft.rfftfreq(x.size, response.dt))
    return np.fft.irfft(lines * gain, x.size)


def lag(response: Response, size: float, rng, hint) -> Array:
    """Of the amplifier or of the sensor: behind a linear path they are the same. size: tau in s."""
    return low_pass(response, size)


def delay(response: Response, size: float, rng, hint) -> Array:
    """A shift by any fraction of a sample. size: s."""
    if response.periodic:
        return filtered(response, lambda s: np.exp(-size * s))
    t = np.arange(response.values.size) * response.dt
    return CubicSpline(t, response.values)(np.maximum(t - size, 0.0))


def creep(response: Response, size: float, rng, hint) -> Array:
    """Three Kelvin-Voigt elements, a factor of 4 apart. size: their final creep in all; hint: the middle time, s."""
    x = response.values
    parts = [low_pass(response, hint * spread) for spread in (0.25, 1.0, 4.0)]
    return x + size / 3 * sum(part - x[: response.rest].mean() for part in parts)


def drift(response: Response, size: float, rng, hint) -> Array:
    """Towards another place, whatever the drive. size: um; hint: its time constant, s, 0 for a ramp."""
    t = np.arange(response.values.size) * response.dt
    course = -np.expm1(-t / hint) if hint else t / t[-1]
    return response.values + size * rng.uniform(0.7, 1.3) * course


def hum(response: Response, size: float, rng, hint) -> Array:
    """A line in any phase. size: its amplitude, um; hint: its frequency, Hz."""
    t = np.arange(response.values.size) * response.dt
    return response.values + size * np.sin(2 * np.pi * hint * t + rng.uniform(0, 2 * np.pi))


def encoder(response: Response, size: float, rng, hint) -> Array:
    """A cyclic error of the reading. size: its amplitude, um; hint: the pitch, um."""
    return response.values + size * np.sin(2 * np.pi * response.values / hint + 1.0)


def bend(response: Response, size: float, rng, hint) -> Array:
    """A reading whose gain grows with the displacement. size: 1/um; hint: where the gain is right, um."""
    return response.values + size * (response.values - hint) ** 2


EFFECTS = {"lag": lag, "delay": delay, "creep": creep, "drift": drift, "hum": hum, "encoder": encoder, "bend": bend}
WORDS = {
    "lag": ("amplifier_lag", "sensor_lag"),
    "delay": ("delay",),
    "creep": ("creep",),
    "drift": ("drift",),
    "hum": ("periodic_disturbance",),
    "encoder": ("encoder_cyclic_error",),
    "bend": ("quadratic_gain",),
}
LARGEST = {"lag": 4.5e-3, "delay": 9e-3, "creep": 0.35}  # what the catalogue calls plausible


def largest(effect: str, responses: list[Response]) -> float:
    """The largest size that is plausible; those that are no times and no shares by the range of the response."""
    if effect in LARGEST:
        return LARGEST[effect]
    span = max(float(np.ptp(r.values[r.scored])) for r in responses)
    return {"drift": 0.7 * span, "hum": 0.9 * span, "encoder": 0.045 * span, "bend": 0.45 / span}[effect]


def lay(effect: str, size: float, responses: list[Response], seed: int, hint: float) -> list[Array]:
    """All responses with the effect in them; what is drawn, such as phases, is a function of the seed."""
    rng = np.random.default_rng(seed)
    return [EFFECTS[effect](response, size, rng, hint) for response in responses]


def seen(laid: list[Array], responses: list[Response]) -> float:
    """RMS of what an offset a record and one gain do not take up of the change."""
    change, before = [], []
    for after, response in zip(laid, responses, strict=True):
        part = response.scored
        difference = (after - response.values)[part]
        change.append(difference - difference.mean())
        before.append(response.values[part] - response.values[part].mean())
    moved, gain = np.concatenate(change), np.concatenate(before)
    left = moved - gain * (gain @ moved) / (gain @ gain)
    return float(np.sqrt(np.mean(left**2)))


def scale(effect: str, target: float, responses: list[Response], seed: int, hint: float) -> float | None:
    """The size that is seen with an RMS of `target`; None where none that is plausible is."""
    limit = largest(effect, responses)
    size = limit / 100
    for _ in range(12):
        found = seen(lay(effect, size, responses, seed, hint), responses)
        if abs(found / target - 1) < 0.02:
            return size
        following = min(limit, size * min(target / found, 30.0))
        if following == size:
            return None
        size = following
    return size
