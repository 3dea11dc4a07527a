"""Drives of a campaign: records of x and y voltage that begin at 0 V, with somewhat different numbers in each case."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Drive:
    """One record: what is sent to both axes, and what it is for."""

    name: str
    use: str
    rate: float
    u_x: Array
    u_y: Array

    @property
    def time(self) -> Array:
        return np.arange(len(self.u_x)) / self.rate


class Track:
    """Voltages of both axes, written piece after piece; an axis that a piece does not name stays where it is."""

    def __init__(self, rate: float) -> None:
        self.rate, self.x, self.y = rate, [np.zeros(1)], [np.zeros(1)]

    def _append(self, x: Array | None, y: Array | None) -> Track:
        length = len(x) if x is not None else len(y) if y is not None else 0
        self.x.append(np.full(length, self.x[-1][-1]) if x is None else x)
        self.y.append(np.full(length, self.y[-1][-1]) if y is None else y)
        return self

    def _steps(self, seconds: float) -> Array:
        return np.arange(1, max(round(seconds * self.rate), 1) + 1) / self.rate

    def rest(self, seconds: float) -> Track:
        return self._append(np.full(len(self._steps(seconds)), self.x[-1][-1]), None)

    def ramp(self, seconds: float, x: float | None = None, y: float | None = None) -> Track:
        part = self._steps(seconds) * self.rate
        part /= part[-1]
        ends = [None if to is None else track[-1][-1] * (1 - part) + to * part for track, to in self._ends(x, y)]
        return self._append(*ends)

    def _ends(self, x: float | None, y: float | None) -> list[tuple[list[Array], float | None]]:
        return [(self.x, x), (self.y, y)]

    def triangles(self, *levels: float, speed: float) -> Track:
        """x through each level at `speed` V/s."""
        for level in levels:
            self.ramp(abs(level - self.x[-1][-1]) / speed, x=level)
        return self

    def sine(self, frequency: float, cycles: float, x: float = 0.0, y: float = 0.0) -> Track:
        t = self._steps(cycles / frequency)
        return self._waves(np.sin(2 * np.pi * frequency * t), x, y)

    def chirp(self, low: float, high: float, seconds: float, x: float = 0.0, y: float = 0.0) -> Track:
        """Linear sweep from low to high Hz with tapered ends."""
        t = self._steps(seconds)
        taper = np.clip(np.minimum(t, t[-1] - t) / (0.04 * seconds), 0, 1)
        return self._waves(taper * np.sin(2 * np.pi * (low + (high - low) * t / (2 * seconds)) * t), x, y)

    def _waves(self, wave: Array, x: float, y: float) -> Track:
        return self._append(self.x[-1][-1] + x * wave, self.y[-1][-1] + y * wave)

    def drive(self, name: str, use: str) -> Drive:
        return Drive(name, use, self.rate, np.concatenate(self.x), np.concatenate(self.y))


def cycles(low: float, high: float, count: int) -> list[float]:
    return [high, low] * count


def rich(rng: np.random.Generator) -> list[Drive]:
    """Rates, holds, nested loops and chirps to identify; other rates and other holds to validate."""
    a, b = 1 + rng.uniform(-0.06, 0.06, 2)  # of the amplitudes and the rates
    rates = Track(1000).rest(1).triangles(*cycles(0, 130 * a, 2), speed=130 * b)
    rates.triangles(*cycles(0, 130 * a, 4), speed=1300 * b).ramp(0.1, x=65).rest(0.5)
    rates.sine(20 * b, 10, x=50 * a).rest(1).triangles(0, *cycles(0, 60 * a, 2), speed=300 * b).rest(1)
    holds = Track(200).rest(1).ramp(0.05, x=80 * a).rest(5).ramp(0.02, x=76 * a).rest(20)
    holds.ramp(0.05, x=35 * a).rest(6).ramp(0.05, x=100 * a).rest(1).ramp(0.05, x=96 * a).rest(4).ramp(0.05, x=0).rest(
        2
    )
    nested = (
        Track(500).rest(1).triangles(120 * a, 30, 95 * a, 50, 80 * a, 60, 80 * a, 60, 95 * a, 30, 120 * a, speed=150)
    )
    nested.triangles(-20, 140 * a, -20, 60 * a, -20, 0, 40, speed=170 * b).rest(0.5)
    nested.ramp(1, y=90 * a).ramp(1, y=0).ramp(0.5, x=90 * a, y=60).ramp(0.8, x=30, y=60).ramp(0.8, x=70, y=10).rest(
        0.5
    )
    fast = Track(20000).ramp(0.03, x=65).rest(0.03).sine(80 * b, 12, x=40 * a).rest(0.03)
    fast.ramp(0.02, x=40 * a).rest(0.03).chirp(20, 2500, 0.2, x=3 * a).rest(0.03)
    fast.ramp(0.03, x=100 * a).rest(0.03).chirp(20, 2000, 0.1, x=3 * a).rest(0.02)
    fast.ramp(0.02, y=40).rest(0.02).chirp(50, 5000, 0.15, y=4 * a).rest(0.03)
    others = Track(20000).ramp(0.02, x=70 * a).rest(0.03).sine(45 * b, 5, x=35 * a).rest(0.02)
    others.chirp(2300, 30, 0.14, x=3 * a).rest(0.02).ramp(0.02, x=25).rest(0.03).chirp(100, 1500, 0.05, x=4)
    others.ramp(0.02, y=55 * a).rest(0.02).chirp(4800, 100, 0.1, y=4).rest(0.03)
    slow = Track(250).rest(1).triangles(*cycles(0, 110 * a, 1), *cycles(-20, 148, 2), 0, speed=210 * b)
    slow.triangles(70, 20, 55, 35, 55, 20, 70, speed=60).ramp(0.04, x=110 * a).rest(5).ramp(0.02, x=104 * a).rest(5)
    slow.ramp(0.04, x=20).rest(3).ramp(0.4, y=70 * a).ramp(0.4, y=20).ramp(0.6, x=80, y=80).ramp(0.6, x=0, y=0).rest(1)
    return [
        rates.drive("rates", "identify"),
        holds.drive("holds", "identify"),
        nested.drive("nested", "identify"),
        fast.drive("chirps", "identify"),
        others.drive("other_rates", "validate"),
        slow.drive("other_holds", "validate"),
    ]


def loops(rng: np.random.Generator) -> list[Drive]:
    """Slow loops only."""
    a, b = 1 + rng.uniform(-0.06, 0.06, 2)
    large = Track(500).rest(1).triangles(*cycles(0, 130 * a, 3), speed=130 * b).rest(1)
    minor = Track(500).rest(1).triangles(120 * a, 30, 95 * a, 50, 80 * a, 60, 80 * a, 60, 95 * a, 0, speed=130 * b)
    minor.ramp(1, y=90 * a).ramp(1, y=0).rest(1)
    other = Track(500).rest(1).triangles(-20, 145 * a, -20, 100, 20, 70, 0, speed=160 * b)
    other.ramp(0.8, y=60).ramp(0.8, y=20).rest(1)
    return [large.drive("large", "identify"), minor.drive("minor", "identify"), other.drive("other", "validate")]


def one_frequency(rng: np.random.Generator) -> list[Drive]:
    """Triangles of one frequency, y following a quarter of a cycle later in the second record."""
    a, frequency = 1 + rng.uniform(-0.06, 0.06), rng.uniform(0.8, 1.3)
    quarter = 1 / (4 * frequency)
    full = Track(500).rest(1).triangles(*cycles(0, 130 * a, 5), speed=260 * a * frequency).rest(1)
    both = Track(500).rest(1).ramp(quarter, x=65 * a)
    for _ in range(3):
        both.ramp(quarter, x=130 * a, y=35).ramp(quarter, x=65 * a, y=70).ramp(quarter, x=0, y=35)
        both.ramp(quarter, x=65 * a, y=0)
    other = Track(500).rest(1).triangles(*cycles(0, 95 * a, 4), speed=190 * a * frequency).rest(1)
    return [full.drive("full", "identify"), both.rest(1).drive("both", "identify"), other.drive("other", "validate")]


def short(rng: np.random.Generator) -> list[Drive]:
    """A few thousand samples in three records."""
    a, b = 1 + rng.uniform(-0.06, 0.06, 2)
    first = Track(250).rest(1).triangles(*cycles(0, 120 * a, 2), speed=240 * b).ramp(0.04, x=80).rest(3)
    first.triangles(40, 70, 50, 70, 0, speed=200).ramp(0.2, y=70 * a).ramp(0.2, y=0).rest(1)
    second = Track(10000).ramp(0.02, x=50).sine(60 * b, 3, x=40).chirp(20, 1500, 0.1, x=3).ramp(0.02, y=30)
    second.chirp(50, 1500, 0.05, y=8).rest(0.01)
    other = (
        Track(500)
        .rest(1)
        .triangles(-20, 140 * a, 0, speed=400 * b)
        .ramp(0.04, x=60)
        .rest(0.7)
        .ramp(0.1, y=50)
        .rest(0.3)
    )
    return [first.drive("first", "identify"), second.drive("second", "identify"), other.drive("other", "validate")]


CAMPAIGNS = {"rich": rich, "loops": loops, "one_frequency": one_frequency, "short": short}
