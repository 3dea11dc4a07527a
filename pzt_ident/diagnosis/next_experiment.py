"""The drive that tells rivals apart best, within what the rig may do."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.record import Record
from pzt_ident.diagnosis.refit import Case, Fit
from pzt_ident.engine.simulator import Simulator

Array = NDArray[np.float64]

CHIRP = (20.0, 2000.0)  # Hz
BEYOND = 6000.0  # Hz, beyond the resonances of a stage
HOLD = 20.0  # s
LEAST, FAINT, AMPLE = 0.3, 1.0, 3.0  # noise floors between two rivals: told apart, well, and more is no better


@dataclass(frozen=True)
class Reach:
    """What the rig may do with an axis: drive, SI units, its rate, a second, and the length of a record, s."""

    low: float
    high: float
    rate: float
    duration: float


@dataclass(frozen=True)
class Proposal:
    """drive: (axes, samples), SI units. apart: least rms difference between two rivals, in noise floors."""

    name: str
    why: str
    splits: tuple[str, ...]
    dt: float
    drive: Array
    apart: float


def propose(case: Case, rivals: dict[str, Fit], reaches: Sequence[Reach]) -> Proposal | None:
    """Simulate all rivals on each protocol, within the reach of each axis; the one that tells the most of them apart,
    the closest two by the most.

    None where no protocol within reach tells any two of them apart.
    """
    best: Proposal | None = None
    most = (0.0, 0.0)
    alike = drives_of(case.records)
    apart = [reaches[list(alike).index(drive)] for drive in range(alike.max() + 1)]
    for name, why, dt, own in protocols(apart, alike[case.records[0].measured[0]]):
        drive = own[alike]
        responses = [respond(case, fit, dt, drive) for fit in rivals.values()]
        pairs = [float(np.sqrt(np.mean((a - b) ** 2))) / case.floor for a, b in combinations(responses, 2)]
        told = (sum(min(apart, AMPLE) for apart in pairs if apart > LEAST), min(pairs))
        if np.isfinite(pairs).all() and told[0] > 0 and told > most:
            best, most = Proposal(name, why, tuple(rivals), dt, drive, min(pairs)), told
    return best


def drives_of(records: Sequence[Record]) -> NDArray[np.intp]:
    """The number of each axis' drive: that of an earlier axis where every record moves both alike, as it does where
    two responses of one drive are measured."""
    whole = np.hstack([record.drive for record in records])
    first = [next(a for a, other in enumerate(whole) if np.array_equal(other, drive)) for drive in whole]
    return np.unique(first, return_inverse=True)[1]


def respond(case: Case, fit: Fit, dt: float, drive: Array) -> Array:
    """Response of the first measured axis about its mean, in units of the loss."""
    first = case.records[0]
    blank: Record = replace(first, dt=dt, drive=drive, response=np.zeros_like(drive), settle=0, run_in=0)
    found = Simulator(fit.problem.model, blank).simulate(fit.problem.parameters(fit.point))[0, 0] / case.error_scales[0]
    return found - found.mean()


def protocols(reaches: Sequence[Reach], axis: int) -> Iterator[tuple[str, str, float, Array]]:
    """Name, what it shows, sample time and drives of each protocol, which moves one axis alone."""
    reach = reaches[axis]
    quick = quickest(reach)
    own = [
        ("slow triangles", "rate and creep play no part", 1e-3, turns(reach, [1, 0] * 3, min(0.5, quick), 1e-3)),
        ("two rates", "a lag grows with the rate, hysteresis with its logarithm", 1e-4, two_rates(reach, quick, 1e-4)),
        ("steps and holds", "creep follows the step, relaxation stops after a small step back, drift does not care",
         1e-2, holds(reach, [0.6, 0.57, 0.3, 0.9, 0.1], 1e-2)),
        ("nested loops", "memory closes its loops, a gain does not", 1e-3,
         turns(reach, [1, 0.2, 0.8, 0.3, 0.7, 0.4, 0.7, 0.3, 0.8, 0.2, 1, 0], min(0.5, quick), 1e-3)),
        ("two amplitudes", "a gain that grows with the amplitude, or bends", 1e-3,
         turns(reach, [0.4, 0, 0.4, 0, 1, 0, 1, 0], min(0.5, quick), 1e-3)),
        ("small chirp", "phase against frequency: delay, lag and modes part", 5e-5, chirp(reach, CHIRP, 2.0, 5e-5)),
    ]  # fmt: skip
    for name, why, dt, u in own:
        yield from bounded(reaches, name, why, dt, u, axis)
    for other, theirs in enumerate(reaches):
        if other == axis or theirs.high <= theirs.low:
            continue
        slow = turns(theirs, [1, 0] * 2, min(0.5, quickest(theirs)), 1e-3)
        yield from bounded(reaches, "the other axis alone", "what comes through a coupling", 1e-3, slow, other)
        fast = chirp(theirs, (CHIRP[0], BEYOND), 1.0, 2e-5)
        why = "couplings ring at different modes"
        yield from bounded(reaches, "chirp of the other axis", why, 2e-5, fast, other)


def quickest(reach: Reach) -> float:
    """Cycles a second over the whole range that the rate allows."""
    return min(reach.rate / (2 * (reach.high - reach.low)), 50.0)


def bounded(
    reaches: Sequence[Reach], name: str, why: str, dt: float, u: Array, axis: int
) -> Iterator[tuple[str, str, float, Array]]:
    u = u[: int(reaches[axis].duration / dt)]
    if u.size > 100:
        rest = np.array([min(max(0.0, reach.low), reach.high) for reach in reaches])
        drive = np.tile(rest[:, None], u.size)
        drive[axis] = u
        yield name, why, dt, drive


def two_rates(reach: Reach, quick: float, dt: float) -> Array:
    """A slow cycle in two thirds of the time at most and five quick ones; nothing where the rates are not apart."""
    slow = max(quick / 30, 1.5 / reach.duration)
    if quick < 3 * slow or 5 / quick > reach.duration / 3:
        return np.zeros(0)
    return np.concatenate([turns(reach, [1, 0], slow, dt), turns(reach, [1, 0] * 5, quick, dt)])


def turns(reach: Reach, levels: list[float], frequency: float, dt: float) -> Array:
    """Ramps between shares of the range, a full range in half a period."""
    speed = 2 * frequency * (reach.high - reach.low)
    corners = reach.low + (reach.high - reach.low) * np.array([0.0, *levels])
    times = np.concatenate([[0], np.cumsum(np.abs(np.diff(corners)) / speed)])
    return np.interp(np.arange(0, min(times[-1], reach.duration), dt), times, corners)


def holds(reach: Reach, levels: list[float], dt: float) -> Array:
    """Ramps as fast as is allowed, each held."""
    span = reach.high - reach.low
    times, corners = [0.0, 1.0], [reach.low, reach.low]
    hold = min(HOLD, reach.duration / (len(levels) + 1))
    for level in levels:
        corner = reach.low + span * level
        there = times[-1] + max(abs(corner - corners[-1]) / reach.rate, dt)
        times += [there, there + hold]
        corners += [corner, corner]
    return np.interp(np.arange(0, min(times[-1], reach.duration), dt), times, corners)


def chirp(reach: Reach, band: tuple[float, float], longest: float, dt: float) -> Array:
    """A few percent of the range about its middle, logarithmic in frequency, less where the rate asks for it."""
    seconds, middle = min(longest, reach.duration / 2), (reach.low + reach.high) / 2
    t = np.arange(0, seconds, dt)
    growth = np.log(band[1] / band[0]) / seconds
    frequency = band[0] * np.exp(growth * t)
    size = np.minimum(0.03 * (reach.high - reach.low), 0.9 * reach.rate / (2 * np.pi * frequency))
    ramp = np.arange(reach.low, middle, reach.rate * dt)
    return np.concatenate([ramp, middle + size * np.sin(2 * np.pi * (frequency - band[0]) / growth)])
