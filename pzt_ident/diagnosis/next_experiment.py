"""The drive that separates rival models best, within the limits of the rig."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.record import Record
from pzt_ident.diagnosis.case import Case
from pzt_ident.diagnosis.fit import Fit
from pzt_ident.engine.simulator import Simulator

Array = NDArray[np.float64]

CHIRP = (20.0, 2000.0)  # Hz
COUPLING_CHIRP = (20.0, 6000.0)  # Hz, to beyond the resonances of a stage
HOLD = 20.0  # s
MOST_SAMPLES = 100_000  # of a drive: what takes more is too slow a rig for it
SEPARATED, WELL_SEPARATED, AMPLE = 0.3, 1.0, 3.0  # noise floors between two rivals; more than AMPLE is no better


@dataclass(frozen=True)
class DriveLimits:
    """What the rig allows on an axis: range of the drive, SI units, its rate, 1/s, and the length of a record, s."""

    low: float
    high: float
    rate: float
    duration: float

    @property
    def span(self) -> float:
        return self.high - self.low


class Protocol(NamedTuple):
    """A drive that moves one axis: its name, sample time dt, s, and the drives, (axes, samples)."""

    name: str
    dt: float
    drive: Array


@dataclass(frozen=True)
class Proposal:
    """A protocol for all axes, the rivals that it splits, and the least rms difference between two of them, in noise
    floors. drive: (axes, samples), SI units."""

    name: str
    splits: tuple[str, ...]
    dt: float
    drive: Array
    separation: float


def propose(case: Case, rivals: dict[str, Fit], limits: Sequence[DriveLimits]) -> Proposal | None:
    """Simulate all rivals on each protocol within the limits of each axis. The best has the largest sum of separations
    of two rivals, each counted from SEPARATED and up to AMPLE noise floors, then the largest least separation.

    None where no protocol separates any two of them.
    """
    best: Proposal | None = None
    best_rank = (0.0, 0.0)
    drive_of_axis = drives_of(case.records)
    drive_limits = [limits[list(drive_of_axis).index(drive)] for drive in range(drive_of_axis.max() + 1)]
    for name, dt, drives in protocols(drive_limits, drive_of_axis[case.records[0].measured[0]]):
        drive = drives[drive_of_axis]
        responses = [respond(case, fit, dt, drive) for fit in rivals.values()]
        separations = [float(np.sqrt(np.mean((a - b) ** 2))) / case.floor for a, b in combinations(responses, 2)]
        least = min(separations)
        rank = (sum(min(separation, AMPLE) for separation in separations if separation > SEPARATED), least)
        if np.isfinite(separations).all() and rank[0] > 0 and rank > best_rank:
            best, best_rank = Proposal(name, tuple(rivals), dt, drive, least), rank
    return best


def drives_of(records: Sequence[Record]) -> NDArray[np.intp]:
    """The number of each axis' drive, (axes,); axes whose drives are equal in every record, as where two responses of
    one drive are measured, have the same."""
    drives = np.hstack([record.drive for record in records])
    first = [next(axis for axis, other in enumerate(drives) if np.array_equal(other, drive)) for drive in drives]
    return np.unique(first, return_inverse=True)[1]


def respond(case: Case, fit: Fit, dt: float, drive: Array) -> Array:
    """Response of the first measured axis about its mean, in units of the loss: (samples,)."""
    first = case.records[0]
    record: Record = replace(first, dt=dt, drive=drive, response=np.zeros_like(drive), settle=0, run_in=0, rest_at=())
    simulator = Simulator(fit.problem.model, record)
    response = simulator.simulate(fit.problem.parameters(fit.point))[0, 0] / case.error_scales[0]
    return response - response.mean()


def protocols(limits: Sequence[DriveLimits], axis: int) -> Iterator[Protocol]:
    """The protocols that move the axis alone, and those that move each other axis alone."""
    for protocol in axis_protocols(limits[axis]):
        yield from on_axis(limits, protocol, axis)
    for other, other_limits in enumerate(limits):
        if other != axis and other_limits.high > other_limits.low:
            for protocol in coupling_protocols(other_limits):
                yield from on_axis(limits, protocol, other)


def axis_protocols(limits: DriveLimits) -> list[Protocol]:
    """The protocols of the measured axis, drives of shape (samples,)."""
    fast = fastest_cycles(limits)
    slow, fine = min(0.5, fast), max(1e-4, 1e-3 / fast)
    coarse = max(1e-3, 5e-4 / slow)
    nested = [1, 0.2, 0.8, 0.3, 0.7, 0.4, 0.7, 0.3, 0.8, 0.2, 1, 0]
    return [
        Protocol("slow triangles", coarse, ramps(limits, [1, 0] * 3, slow, coarse)),
        Protocol("two rates", fine, two_rates(limits, fast, fine)),
        Protocol("steps and holds", 1e-2, holds(limits, [0.6, 0.57, 0.3, 0.9, 0.1], 1e-2)),
        Protocol("nested loops", coarse, ramps(limits, nested, slow, coarse)),
        Protocol("two amplitudes", coarse, ramps(limits, [0.4, 0, 0.4, 0, 1, 0, 1, 0], slow, coarse)),
        Protocol("small chirp", 5e-5, chirp(limits, CHIRP, 2.0, 5e-5)),
    ]


def coupling_protocols(limits: DriveLimits) -> Iterator[Protocol]:
    """The protocols of another axis than the measured one, drives of shape (samples,)."""
    slow = min(0.5, fastest_cycles(limits))
    coarse = max(1e-3, 5e-4 / slow)
    yield Protocol("the other axis alone", coarse, ramps(limits, [1, 0] * 2, slow, coarse))
    fast = chirp(limits, COUPLING_CHIRP, 1.0, 2e-5)
    yield Protocol("chirp of the other axis", 2e-5, fast)


def fastest_cycles(limits: DriveLimits) -> float:
    """The highest frequency of triangles over the whole range that the rate allows, and at most 50, Hz."""
    return min(limits.rate / (2 * limits.span), 50.0)


def on_axis(limits: Sequence[DriveLimits], protocol: Protocol, axis: int) -> Iterator[Protocol]:
    """The protocol on one axis, cut to the allowed duration, with the others at rest as near to 0 as allowed; nothing
    where fewer than 101 samples are left, or more than MOST_SAMPLES."""
    moving = protocol.drive[: int(limits[axis].duration / protocol.dt)]
    if 100 < moving.size <= MOST_SAMPLES:
        resting = np.array([min(max(0.0, item.low), item.high) for item in limits])
        drive = np.tile(resting[:, None], moving.size)
        drive[axis] = moving
        yield protocol._replace(drive=drive)


def two_rates(limits: DriveLimits, fast: float, dt: float) -> Array:
    """A slow cycle, in two thirds of the time at most, and five fast ones; nothing where the rates are too close."""
    slow = max(fast / 30, 1.5 / limits.duration)
    if fast < 3 * slow or 5 / fast > limits.duration / 3:
        return np.zeros(0)
    return np.concatenate([ramps(limits, [1, 0], slow, dt), ramps(limits, [1, 0] * 5, fast, dt)])


def ramps(limits: DriveLimits, levels: list[float], frequency: float, dt: float) -> Array:
    """Ramps between shares of the range, the full range in half a period of the frequency, Hz."""
    speed = 2 * frequency * limits.span
    corners = limits.low + limits.span * np.array([0.0, *levels])
    times = np.concatenate([[0], np.cumsum(np.abs(np.diff(corners)) / speed)])
    return np.interp(np.arange(0, min(times[-1], limits.duration), dt), times, corners)


def holds(limits: DriveLimits, levels: list[float], dt: float) -> Array:
    """The fastest ramps to shares of the range, with a hold after each."""
    times, corners = [0.0, 1.0], [limits.low, limits.low]
    hold = min(HOLD, limits.duration / (len(levels) + 1))
    for level in levels:
        corner = limits.low + limits.span * level
        arrival = times[-1] + max(abs(corner - corners[-1]) / limits.rate, dt)
        times += [arrival, arrival + hold]
        corners += [corner, corner]
    return np.interp(np.arange(0, min(times[-1], limits.duration), dt), times, corners)


def chirp(limits: DriveLimits, band: tuple[float, float], longest: float, dt: float) -> Array:
    """A logarithmic chirp of 3 % of the range about its middle, smaller where the rate limits it; band: Hz."""
    seconds, middle = min(longest, limits.duration / 2), (limits.low + limits.high) / 2
    t = np.arange(0, seconds, dt)
    growth = np.log(band[1] / band[0]) / seconds
    frequency = band[0] * np.exp(growth * t)
    amplitude = np.minimum(0.03 * limits.span, 0.9 * limits.rate / (2 * np.pi * frequency))
    ramp = np.arange(limits.low, middle, limits.rate * dt)
    return np.concatenate([ramp, middle + amplitude * np.sin(2 * np.pi * (frequency - band[0]) / growth)])
