"""The noise of responses while they move: what smooth curves, the drives and hums leave of short windows."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.evidence import quiet, quiet_deviation
from pzt_ident.data.projections import LINE_RATIO, MOST_MEMORY, expected_products, memory_of

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
MOST_LINES, NEAR, OWN = 8, 25, 3  # lines over time, the frequencies that stand around each, and those that are its own
LONGEST = 2**17  # samples of a record in which lines are looked for


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


class Line(NamedTuple):
    """A line of a spectrum: its power over that of the frequencies around it, its frequency and its width, Hz."""

    ratio: float
    frequency: float
    width: float


def window_noise(signals: list[Signal], least: float) -> float:
    """Standard deviation of the noise in all signals, which is at least that of their quantiser.

    Long windows leave signal and short ones take noise: of all lengths, with the drives, with the lines of which they
    hold a period, and with neither, that one counts whose remainder over the square of the share in it is least. A
    remainder that is as alike from sample to sample as a signal, or rougher than its signals are, is none. Where all
    are so, the noise is taken for white.
    """
    white = max(roughness(signals), least)
    remainders = [remainder(signals, length) for length in LENGTHS]
    drives = [courses_of(signal.drives) for signal in signals]
    remainders += [remainder(signals, length, drives) for length in LENGTHS if length <= WITH_DRIVES]
    lines = lines_of(signals)
    remainders += [with_lines(signals, length, lines) for length in LENGTHS if lines]
    noise = [part for part in remainders if part and part.memory < MOST_MEMORY and part.roughness <= ROUGHER * white]
    if not noise:
        return white
    chosen = min(noise, key=lambda part: max(part.deviation, least) / part.share**1.5)
    return max(chosen.deviation, least)


def with_lines(signals: list[Signal], length: int, lines: list[float]) -> Remainder | None:
    """What polynomials and lines leave in the windows of those signals of which they hold a period of each line."""
    held = [signal for signal in signals if length * signal.dt * min(lines) > 1]
    return remainder(held, length, waves_of(held, lines)) if held else None


def remainder(signals: list[Signal], length: int, courses: Sequence[Array] = ()) -> Remainder | None:
    """What polynomials, and courses of each signal, (rows, samples), leave in the quiet windows of a length; None where
    these are too few."""
    responses, seconds = windows(signals, length, [signal.response[None] for signal in signals])
    basis = np.asarray(np.polynomial.legendre.legvander(np.linspace(-1, 1, length), DEGREE), dtype=np.float64)[None]
    if courses:
        columns, _ = windows(signals, length, courses)
        basis = np.concatenate([np.broadcast_to(basis, (len(columns), *basis.shape[1:])), columns], axis=2)
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
    typical = basis[kept[:: -(-kept.size // TYPICAL)]] if courses else basis
    memory = memory_of(alike / power, typical)
    left = expected_products(typical, memory)[0] / len(typical)
    return Remainder(float(np.sqrt(power / left)), memory, left / length)


def directions_of(columns: Array) -> Array:
    """Orthonormal directions of columns, (windows, samples, columns), with zeros in the place of those that rounding
    alone would make: where a drive only rises, its path is the drive."""
    norms = np.linalg.norm(columns, axis=1, keepdims=True)
    directions, sizes, _ = np.linalg.svd(columns / np.where(norms, norms, 1.0), full_matrices=False)
    return np.where((sizes > DEPENDENT * sizes[:, :1])[:, None, :], directions, 0.0)


def windows(signals: list[Signal], length: int, rows: Sequence[Array]) -> tuple[Array, Array]:
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


def lines_of(signals: list[Signal]) -> list[float]:
    """Frequencies, Hz, of the lines that stand out most, such as a hum and its harmonics, in the third differences of
    the signals, which what is smooth is hardly in, and are in no drive of theirs."""
    stand_out, lines = list[Line](), list[Line]()
    for signal in signals:
        of_drives = [line for drive in signal.drives for line in lines_in(drive, signal.dt)]
        own = lines_in(signal.response, signal.dt)
        stand_out += [line for line in own if not any(is_beside(line, other) for other in of_drives)]
    for line in sorted(stand_out, reverse=True):
        if len(lines) < MOST_LINES and not any(is_beside(line, other) for other in lines):
            lines.append(line)
    return [line.frequency for line in lines]


def is_beside(line: Line, other: Line) -> bool:
    return abs(line.frequency - other.frequency) <= OWN * max(line.width, other.width)


def lines_in(signal: Array, dt: float) -> list[Line]:
    """The lines in the third differences of a signal, as far as they are looked at, whose power is LINE_RATIO times the
    mean of the frequencies around them, in the order of their frequencies."""
    differences = np.diff(signal[:LONGEST], 3)
    if differences.size <= 6 * NEAR:
        return []
    power = np.abs(np.fft.rfft(differences * np.hanning(differences.size))) ** 2
    sides = np.ones(2 * NEAR + 1)
    sides[NEAR - OWN : NEAR + OWN + 1] = 0
    around = np.maximum(np.convolve(power, sides / sides.sum(), "valid"), np.finfo(float).tiny)
    ratios, width = power[NEAR:-NEAR] / around, 1 / (differences.size * dt)
    highest = np.max(np.lib.stride_tricks.sliding_window_view(np.pad(ratios, OWN), 2 * OWN + 1), axis=1)
    peaks = np.flatnonzero((ratios == highest) & (ratios > LINE_RATIO))
    before, at, after = (np.log(np.maximum(power[peaks + NEAR + side], np.finfo(float).tiny)) for side in (-1, 0, 1))
    bends = np.maximum(4 * at - 2 * before - 2 * after, np.finfo(float).tiny)
    tops = peaks + NEAR + np.clip((after - before) / bends, -1, 1)  # of the parabolas through three
    return [Line(float(ratios[peak]), float(top) * width, width) for peak, top in zip(peaks, tops, strict=True)]


def waves_of(signals: list[Signal], frequencies: Sequence[float]) -> list[Array]:
    """Cosines and sines of frequencies, Hz, over the time of each signal: (2 frequencies, samples)."""
    turns = [
        2 * np.pi * np.multiply.outer(frequencies, signal.dt * np.arange(signal.response.size)) for signal in signals
    ]
    return [np.concatenate([np.cos(part), np.sin(part)]) for part in turns]


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
