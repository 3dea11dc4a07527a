"""Effects that are lines of the spectrum, over time or over the displacement: seen in their own band whatever is left
elsewhere, or harmonics of the drive, which the stage itself may make."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.periods import period_of
from pzt_ident.data.quantiser import common_step
from pzt_ident.data.record import Record
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.criteria import CLEAR, removed_rms
from pzt_ident.diagnosis.fit import Fit
from pzt_ident.diagnosis.modes import values_of
from pzt_ident.model.registry import blocks, word_of

Array = NDArray[np.float64]

NEAR = 4  # frequencies of a record on either side of a line that are its band, and at most half of its own
SIDES = 3, 4, 5, 6, 7, 8  # frequencies of a record on either side of a line that are beside it in a Hann window
OWN = 0.9  # of the misfit of its band: what a line takes up that is one
LOUD = 10.0  # times the noise in its band: a line that is told from it
FEWEST = 3  # periods of a line in a record that shows it
COUNTS = 3.5  # of the sensor in a period of a line over the displacement, which may be that of the counts
FEW_PERIODS = 2.5  # in a stroke: as many has what a curve of the reading leaves of a fit
LOWEST = 8  # harmonics of a drive up to this one are those that a stage makes


@dataclass(frozen=True)
class Line:
    """A line of the spectrum of what is measured on an axis. row: of the axis among the measured ones. wave: periods in
    a second, or in a metre of displacement."""

    row: int
    wave: float
    over_time: bool


def is_own_line(case: Case, without: Fit, now: Fit, effect: str) -> bool:
    """Whether an effect is a line of the spectrum, over time or displacement, and takes up nearly all of the misfit of
    its band on the identification and on the validation records: nothing else is in the place of that. Over time the
    stage itself moves less there, or has no line of its own."""
    lines = lines_of(now, effect)
    if not lines or removed_rms(without.identify, now.identify) < CLEAR * case.floor:
        return False
    before, after = in_band(case, without, lines), in_band(case, now, lines)
    if before.shape[1] < len({record.use for record in case.records}):
        return False
    (left, noise, moved), rest = before, np.maximum(after[0] - after[1], 0)
    return bool(((left > LOUD * noise) & (rest < (1 - OWN) * (left - noise)) & (moved < left)).all())


def in_band(case: Case, fit: Fit, lines: Sequence[Line]) -> Array:
    """Mean squares a frequency in the bands of some lines of what a fit leaves, of the noise, and, of lines over time
    that do not stand alone, of the response of its model, in units of the loss: (3, uses that show a line)."""
    powers: dict[str, list[list[float]]] = {}
    for record, errors in fit.problem.errors(fit.point):
        left = errors[:, record.settle :] / fit.problem.sizes[:, None]
        moved = (record.response[[*record.measured]] + errors)[:, record.settle :]
        for line in lines:
            course = record.elapsed[record.settle :] if line.over_time else moved[line.row]
            if np.ptp(course) * line.wave >= FEWEST:
                motion = moved[line.row] / fit.problem.sizes[line.row] if line.over_time else np.zeros(course.size)
                signals = np.array([left[line.row], motion])
                rest, motion_power = power_near(signals, course, line.wave).tolist()
                if line.over_time and stands_alone(signals, course, line.wave):
                    motion_power = 0.0
                row = [rest, float(case.floors[line.row] ** 2), motion_power]
                powers.setdefault(record.use, []).append(row)
    return np.array([np.mean(rows, axis=0) for rows in powers.values()]).reshape(-1, 3).T


def stands_alone(signals: Array, course: Array, wave: float) -> bool:
    """Whether the first of two signals (2, samples) is a line and the second is none there: what the form of a model
    leaves has the spectrum of its motion."""
    if np.ptp(course) * wave < 2 * SIDES[-1]:
        return False
    powers = powers_near(signals, course, wave, np.array([*-np.array(SIDES[::-1]), -1, 0, 1, *SIDES]))
    sides, peak = np.delete(powers, slice(len(SIDES), len(SIDES) + 3), axis=0), powers[len(SIDES) : len(SIDES) + 3]
    of_line, of_motion = peak.mean(axis=0) / np.maximum(sides.mean(axis=0), np.finfo(float).tiny)
    return bool(of_line > LOUD * max(of_motion, 1.0))


def power_near(signals: Array, course: Array, wave: float) -> Array:
    """Mean square a frequency of signals (signals, samples) in the band of a line over a course, (samples,)."""
    places = np.arange(-NEAR, NEAR + 1)
    places = places[np.abs(places) <= np.ptp(course) * wave / 2]
    return np.asarray(powers_near(signals, course, wave, places).mean(axis=0))


def powers_near(signals: Array, course: Array, wave: float, places: NDArray[np.int_]) -> Array:
    """Squares of signals (signals, samples) at places beside a line over a course, (samples,), counted in frequencies
    of the record, (places, signals). Each stretch counts as it is long, in a Hann window; that of white noise is its
    mean square."""
    span = np.ptp(course)
    weights = np.abs(np.gradient(course)) * np.sin(np.pi * (course - course.min()) / span) ** 2
    weighted = (signals - np.average(signals, axis=1, weights=weights)[:, None]) * weights
    waves = wave + places / span
    lines = np.array([weighted @ np.exp(-2j * np.pi * each * course) for each in waves])  # one by one: records are long
    return np.asarray(np.abs(lines) ** 2 / np.sum(weights**2))


def harmonic_of_the_drive(fit: Fit, effect: str) -> int:
    """Which low harmonic of the drives a line of the spectrum is, the lowest one; 0 where it is none in one record."""
    frequencies = [line.wave for line in lines_of(fit, effect) if line.over_time]
    orders = (order_of(record, frequency) for frequency in frequencies for record in fit.problem.records)
    return min(orders, default=0)


def is_of_the_counts(fit: Fit, effect: str) -> bool:
    """Whether a line over the displacement has a period of few counts of the sensor: the rounding of readings to whole
    counts is such a line and its harmonics."""
    lines = [line for line in lines_of(fit, effect) if not line.over_time]
    measured = fit.problem.model.measured

    def count(row: int) -> float:
        return common_step([record.response[measured[row]] for record in fit.problem.records])

    return any(1 / line.wave < COUNTS * count(line.row) for line in lines)


def has_few_periods(fit: Fit, effect: str) -> bool:
    """Whether a line over the displacement has few periods in the largest stroke of each axis."""
    lines = [line for line in lines_of(fit, effect) if not line.over_time]
    measured = fit.problem.model.measured

    def stroke(row: int) -> float:
        return max(float(np.ptp(record.response[measured[row]])) for record in fit.problem.records)

    return bool(lines) and all(line.wave * stroke(line.row) < FEW_PERIODS for line in lines)


def order_of(record: Record, frequency: float) -> int:
    """Which low harmonic of the drive of a record a frequency is, as near as its length can tell; 0 for none."""
    period = period_of(record.drive)
    order = frequency * period * record.dt
    near = abs(order - round(order)) <= period / record.samples
    return round(order) if near and round(order) <= LOWEST else 0


def lines_of(fit: Fit, effect: str) -> list[Line]:
    """The lines that an effect is, one a measured axis; none for another one."""
    name, model = blocks[effect].line, fit.problem.model
    entries = [entry for entry in model.entries if name and entry.block.name == word_of(effect) and entry.word == name]
    values, lines = values_of(fit) if entries else {}, []
    for entry in entries:
        if entry.axis in model.measured:
            over_time, value = entry.parameter.unit == "Hz", values[entry.name]
            lines.append(Line(model.measured.index(entry.axis), value if over_time else 1 / value, over_time))
    return lines
