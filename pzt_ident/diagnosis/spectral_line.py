"""Effects that are lines of the spectrum: seen in their own band whatever is left elsewhere, or harmonics of the drive,
which the stage itself may make."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.periods import period_of
from pzt_ident.data.record import Record
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.criteria import CLEAR, removed_rms
from pzt_ident.diagnosis.fit import Fit
from pzt_ident.diagnosis.modes import values_of
from pzt_ident.model.registry import blocks, word_of

Array = NDArray[np.float64]

NEAR = 4  # frequencies of a record on either side of a line that are its band
OWN = 0.9  # of the misfit of its band: what a line takes up that is one
LOUD = 10.0  # times the noise in its band: a line that is told from it
LOWEST = 8  # harmonics of a drive up to this one are those that a stage makes


def is_own_line(case: Case, without: Fit, now: Fit, effect: str) -> bool:
    """Whether an effect is a line of the spectrum, takes up nearly all of the misfit of its band on the identification
    and on the validation records, and the stage moves less there: nothing else is in the place of that."""
    frequencies = frequencies_of(now, effect)
    if not frequencies or removed_rms(without.identify, now.identify) < CLEAR * case.floor:
        return False
    before, noise, moved = in_band(case, without, frequencies)
    after, _, _ = in_band(case, now, frequencies)
    seen = before > LOUD * noise
    left = np.maximum(after - noise, 0)
    return bool((seen & (left < (1 - OWN) * (before - noise)) & (moved < before)).all())


def in_band(case: Case, fit: Fit, frequencies: list[float]) -> Array:
    """Mean squares in the bands of some frequencies of what a fit leaves, of the noise, and of the response of its
    model, in units of the loss: (3, uses)."""
    powers: dict[str, list[list[float]]] = {}
    for record, errors in fit.problem.errors(fit.point):
        sizes, measured = fit.problem.sizes[:, None], list(record.measured)
        left = errors[:, record.settle :] / sizes
        moved = record.response[measured][:, record.settle :] / sizes + left
        band = bands(record, left.shape[1], frequencies)
        noise = float(np.mean(case.floors**2)) * float(np.mean(band))
        powers.setdefault(record.use, []).append([power_in(left, band), noise, power_in(moved, band)])
    return np.array([np.mean(rows, axis=0) for rows in powers.values()]).T


def bands(record: Record, samples: int, frequencies: list[float]) -> NDArray[np.bool_]:
    """Which frequencies of a record are near some others."""
    lines = np.fft.rfftfreq(samples, record.dt)
    width = NEAR / (samples * record.dt)
    return np.asarray(np.any([np.abs(lines - frequency) <= width for frequency in frequencies], axis=0))


def power_in(signals: Array, band: NDArray[np.bool_]) -> float:
    """Mean square of signals, (signals, samples), in a band."""
    window = np.hanning(signals.shape[1])
    lines = np.fft.rfft((signals - signals.mean(axis=1, keepdims=True)) * window, axis=1)[:, band]
    return float(2 * np.mean((np.abs(lines) ** 2).sum(axis=1)) / (signals.shape[1] * (window**2).sum()))


def harmonic_of_the_drive(fit: Fit, effect: str) -> int:
    """Which low harmonic of the drives a line of the spectrum is, the lowest one; 0 where it is none in one record."""
    if not (frequencies := frequencies_of(fit, effect)):
        return 0
    return min(order_of(record, frequency) for record in fit.problem.records for frequency in frequencies)


def order_of(record: Record, frequency: float) -> int:
    """Which low harmonic of the drive of a record a frequency is, as near as its length can tell; 0 for none."""
    period = period_of(record.drive)
    order = frequency * period * record.dt
    near = abs(order - round(order)) <= period / record.samples
    return round(order) if near and round(order) <= LOWEST else 0


def frequencies_of(fit: Fit, effect: str) -> list[float]:
    """The frequencies of an effect with an amount of its own in each record, Hz, one an axis; none for another one."""
    if not any(parameter.per_record for parameter in blocks[effect].parameters().values()):
        return []
    own = [entry for entry in fit.problem.model.entries if entry.block.name == word_of(effect)]
    values = values_of(fit)
    return [values[entry.name] for entry in own if entry.word == "frequency"]
