"""How much of a response no model can explain."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.record import Record
from pzt_ident.data.units import common_unit, factor, of_one_kind

Array = NDArray[np.float64]


LINE = 30.0
WHOLE = 5e-3


class Floor(NamedTuple):
    """Standard deviation of the noise, SI units, and what it was taken from."""

    value: float
    source: str


def noise_floor(records: list[Record], axis: int) -> Floor:
    """Noise of an axis, from the best evidence there is: records measured again, rest segments, repeated periods, else
    the high frequencies.

    Never less than the quantiser's q / sqrt(12) where the response takes few values. The high-frequency part is weak
    evidence: it takes slow noise for signal and fast signal for noise.
    """
    signals = [(r.drive, r.response[axis], r.settle, r.dt) for r in records]
    again = [(r, other) for i, r in enumerate(records) for other in records[:i] if measured_again(r, other, axis)]
    step = min((quantiser(y) for _, y, _, _ in signals), default=0.0)
    least = step / np.sqrt(12)
    if again:
        change = [(a.response[axis] - b.response[axis])[max(a.settle, b.settle) :] for a, b in again]
        return at_least(np.sqrt(np.mean([scatter(each, 1) ** 2 / 2 for each in change])), "repeated records", least)
    for find, source in (
        (resting, "rest segments"),
        (repeated, "repeated periods"),
        (rough, "high frequencies (weak)"),
    ):
        found = [(v, n * dt) for u, y, settle, dt in signals for v, n in find(u[:, settle:], y[settle:])]
        if found:
            values, seconds = np.array(found).T
            return at_least(np.sqrt(np.average(values**2, weights=seconds)), source, least)
    return Floor(least, "quantiser")


def at_least(value: float, source: str, least: float) -> Floor:
    """A scatter, or the quantiser where that is more."""
    return Floor(float(value), source) if value > least else Floor(least, "quantiser")


def measured_again(one: Record, other: Record, axis: int, tolerance: float = 2e-3) -> bool:
    """Whether all drives differ by no more than a share of their spans; data listed twice are measured once."""
    if one.drive.shape != other.drive.shape or one.dt != other.dt:
        return False
    if np.array_equal(one.response[axis], other.response[axis]):
        return False
    span = np.ptp(one.drive, axis=1)
    return bool((np.abs(one.drive - other.drive).max(axis=1) <= tolerance * span).all())


def error_scales(records: list[Record]) -> Array:
    """What the errors of each measured axis are weighed by: nothing where responses are of one kind, else their noise
    floors, so that a polarization and a displacement count by what their noise lets see; at least WHOLE of the span,
    since an integrated charge is smooth far below what any model reaches."""
    if of_one_kind(list(records[0].units.values())):
        return np.ones(len(records[0].measured))
    spans = np.array([max(np.ptp(record.response[axis]) for record in records) for axis in records[0].measured])
    floors = np.array([noise_floor(records, axis).value for axis in records[0].measured])
    return np.maximum(floors, WHOLE * spans)


def pooled_floor(records: list[Record]) -> float:
    """Noise floor of all measured axes together, in units of the loss."""
    floors = np.array([noise_floor(records, axis).value for axis in records[0].measured])
    return float(np.sqrt(np.mean(np.square(floors / error_scales(records)))))


def facts(records: list[Record]) -> dict[str, Any]:
    """Units and noise floors as the files of a result have them: of each axis by its name, and `unit` and `floor` of
    what is over all axes."""
    units = records[0].units
    found = {records[0].axes[axis]: noise_floor(records, axis) for axis in records[0].measured}
    unit = common_unit(list(units.values()))
    return {
        "unit": unit,
        "units": units,
        "noise_floor": {axis: floor.value / factor(units[axis]) for axis, floor in found.items()},
        "noise_floor_source": {axis: floor.source for axis, floor in found.items()},
        "floor": pooled_floor(records) / factor(unit),
    }


def quantiser(response: Array) -> float:
    """Step of the quantiser, 0 where none shows: the values lie on a grid of at most a third as many points."""
    values = np.unique(response)
    if values.size < 2 or values.size > response.size / 3:
        return 0.0
    gaps = np.diff(values)
    step = float(gaps[gaps > 1e-6 * gaps.max()].min())
    whole = gaps / step
    return step if np.allclose(whole, np.round(whole), atol=0.05) else 0.0


def resting(drive: Array, response: Array, least: int = 100) -> list[tuple[float, int]]:
    """Scatter about a quartic, which follows creep, and about the lines of the mains and the floor, in the last four
    fifths of every stretch of constant drive, and the samples there."""
    span = np.ptp(drive, axis=1, keepdims=True)
    still = (np.abs(np.diff(drive, axis=1)) <= 1e-6 * np.maximum(span, 1e-300)).all(axis=0)
    edges = np.flatnonzero(np.diff(np.concatenate([[0], still.astype(int), [0]])))
    found = []
    for first, last in zip(edges[::2], edges[1::2], strict=True):
        first += (last - first) // 5
        if last - first >= least:
            found.append((float(np.std(without_lines(response[first:last], 4))), last - first))
    return found


def repeated(drive: Array, response: Array, least: int = 3) -> list[tuple[float, int]]:
    """Half the variance of the difference of successive periods, each about its own line."""
    period = period_of(drive)
    if not period or response.size < least * period:
        return []
    found = []
    for first in range(0, response.size - 2 * period + 1, period):
        change = response[first + period : first + 2 * period] - response[first : first + period]
        found.append(scatter(change, 1) / np.sqrt(2))
    return [(float(np.median(found)), response.size)]


def rough(drive: Array, response: Array) -> list[tuple[float, int]]:
    """Third differences of white noise have twenty times its variance."""
    third = np.diff(response, 3)
    size = float(np.median(np.abs(third)) / 0.6745 / np.sqrt(20)) if third.size > 10 else 0.0
    return [(size, third.size)] if third.size > 10 else []


def scatter(signal: Array, degree: int) -> float:
    return float(np.std(about(signal, degree)))


def about(signal: Array, degree: int) -> Array:
    """What is left of a polynomial."""
    x = np.linspace(-1, 1, signal.size)
    return np.asarray(signal - np.polynomial.Polynomial.fit(x, signal, degree)(x))


def without_lines(signal: Array, degree: int, most: int = 5, near: int = 25) -> Array:
    """What is left of a polynomial and, fitted together with it, of the sinusoids whose power stands LINE times above
    that of the frequencies around them."""
    from scipy.optimize import minimize_scalar

    t = np.arange(signal.size)
    basis = np.linalg.qr(np.polynomial.legendre.legvander(np.linspace(-1, 1, signal.size), degree))[0]

    def waves(frequency: float) -> Array:
        """Orthonormal, beside what is fitted already."""
        both = np.column_stack([np.cos(2 * np.pi * frequency * t), np.sin(2 * np.pi * frequency * t)])
        return np.asarray(np.linalg.qr(both - basis @ (basis.T @ both))[0])

    def unexplained(frequency: float) -> float:
        return -float(np.square(waves(frequency).T @ signal).sum())

    noise = signal - basis @ (basis.T @ signal)
    for _ in range(most):
        power = np.abs(np.fft.rfft(noise * np.hanning(noise.size))) ** 2
        peak = int(np.argmax(power[3:])) + 3 if power.size > 2 * near else 0
        around = np.concatenate([power[max(1, peak - near) : max(1, peak - 2)], power[peak + 3 : peak + near]])
        if not peak or power[peak] <= LINE * around.mean():
            break
        ends = ((peak - 1) / noise.size, (peak + 1) / noise.size)
        best = minimize_scalar(unexplained, bounds=ends, method="bounded", options={"xatol": 1e-9})
        basis = np.hstack([basis, waves(float(best.x))])
        noise = signal - basis @ (basis.T @ signal)
    return np.asarray(noise)


def period_of(drive: Array, tolerance: float = 2e-3) -> int:
    """Samples after which every drive repeats, 0 where it does not: the first valley of the distance to itself."""
    span = np.ptp(drive, axis=1)
    moving = drive[span > 0]
    samples = drive.shape[1]
    if not moving.size or samples < 8:
        return 0
    scaled = moving / span[span > 0][:, None]
    size = 2 ** int(np.ceil(np.log2(2 * samples)))
    correlation = np.fft.irfft(np.abs(np.fft.rfft(scaled, size)) ** 2, size).sum(axis=0)
    power = np.concatenate([[0], np.cumsum((scaled**2).sum(axis=0))])
    lags = np.arange(1, samples // 2 + 1)
    apart = (power[-1] - power[lags] + power[samples - lags] - 2 * correlation[lags]) / (samples - lags)
    low = np.flatnonzero(apart < tolerance**2)
    risen = low[low > np.argmax(apart >= tolerance**2)] if apart.max() >= tolerance**2 else low[:0]
    if not risen.size:
        return 0
    valley = risen[: np.argmax(np.diff(risen, append=risen[-1] + 2) > 1) + 1]
    return int(lags[valley[np.argmin(apart[valley])]])
