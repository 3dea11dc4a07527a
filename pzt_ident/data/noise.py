"""The noise floor of a response: the part that no model can explain."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.record import Record
from pzt_ident.data.units import common_unit, factor, of_one_kind
from pzt_ident.libraries import extension

Array = NDArray[np.float64]

LINE_RATIO = 30.0  # power of a spectral line over that of the frequencies around it
LEAST_SCALE = 5e-3  # of the span of a response
ROUNDING = 1e-12  # of a signal: what is left below is no noise
QUIETEST = 0.25  # of all that is measured: as much as no ringing and no transient need have reached
LOUDER = 1.5  # times those: above that an estimate has more in it than noise
DECAY = 2.0  # of the variance between the halves of a rest: more is a transient, and the later half is taken
MOST_MEMORY = 0.95  # from sample to sample: noise of a longer memory is not told from what settles
MISMATCH = 0.5  # of the noise: more may not come from periods that are no whole number of samples

GOLDEN = (5**0.5 - 1) / 2


class Floor(NamedTuple):
    """Standard deviation of the noise, SI units, and what it was taken from."""

    value: float
    source: str


def noise_floor(records: list[Record], axis: int) -> Floor:
    """Noise of an axis, from the best evidence there is: repeated records, rest segments, repeated periods, else the
    high frequencies.

    The noise is the sensor's, the same in all records, and what a stage adds, such as ringing, only makes an estimate
    larger: those well above the quietest quarter are left out. A quantiser adds its own. The high-frequency part is
    weak evidence: it takes slow noise for signal and fast signal for noise.
    """
    signals = [(r.drive, r.response[axis], r.settle, r.dt) for r in records]
    pairs = [(r, other) for i, r in enumerate(records) for other in records[:i] if is_repeat(r, other, axis)]
    step = common_step([y for _, y, _, _ in signals])
    if pairs:
        changes = [(a.response[axis] - b.response[axis])[max(a.settle, b.settle) :] for a, b in pairs]
        variances = [deviation(*without_lines(change, 1)) ** 2 / 2 for change in changes]
        return floor_of(with_quantiser(np.sqrt(np.mean(variances)), step), "repeated records", step)
    for estimate, source in (
        (rest_noise, "rest segments"),
        (period_noise, "repeated periods"),
        (difference_noise, "high frequencies (weak)"),
    ):
        found = [(part, dt) for u, y, settle, dt in signals for part in estimate(u[:, settle:], y[settle:])]
        estimates = [(with_quantiser(value, step), samples * dt) for (value, samples), dt in found]
        if estimates:
            return floor_of(quiet_deviation(*np.array(estimates).T), source, step)
    return floor_of(with_quantiser(0.0, step), "quantiser", step)


def quiet_deviation(deviations: Array, seconds: Array) -> float:
    """Root mean square of the estimates up to LOUDER times the one that the QUIETEST share of the seconds stays below,
    weighed by their seconds."""
    order = np.argsort(deviations)
    measured = np.cumsum(seconds[order])
    quiet = deviations[order][np.searchsorted(measured, QUIETEST * measured[-1])]
    kept = deviations <= LOUDER * quiet
    return float(np.sqrt(np.average(deviations[kept] ** 2, weights=seconds[kept])))


def floor_of(value: float, source: str, step: float) -> Floor:
    """The floor of a standard deviation, the quantiser's where it is less than what is left besides."""
    return Floor(float(value), "quantiser" if value <= step / np.sqrt(6) else source)


def with_quantiser(scatter: float, step: float) -> float:
    """Standard deviation of the errors of a quantised reading of something whose readings scatter so much.

    Noise of variance s^2 errs by s^2 + q^2/12 in the mean over all places between two steps q. What stays in place
    scatters less: by q s / sqrt(pi) in the mean where s is small against q, by all of it from q^2/(2 pi) on.
    """
    if 2 * np.pi * scatter**2 >= step**2:
        return scatter
    return float(np.hypot(np.sqrt(np.pi) * scatter**2 / step, step / np.sqrt(12)))


def is_repeat(record: Record, other: Record, axis: int, tolerance: float = 2e-3) -> bool:
    """Whether all drives differ by no more than a share of their spans; the same data listed twice are no repeat."""
    if record.drive.shape != other.drive.shape or record.dt != other.dt:
        return False
    if np.array_equal(record.response[axis], other.response[axis]):
        return False
    span = np.ptp(record.drive, axis=1)
    return bool((np.abs(record.drive - other.drive).max(axis=1) <= tolerance * span).all())


def error_scales(records: list[Record]) -> Array:
    """What the errors of each measured axis are divided by in the loss, (measured axes,): 1 where the responses are of
    one kind, else their noise floors, and at least LEAST_SCALE of their spans, since an integrated charge is smooth far
    below the error of any model."""
    if of_one_kind(list(records[0].units.values())):
        return np.ones(len(records[0].measured))
    spans = np.array([max(np.ptp(record.response[axis]) for record in records) for axis in records[0].measured])
    floors = np.array([noise_floor(records, axis).value for axis in records[0].measured])
    return np.maximum(floors, LEAST_SCALE * spans)


def pooled_floor(records: list[Record]) -> float:
    """Noise floor of all measured axes together, in units of the loss."""
    floors = np.array([noise_floor(records, axis).value for axis in records[0].measured])
    return float(np.sqrt(np.mean(np.square(floors / error_scales(records)))))


def units_and_floors(records: list[Record]) -> dict[str, Any]:
    """Units and noise floors as in the files of a result: of each axis by its name, and `unit` and `floor` over all
    axes."""
    units = records[0].units
    floors = {records[0].axes[axis]: noise_floor(records, axis) for axis in records[0].measured}
    unit = common_unit(list(units.values()))
    return {
        "unit": unit,
        "units": units,
        "noise_floor": {axis: floor.value / factor(units[axis]) for axis, floor in floors.items()},
        "noise_floor_source": {axis: floor.source for axis, floor in floors.items()},
        "floor": pooled_floor(records) / factor(unit),
    }


def quantiser_step(response: Array) -> float:
    """Step of the quantiser, 0 where none shows: the values lie on a grid of at most a third as many points."""
    values = np.unique(response)
    if values.size < 2 or values.size > response.size / 3:
        return 0.0
    gaps = np.diff(values)
    step = float(gaps[gaps > 1e-6 * gaps.max()].min())
    return step if is_on_grid(response, step) else 0.0


def common_step(responses: list[Array]) -> float:
    """Step of the quantiser of all responses: the finest that one of them shows, 0 where others have values between."""
    steps = [step for step in map(quantiser_step, responses) if step]
    return min(steps) if steps and all(is_on_grid(response, min(steps)) for response in responses) else 0.0


def is_on_grid(response: Array, step: float) -> bool:
    """Whether all values are whole numbers of steps apart."""
    steps = np.diff(np.unique(response)) / step
    return bool(np.allclose(steps, np.round(steps), atol=0.05))


def rest_noise(drive: Array, response: Array, least: int = 100) -> list[tuple[float, int]]:
    """Standard deviation and number of samples of each rest: the last four fifths of an interval of constant drive, or
    less where these still settle, less a quartic, which follows creep, and the lines of the mains and the floor."""
    span = np.ptp(drive, axis=1, keepdims=True)
    still = (np.abs(np.diff(drive, axis=1)) <= 1e-6 * np.maximum(span, 1e-300)).all(axis=0)
    edges = np.flatnonzero(np.diff(np.concatenate([[0], still.astype(int), [0]])))
    estimates = []
    for first, last in zip(edges[::2], edges[1::2], strict=True):
        first += (last - first) // 5
        if last - first >= least:
            estimates.append(settled_deviation(response[first:last], least))
    return estimates


def settled_deviation(signal: Array, least: int) -> tuple[float, int]:
    """Standard deviation about a quartic and lines, and the number of samples that it is from: those of the later half,
    and so on, while the earlier one has DECAY times its variance."""
    noise, basis = without_lines(signal, 4)
    half = noise.size // 2
    if half >= least and np.var(noise[:half]) > DECAY * np.var(noise[half:]):
        return settled_deviation(signal[half:], least)
    return deviation(noise, basis), noise.size


def period_noise(drive: Array, response: Array, least: int = 3) -> list[tuple[float, int]]:
    """Standard deviation and number of samples of a periodic record: half the variance of the difference of successive
    periods, less its straight line and lines of the mains, of the quiet ones. None where the drive repeats so roughly,
    as with periods of no whole number of samples, that the response must too."""
    period = period_of(drive)
    if not period or response.size < least * period:
        return []

    def changes(signal: Array) -> list[Array]:
        firsts = range(0, response.size - 2 * period + 1, period)
        return [signal[i + period : i + 2 * period] - signal[i : i + period] for i in firsts]

    deviations = np.array([deviation(*without_lines(change, 1)) for change in changes(response)]) / np.sqrt(2)
    quiet = quiet_deviation(deviations, np.ones(deviations.size))
    scaled = drive / np.maximum(np.ptp(drive, axis=1, keepdims=True), 1e-300)
    mismatch, span = max(float(np.median(np.std(changes(row), axis=1))) for row in scaled), np.ptp(response)
    return [(quiet, response.size)] if mismatch * span <= max(MISMATCH * quiet, ROUNDING * span) else []


def difference_noise(drive: Array, response: Array) -> list[tuple[float, int]]:
    """Standard deviation and number of samples from third differences, whose variance is 20 times that of white
    noise."""
    third = np.diff(response, 3)
    return [(float(np.median(np.abs(third)) / 0.6745 / np.sqrt(20)), third.size)] if third.size > 10 else []


def deviation(noise: Array, basis: Array) -> float:
    """Standard deviation of noise that an orthonormal basis, (samples, columns), has been projected out of, which takes
    the more of it the longer its memory is: of first order, such that the part that is left is as alike from sample to
    sample as it should be."""
    power, alike = float(noise @ noise), float(noise[1:] @ noise[:-1])
    if power == 0:
        return 0.0

    def excess(memory: float) -> float:
        expected = expected_products(basis, memory)
        return expected[1] / expected[0] - alike / power

    zeros = extension("scipy.optimize", "_zeros")
    whiter, redder = excess(0.0) >= 0, excess(MOST_MEMORY) <= 0
    memory = (
        0.0
        if whiter
        else MOST_MEMORY
        if redder
        else zeros._brentq(excess, 0.0, MOST_MEMORY, 1e-4, 1e-9, 100, (), False, True)
    )
    return float(np.sqrt(power / expected_products(basis, memory)[0]))


def expected_products(basis: Array, memory: float) -> tuple[float, float]:
    """What the sum of squares of n, and that of n_t n_{t+1}, are expected to be, where n is noise of unit variance with
    the correlations R_st = memory^|s - t| that the basis B has been projected out of: tr(MRM) and the sum next to the
    diagonal of MRM, M = I - B B'."""
    filtered = extension("scipy.signal", "_sigtools")._linear_filter  # scipy.signal takes half a second to import
    onward, back = (filtered(np.ones(1), np.array([1.0, -memory]), rows, 0) for rows in (basis, basis[::-1]))
    correlated = onward + back[::-1] - basis
    inner = basis.T @ correlated
    across = (basis[:-1] * correlated[1:]).sum() + (correlated[:-1] * basis[1:]).sum()
    samples = basis.shape[0]
    beside = (samples - 1) * memory - across + ((basis[:-1] @ inner) * basis[1:]).sum()
    return float(samples - np.trace(inner)), float(beside)


def without_lines(signal: Array, degree: int, most: int = 5, near: int = 25) -> tuple[Array, Array]:
    """The signal less a polynomial and, fitted together with it, up to `most` sinusoids whose power is LINE_RATIO times
    that of the `near` frequencies around them, all made white; and the orthonormal basis of what was taken off,
    (samples, columns)."""
    t = np.arange(signal.size)
    basis = np.linalg.qr(np.polynomial.legendre.legvander(np.linspace(-1, 1, signal.size), degree))[0]

    def waves(frequency: float) -> Array:
        """Cosine and sine, orthonormal to each other and to the basis: (samples, 2)."""
        columns = np.column_stack([np.cos(2 * np.pi * frequency * t), np.sin(2 * np.pi * frequency * t)])
        return np.asarray(np.linalg.qr(columns - basis @ (basis.T @ columns))[0])

    def power_at(frequency: float) -> float:
        return float(np.square(waves(frequency).T @ signal).sum())

    noise = signal - basis @ (basis.T @ signal)
    for _ in range(most):
        if np.abs(noise).max() <= ROUNDING * np.abs(signal).max():
            break
        power = np.abs(np.fft.rfft(whitened(noise) * np.hanning(noise.size))) ** 2
        peak = int(np.argmax(power[3:])) + 3 if power.size > 2 * near else 0
        around = np.concatenate([power[max(1, peak - near) : max(1, peak - 2)], power[peak + 3 : peak + near]])
        if not peak or power[peak] <= LINE_RATIO * around.mean():
            break
        basis = np.hstack([basis, waves(top(power_at, (peak - 1) / noise.size, (peak + 1) / noise.size, 1e-9))])
        noise = signal - basis @ (basis.T @ signal)
    return np.asarray(noise), basis


def whitened(noise: Array) -> Array:
    """Noise less what follows of it from the sample before: without its memory of first order."""
    memory = noise[1:] @ noise[:-1] / (noise @ noise)
    return np.asarray(np.append(noise[0], noise[1:] - memory * noise[:-1]))


def top(function: Callable[[float], float], low: float, high: float, width: float) -> float:
    """Where a function of one hill between two places is largest, to a width: by golden sections (Kiefer 1953, Proc.
    Am. Math. Soc. 4, 502)."""
    left, right = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
    at_left, at_right = function(left), function(right)
    while high - low > width:
        if at_left > at_right:
            high, right, at_right = right, left, at_left
            left = high - GOLDEN * (high - low)
            at_left = function(left)
        else:
            low, left, at_left = left, right, at_right
            right = low + GOLDEN * (high - low)
            at_right = function(right)
    return (low + high) / 2


def period_of(drive: Array, tolerance: float = 2e-3) -> int:
    """Samples after which every drive repeats, 0 where it does not: the first valley of the mean squared difference
    between the drive and itself delayed."""
    span = np.ptp(drive, axis=1)
    moving = drive[span > 0]
    samples = drive.shape[1]
    if not moving.size or samples < 8:
        return 0
    scaled = moving / span[span > 0][:, None]
    lags = np.arange(1, samples // 2 + 1)
    correlation = np.sum([correlation_of(part, lags.size + 1) for part in scaled], axis=0)
    power = np.concatenate([[0], np.cumsum((scaled**2).sum(axis=0))])
    distance = (power[-1] - power[lags] + power[samples - lags] - 2 * correlation[lags]) / (samples - lags)
    low = np.flatnonzero(distance < tolerance**2)
    risen = low[low > np.argmax(distance >= tolerance**2)] if distance.max() >= tolerance**2 else low[:0]
    if not risen.size:
        return 0
    valley = risen[: np.argmax(np.diff(risen, append=risen[-1] + 2) > 1) + 1]
    return int(lags[valley[np.argmin(distance[valley])]])


def correlation_of(signal: Array, lags: int) -> Array:
    """Sums of products of a signal with itself so many samples later, from lag 0 on: (lags,)."""
    least = signal.size + lags  # what is later than the end is zero
    power = 2 ** int(np.ceil(np.log2(least)))
    size = power if least > 3 * power // 4 else 3 * power // 4
    lines = np.fft.rfft(signal, size)
    return np.asarray(np.fft.irfft(lines.real**2 + lines.imag**2, size)[:lags])
