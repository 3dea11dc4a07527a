"""The noise floor of a response: the part that no model can explain."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.decimals import last_decimal
from pzt_ident.data.evidence import (
    LONG,
    Estimate,
    alike,
    mean_deviation,
    of_one_noise,
    period_noise,
    quiet_deviation,
    rest_noise,
    still_rests,
)
from pzt_ident.data.projections import deviation, without_lines
from pzt_ident.data.quantiser import common_step, errors_of_readings, with_quantiser
from pzt_ident.data.record import Record
from pzt_ident.data.units import common_unit, factor, of_one_kind
from pzt_ident.data.windows import Signal, window_noise

Array = NDArray[np.float64]

ROUNDING, UNSEEN = 1e-9, 1e-4  # of the span of a response: what is less is no noise; what stands for it then
LEAST_SCALE = 5e-3  # of the span of a response
COARSE = 2.2  # times the noise at rest: a step of the readings of which a rest sees few or none
LIKE = 1.5  # times that noise: what windows may say instead, in which the response goes through many steps
SAME_CLOCK = 0.1  # sample times: records that are farther apart at their ends were not sampled alike
HALF = 0.51  # of a decimal, by which a rounded value is beside it
WEAK = "short windows (weak)"  # the source of a floor that is taken while the stage moves
APART = 8.0  # times such a floor: rests that are not scored and differ by more are not of the noise of what is scored
CHANGED = 3.0  # times the noise at rest: what repeated records differ by more is a stage that changed


class Floor(NamedTuple):
    """Standard deviation of the noise, SI units, and what it was taken from."""

    value: float
    source: str


def noise_floor(records: list[Record], axis: int) -> Floor:
    """Noise of an axis, from the best evidence there is: repeated records, rest segments, repeated periods, rests that
    are not scored, else short windows. Where repeated records differ far more than a rest is noisy, the stage changed
    between them, which a model may explain. Readings of a formula have none, for which a part of their range stands.

    The noise is the sensor's, the same in all records, and what a stage adds, such as ringing, only makes an estimate
    larger: those that are clearly above the quietest are left out, and where those of the quietest quarter are not
    alike, windows may know better. A quantiser adds its own. Windows are weak evidence: they take slow noise for
    signal, and fast signal that does not follow the drive for noise.
    """
    found, span = evident_floor(records, axis), max(r.swings[axis] for r in records)
    return found if found.value > ROUNDING * span else Floor(UNSEEN * span, "no noise: 1e-4 of the range")


def evident_floor(records: list[Record], axis: int) -> Floor:
    """The same by that evidence alone, 0 where the readings have no noise at all."""
    signals = [Signal(r.drive[:, r.settle :], r.response[axis, r.settle :], r.dt) for r in records]
    step = common_step([r.response[axis] for r in records])
    repeats, still = floor_of_repeats(records, axis, step), floor_of_rests(signals, signals, step)
    if repeats and still and repeats.value > CHANGED * still.value:
        times = repeats.value / still.value
        return Floor(still.value, f"{still.source}; repeated records differ {times:.2g} times as much")
    known = repeats or still or floor_of_periods(signals, step)
    return known or floor_of_unscored(records, axis, signals, step)


def floor_of_unscored(records: list[Record], axis: int, signals: list[Signal], step: float) -> Floor:
    """By rests that are not scored, or in windows where these say something else altogether: ahead of what is scored a
    recorder may not have begun, or a stage not have settled."""
    whole = [Signal(r.drive, r.response[axis], r.dt) for r in records]
    still, moving = floor_of_rests(whole, signals, step), weak_floor(signals, step)
    if still is None or not moving.value / APART <= still.value <= APART * moving.value:
        return moving
    return Floor(still.value, f"{still.source} that are not scored")


def floor_of_repeats(records: list[Record], axis: int, step: float) -> Floor | None:
    """By the differences of records with the same drives; None where there are none."""
    pairs = [(r, other) for i, r in enumerate(records) for other in records[:i] if is_repeat(r, other, axis)]
    if not pairs:
        return None
    changes = [(a.response[axis] - b.response[axis])[max(a.settle, b.settle) :] for a, b in pairs]
    variances = [deviation(*without_lines(change, 1)) ** 2 / 2 for change in changes]
    return floor_of(with_quantiser(np.sqrt(np.mean(variances)), step), "repeated records", step)


def floor_of_rests(resting: list[Signal], signals: list[Signal], step: float) -> Floor | None:
    """By rests; where all of them are short, so that they may hold lines, by what is quieter of these and the stage in
    motion. None where there are fewer than LONG samples of them."""
    rests = [(rest, dt) for drives, response, dt in resting for rest in still_rests(drives, response)]
    if sum(rest.noise.size for rest, _ in rests) < LONG:
        return None
    seconds = np.array([rest.noise.size * dt for rest, dt in rests])
    parts = rest_noise([rest for rest, _ in rests], seconds, step)
    still = floor_by([(part, dt) for part, (_, dt) in zip(parts, rests, strict=True)], "rest segments", signals, step)
    short = all(rest.is_short for rest, _ in rests)
    return min(still, floor_in_motion(signals, step)) if short else still


def floor_in_motion(signals: list[Signal], step: float) -> Floor:
    return floor_of_periods(signals, step) or weak_floor(signals, step)


def floor_of_periods(signals: list[Signal], step: float) -> Floor | None:
    """By repeated periods; None where there are none."""
    found = [(part, dt) for drives, response, dt in signals for part in period_noise(drives, response)]
    return floor_by(found, "repeated periods", signals, step) if found else None


def weak_floor(signals: list[Signal], step: float) -> Floor:
    """By two periods or in short windows."""
    return min(floor_of_two_periods(signals, step), floor_in_windows(signals, step))


def floor_by(found: list[tuple[Estimate, float]], source: str, signals: list[Signal], step: float) -> Floor:
    """The floor by estimates, or in windows where steps of the readings are too coarse for a rest to tell, or the
    estimates are not alike."""
    scatters, seconds, spreads = np.array([(part.value, part.samples * dt, part.spread) for part, dt in found]).T
    values = errors_of_readings(scatters, seconds, step)
    kept = of_one_noise(values, seconds, spreads)
    still = floor_of(mean_deviation(values[kept], seconds[kept]), source, step)
    if step > COARSE * still.value:
        moving = floor_in_windows(signals, step)
        return moving if moving.value < LIKE * still.value else still
    return still if alike(values, seconds) else min(still, floor_in_windows(signals, step))


def floor_of_two_periods(signals: list[Signal], step: float) -> Floor:
    """By the difference of the only two periods of records, of which the first may have begun elsewhere: the noise is
    no more than this; infinite where no record has two."""
    found = [part for drives, response, _ in signals for part in period_noise(drives, response, 2)]
    values, samples = (np.array([getattr(part, word) for part in found], float) for word in ("value", "samples"))
    return floor_of(with_quantiser(quiet_deviation(values, samples), step) if found else np.inf, "two periods", step)


def floor_in_windows(signals: list[Signal], step: float) -> Floor:
    return floor_of(window_noise(signals, with_quantiser(0.0, step)), WEAK, step)


def floor_of(value: float, source: str, step: float) -> Floor:
    """The floor of a standard deviation, the quantiser's where it is less than what is left besides."""
    return Floor(float(value), "quantiser" if value <= step / np.sqrt(6) else source)


def is_repeat(record: Record, other: Record, axis: int, tolerance: float = 2e-3) -> bool:
    """Whether all drives differ by no more than a share of their spans; the same data listed twice are no repeat, nor a
    copy that was rounded."""
    apart = abs(record.dt - other.dt) * record.samples  # at their ends, where both clocks start together
    if record.drive.shape != other.drive.shape or apart > SAME_CLOCK * record.dt:
        return False
    span = np.ptp(record.drive, axis=1)
    alike = bool((np.abs(record.drive - other.drive).max(axis=1) <= tolerance * span).all())
    return alike and not is_copy(record.response[axis], other.response[axis])


def is_copy(response: Array, other: Array) -> bool:
    """Whether two responses differ by no more than the rounding of one of them to its last decimal."""
    apart = float(np.abs(response - other).max())
    return apart == 0 or any(apart <= HALF * last_decimal(each, np.ptp(each)) for each in (response, other))


def error_scales(records: list[Record]) -> Array:
    """What the errors of each measured axis are divided by in the loss, (measured axes,): 1 where the responses are of
    one kind, else their noise floors, and at least LEAST_SCALE of their spans, since an integrated charge is smooth far
    below the error of any model."""
    if of_one_kind(list(records[0].units.values())):
        return np.ones(len(records[0].measured))
    spans = np.array([max(record.swings[axis] for record in records) for axis in records[0].measured])
    floors = np.array([noise_floor(records, axis).value for axis in records[0].measured])
    return np.maximum(floors, LEAST_SCALE * spans)


def pooled_floor(records: list[Record]) -> float:
    """Noise floor of all measured axes together, in units of the loss."""
    return _pooled([noise_floor(records, axis).value for axis in records[0].measured], records)


def _pooled(floors: list[float], records: list[Record]) -> float:
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
        "floor": _pooled([floor.value for floor in floors.values()], records) / factor(unit),
    }
