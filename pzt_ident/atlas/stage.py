"""The standard stage and the standard drives, on which every word of the registry is shown.

Signals are in SI units: drive in V, response in m.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.record import Record
from pzt_ident.engine.simulator import Simulator
from pzt_ident.model.block import Coupling
from pzt_ident.model.chain import Chain
from pzt_ident.search.cube import FixedValue
from pzt_ident.search.problem import Problem

Array = NDArray[np.float64]

OPERATOR, MECHANICS, SENSOR = "bouc_wen", "lumped", "encoder_cyclic_error"
VALUES = {
    "bouc_wen.gain": 0.082,
    "bouc_wen.alpha": 0.48,
    "bouc_wen.beta": 0.018,
    "bouc_wen.gamma": 0.05,
    "lumped.mass": 0.1566,
    "lumped.damping": 250.0,
    "lumped.stiffness": 7.0e7,
    "encoder_cyclic_error.sine": 0.1,
    "encoder_cyclic_error.cosine": 0.0,
    "encoder_cyclic_error.pitch": 0.8,
}
"""Of the standard stage, in um, V and SI units: a flexure of 8 um over 100 V with its resonance at 3.4 kHz, and the
error of a sensor for what shows in that alone."""

SPAN, STROKE = 100.0, 8e-6  # V, m
LOOPS = (0, 100, 0, 100, 20, 80, 35, 65, 50)
LEVELS = (60, 57, 20, 100, 0)
BAND, PERIOD, PERIODS = (100.0, 8000.0), 0.05, 3  # Hz, s


class Drive(NamedTuple):
    """A standard drive: what it is, in a caption and in a few words, its sample time in s, and the drives, in V, of the
    axis that is shown and of another axis: (samples,)."""

    title: str
    short: str
    dt: float
    u: Array
    other: Array

    @property
    def time(self) -> Array:
        return self.dt * np.arange(self.u.size, dtype=np.float64)


@cache
def drives() -> dict[str, Drive]:
    """By name."""
    still = 0.0
    polar = ramps((0, 100, -100, 100, 0), 200, 1e-3)
    slow, fast, holds = ramps(LOOPS, 200, 1e-3), ramps(LOOPS, 2e4, 1e-5), holding(LEVELS, 2e3, 20.0, 2e-2)
    steps, sweep, tone = holding((100, 50, 0), 6e4, 0.012, 1e-5), multisine(2e-5), sine(10.0, 3.0, 1e-3)
    swing = SPAN / 2 * (1 - np.cos(2 * np.pi * 1.3 * 1e-3 * np.arange(slow.size)))
    return {
        "loops": Drive("nested loops at 200 V/s", "slow loops", 1e-3, slow, still * slow),
        "fast": Drive("nested loops at 20,000 V/s", "fast loops", 1e-5, fast, still * fast),
        "small": Drive("nested loops of a fifth of the range", "small loops", 1e-3, slow[::5] / 5, still * slow[::5]),
        "polar": Drive("loops over both polarities", "both polarities", 1e-3, polar, still * polar),
        "holds": Drive("steps with holds of 20 s", "steps and holds", 2e-2, holds, still * holds),
        "steps": Drive("steps within two milliseconds", "fast steps", 1e-5, steps, still * steps),
        "sweep": Drive("a multisine of 6 V about 50 V", "small multisine", 2e-5, sweep, still * sweep),
        "tone": Drive("a sine of 10 Hz over the range", "one sine", 1e-3, tone, still * tone),
        "rest": Drive("no drive at all", "rest", 2e-2, 0 * holds, still * holds),
        "other": Drive("the other axis driven, this one too", "other axis", 1e-3, slow, swing),
        "other_sweep": Drive(
            "a multisine on the other axis alone", "multisine on the other axis", 2e-5, 0 * sweep + 50, sweep
        ),
    }


def ramps(levels: Sequence[float], rate: float, dt: float) -> Array:
    """Ramps from level to level, V, at a rate in V/s."""
    times = np.concatenate([[0], np.cumsum(np.abs(np.diff(levels))) / rate])
    return np.interp(np.arange(0, times[-1] + dt / 2, dt), times, levels)


def holding(levels: Sequence[float], rate: float, hold: float, dt: float) -> Array:
    """Ramps at a rate in V/s to levels, V, with a hold, s, after each, from a rest of a fifth of that."""
    times, corners = [0.0, hold / 5], [0.0, 0.0]
    for level in levels:
        arrival = times[-1] + max(abs(level - corners[-1]) / rate, dt)
        times, corners = [*times, arrival, arrival + hold], [*corners, level, level]
    return np.interp(np.arange(0, times[-1], dt), times, corners)


def multisine(dt: float) -> Array:
    """Periods of a sum of sines on lines spaced evenly in the logarithm of BAND, 3 V about 50 V, after a ramp."""
    t = dt * np.arange(round(PERIOD / dt))
    lines = np.unique(np.round(np.geomspace(*BAND, 80) * PERIOD)) / PERIOD
    phases = -np.pi * np.arange(lines.size) ** 2 / lines.size  # Schroeder (1970): no peaks
    wave = np.sin(2 * np.pi * np.outer(t, lines) + phases).sum(axis=1)
    return np.concatenate([np.linspace(0, 50, 200), np.tile(50 + 3 * wave / np.abs(wave).max(), PERIODS)])


def sine(frequency: float, seconds: float, dt: float) -> Array:
    """Whole periods over the range, from 0."""
    return SPAN / 2 * (1 - np.cos(2 * np.pi * frequency * np.arange(0, seconds, dt)))


def record(drive: Drive, axes: int = 1) -> Record:
    """The drive as a record without a response; of two axes the second one is driven, not measured."""
    drive_signals = np.array([drive.u, drive.other][:axes])
    units = ("um", None)[:axes]
    more: dict[str, Any] = {"axes": ("x", "y")[:axes], "drive_units": ("V",) * axes, "response_units": units}
    return Record(drive.short, "identify", drive.dt, drive_signals, np.zeros_like(drive_signals), **more)


class Stage:
    """A chain of blocks with all its parameters, on any of the standard drives."""

    def __init__(self, blocks: Sequence[Any], values: Mapping[str, float]) -> None:
        self.axes = 2 if any(issubclass(block, Coupling) for block in blocks) else 1
        self.chain = Chain(blocks, ("x", "y")[: self.axes], (0,))
        self.problem = Problem(self.chain, [reference(self.axes)], {name: FixedValue(v) for name, v in values.items()})

    def respond(self, drive: Drive, theta: Array) -> Array:
        """The response to a drive, without additions: (samples,); of many candidates, (candidates, samples)."""
        response = Simulator(self.chain, record(drive, self.axes)).simulate(theta)[:, 0]
        return response if np.ndim(theta) > 1 else response[0]


@cache
def reference(axes: int) -> Record:
    """What bounds in units of drive and response are multiples of: 100 V and 8 um."""
    loops = record(drives()["loops"], axes)
    loops.response[0] = STROKE / SPAN * loops.drive[0]
    if axes > 1:
        loops.drive[1] = loops.drive[0]
    return loops
