"""The noise of responses while they move: what smooth curves and the drives leave of short windows."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.evidence import quiet, quiet_deviation
from pzt_ident.data.projections import MOST_MEMORY, expected_products, memory_of

Array = NDArray[np.float64]

LENGTHS = (16, 24, 32, 48, 64, 96, 128, 192, 256, 384, 512)  # samples
WITH_DRIVES = 64  # samples: the longest windows in which a response follows its drives in straight lines
DEGREE = 4  # of the polynomials in a window
STRETCH = 64  # samples: shorter windows are quiet together, since one alone is so by chance
MOST = 200  # windows of a length: more are not looked at
ROUGHER = 2.0  # times its signals a remainder may be, since not all noise has a memory of first order
LEAST = 8  # quiet stretches or windows: fewer are chance
DEPENDENT = 1e-6  # of the largest singular value: columns of less are one
TYPICAL = 8  # windows whose bases stand for all


class Signal(NamedTuple):
    """Drives, (drives, samples), a response, (samples,), and the time from sample to sample."""

    drives: Array
    response: Array
    dt: float


class Remainder(NamedTuple):
    """What is left of noise in windows: its standard deviation before, its memory from sample to sample, and the share
    of its variance that is left."""

    deviation: float
    memory: float
    share: float

    @property
    def roughness(self) -> float:
        """Standard deviation s (1 - 3 a / 2 + 3 a^2 / 5 - a^3 / 10)^0.5 of the white noise whose third differences are
        as large as of noise s of memory a."""
        return self.deviation * float(np.sqrt(np.polyval([-0.1, 0.6, -1.5, 1.0], self.memory)))


def window_noise(signals: list[Signal], least: float) -> float:
    """Standard deviation of the noise in all signals, which is at least that of their quantiser.

    Long windows leave signal and short ones take noise: of all lengths, with the drives and without, that one counts
    whose remainder over the square of the share in it is least. A remainder that is as alike from sample to sample as a
    signal, or rougher than its signals are, is none. Where all are so, the noise is taken for white.
    """
    white = max(roughness(signals), least)
    remainders = [remainder(signals, length, False) for length in LENGTHS]
    remainders += [remainder(signals, length, True) for length in LENGTHS if length <= WITH_DRIVES]
    noise = [part for part in remainders if part and part.memory < MOST_MEMORY and part.roughness <= ROUGHER * white]
    if not noise:
        return white
    chosen = min(noise, key=lambda part: max(part.deviation, least) / part.share**1.5)
    return max(chosen.deviation, least)


def remainder(signals: list[Signal], length: int, with_drives: bool) -> Remainder | None:
    """What polynomials, and the drives, leave in the quiet windows of a length; None where these are too few."""
    responses, seconds = windows(signals, length, [signal.response[None] for signal in signals])
    basis = np.asarray(np.polynomial.legendre.legvander(np.linspace(-1, 1, length), DEGREE), dtype=np.float64)[None]
    if with_drives:
        courses, _ = windows(signals, length, [courses_of(signal.drives) for signal in signals])
        basis = np.concatenate([np.broadcast_to(basis, (len(courses), *basis.shape[1:])), courses], axis=2)
    if not len(responses) or basis.shape[2] >= length:
        return None
    basis = directions_of(basis)
    noise = (responses - basis @ (basis.swapaxes(1, 2) @ responses))[..., 0]
    powers = np.square(noise).sum(axis=1)
    stretch = max(1, STRETCH // length)
    still = quiet(np.sqrt(powers.reshape(-1, stretch).sum(axis=1)), seconds[::stretch])
    if np.count_nonzero(still) < LEAST:
        return None
    kept = np.flatnonzero(np.repeat(still, stretch))
    power = np.average(powers[kept], weights=seconds[kept])
    if power == 0:
        return Remainder(0.0, 0.0, 1.0)
    alike = np.average((noise[kept, 1:] * noise[kept, :-1]).sum(axis=1), weights=seconds[kept])
    typical = basis[kept[:: -(-kept.size // TYPICAL)]] if with_drives else basis
    memory = memory_of(alike / power, typical)
    left = expected_products(typical, memory)[0] / len(typical)
    return Remainder(float(np.sqrt(power / left)), memory, left / length)


def directions_of(columns: Array) -> Array:
    """Orthonormal directions of columns, (windows, samples, columns), with zeros in the place of those that rounding
    alone would make: where a drive only rises, its path is the drive."""
    norms = np.linalg.norm(columns, axis=1, keepdims=True)
    directions, sizes, _ = np.linalg.svd(columns / np.where(norms, norms, 1.0), full_matrices=False)
    return np.where((sizes > DEPENDENT * sizes[:, :1])[:, None, :], directions, 0.0)


def windows(signals: list[Signal], length: int, rows: list[Array]) -> tuple[Array, Array]:
    """Windows of the rows of each signal, (windows, length, rows), side by side in stretches that are evenly spread
    where they are too many, and the time from sample to sample in each."""
    together = max(1, STRETCH // length)
    stretch = together * length
    parts = [part[:, : part.shape[1] // stretch * stretch].reshape(len(part), -1, stretch) for part in rows]
    dts = np.concatenate([np.full(part.shape[1], signal.dt) for part, signal in zip(parts, signals, strict=True)])
    step = max(1, -(-dts.size * together // MOST))
    spread = np.concatenate(parts, axis=1)[:, ::step]
    return spread.reshape(len(spread), -1, length).transpose(1, 2, 0), np.repeat(dts[::step], together)


def courses_of(drives: Array) -> Array:
    """What a response follows to first order where its drives are u: u itself, their path, the sum of |du|, since a
    hysteresis has one slope where it rises and another where it falls, and u a sample before, for a lag. (3 drives,
    samples)."""
    span = np.ptp(drives, axis=1, keepdims=True)
    scaled = drives / np.where(span, span, 1.0)
    before = np.hstack([scaled[:, :1], scaled[:, :-1]])
    return np.concatenate([scaled, np.abs(scaled - before).cumsum(axis=1), before])


def roughness(signals: list[Signal]) -> float:
    """Standard deviation of the white noise, the variance of whose third differences is 20 times its own, that is as
    rough as the quiet parts, of the least length, of the signals; 0 of 13 samples and fewer."""
    squares = [np.square(np.diff(signal.response, 3)) / 20 for signal in signals]
    parts = [
        (np.sqrt(part.mean()), part.size * signal.dt)
        for signal, square in zip(signals, squares, strict=True)
        if square.size > 10
        for part in np.array_split(square, max(1, square.size // LENGTHS[0]))
    ]
    return quiet_deviation(*np.array(parts).T) if parts else 0.0
