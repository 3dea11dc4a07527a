"""Virtual piezo flexure stage: the continuous equations of Lin & Lin (2012) and an encoder, integrated by scipy.

It makes measured-like records and shares no code with pzt_ident. Eq. 2, 5 and 6 of Mechatronics 22, 614 are integrated
together, from rest at 0 V, by DOP853 to 0.01 nm after 5 s, stopping at every corner of the drive. The published damping
is zero: each corner leaves 1 to 4 nm of ringing above 3 kHz for good (11 nm on X in Case II, where corners add up).

`python experiments/rigs/xy_stage.py --out .` in the repository's root writes the committed files (minutes).
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

Array = NDArray[np.float64]
Derivative = Callable[[list[float], list[float], list[float]], list[float]]


@dataclass(frozen=True)
class Axis:
    """One axis in SI units: kg, N s/m, N/m, m/V, 1, 1/V, 1/V."""

    mass: float
    damping: float
    stiffness: float
    gain: float
    alpha: float
    beta: float
    gamma: float


@dataclass(frozen=True)
class Stage:
    """One axis, or two with the coupling stiffnesses of Eq. 6 in N/m."""

    axes: tuple[Axis, ...]
    k12: float = 0.0
    k21: float = 0.0

    def coupling(self) -> list[list[float]]:
        """Displacement at rest per uncoupled displacement, k_ij / k_ii."""
        if len(self.axes) == 1:
            return [[1.0]]
        first, second = self.axes
        return [[1.0, self.k12 / first.stiffness], [self.k21 / second.stiffness, 1.0]]


X_PSO = Axis(0.1566, 0.0, 7.0028e7, 8.1947e-8, 0.5590, 0.0148, 0.0552)  # Table 3
Y_PSO = Axis(0.0631, 0.0, 7.6963e7, 1.1064e-7, 0.5243, 0.1111, 0.0)  # Table 4


def coupled(k12: float = -3.23e6) -> Stage:
    """Table 7. The sign of k12 is lost in print; negative fits the text and the open-loop errors of Case III."""
    x = Axis(0.1566, 0.0, 7.00e7, 8.19e-8, 0.519979, 0.012794, 0.052803)
    y = Axis(0.0631, 0.0, 7.70e7, 1.11e-7, 0.863758, 0.295187, 0.0)
    return Stage((x, y), k12, 4.15e6)


@dataclass(frozen=True)
class Sine:
    """amplitude [V] sin(2 pi frequency [Hz] (t - start [s])) from its start on."""

    amplitude: float
    frequency: float
    start: float


@dataclass(frozen=True)
class Drive:
    """Voltage over time: straight lines through (time [s], level [V]), held after the last, plus sines."""

    time: tuple[float, ...]
    level: tuple[float, ...]
    sines: tuple[Sine, ...] = ()

    def __call__(self, time: Array) -> Array:
        lines = np.interp(time, self.time, self.level)
        return lines + sum(
            sine.amplitude * np.sin(2 * np.pi * sine.frequency * np.maximum(time - sine.start, 0))
            for sine in self.sines
        )

    def corners(self) -> tuple[float, ...]:
        return (*self.time, *(sine.start for sine in self.sines))

    def piece(self, low: float, high: float) -> Callable[[float], tuple[float, float]]:
        """Voltage and its rate as one smooth function between two neighbouring corners."""
        start, end = np.interp([low, high], self.time, self.level).tolist()
        slope = (end - start) / (high - low)
        active = [(s.amplitude, 2 * np.pi * s.frequency, s.start) for s in self.sines if s.start < (low + high) / 2]

        def voltage(t: float) -> tuple[float, float]:
            value, rate = start + slope * (t - low), slope
            for amplitude, omega, begin in active:
                value += amplitude * math.sin(omega * (t - begin))
                rate += amplitude * omega * math.cos(omega * (t - begin))
            return value, rate

        return voltage


def hold(level: float, rise: float, *sines: Sine) -> Drive:
    """From 0 V to a level in `rise` seconds, then held."""
    return Drive((0.0, rise), (0.0, level), sines)


def triangle(amplitude: float, frequency: float, cycles: int) -> Drive:
    """0 V to the amplitude and back, `cycles` times."""
    corners = range(2 * cycles + 1)
    return Drive(tuple(i / (2 * frequency) for i in corners), tuple(amplitude * (i % 2) for i in corners))


def nested(amplitude: float, legs: int, leg: float, *sines: Sine) -> Drive:
    """0 V to the amplitude, then loops that shrink by equal steps to half of it; one leg every `leg` seconds."""
    shrinking = (amplitude / 2 * (1 + (-1) ** i * (1 - i / legs)) for i in range(legs + 1))
    return Drive(tuple(leg * i for i in range(legs + 2)), (0.0, *shrinking), sines)


def hysteresis(axis: Axis, h: float, rate: float) -> float:
    """Eq. 5: dh/dt in m/s for dU/dt in V/s."""
    return axis.alpha * axis.gain * rate - axis.beta * abs(rate) * h - axis.gamma * rate * abs(h)


def simulate(stage: Stage, time: Array, drives: Sequence[Drive]) -> Array:
    """Displacement of each axis in m, (axes, samples), from rest at 0 V (Eq. 6)."""
    axes, coupling = stage.axes, stage.coupling()
    frequencies = [(axis.stiffness / axis.mass) ** 0.5 for axis in axes]
    ratios = [axis.damping / axis.mass for axis in axes]

    def derivative(state: list[float], voltage: list[float], rate: list[float]) -> list[float]:
        free = [axis.gain * u - h for axis, u, h in zip(axes, voltage, state[0::3], strict=True)]
        result = []
        for i, axis in enumerate(axes):
            h, x, v = state[3 * i : 3 * i + 3]  # v: velocity over omega, so that x and v share a tolerance
            pull = sum(share * f for share, f in zip(coupling[i], free, strict=True)) - x
            result += [hysteresis(axis, h, rate[i]), frequencies[i] * v, frequencies[i] * pull - ratios[i] * v]
        return result

    return _integrate(derivative, 3 * len(axes), time, drives)[1::3]


def quasi_static(stage: Stage, time: Array, drives: Sequence[Drive]) -> Array:
    """What `simulate` tends to for slow drives: the balance of forces, without inertia and damping."""

    def derivative(state: list[float], voltage: list[float], rate: list[float]) -> list[float]:
        return [hysteresis(axis, h, r) for axis, h, r in zip(stage.axes, state, rate, strict=True)]

    h = _integrate(derivative, len(stage.axes), time, drives)
    voltage = np.array([drive(time) for drive in drives])
    return np.array(stage.coupling()) @ (np.array([[axis.gain] for axis in stage.axes]) * voltage - h)


def _integrate(derivative: Derivative, size: int, time: Array, drives: Sequence[Drive]) -> Array:
    time = np.round(time, 9)  # as the corners, so that none is missed or met twice by a rounding error
    corners = np.unique(np.round([0.0, time[-1], *(c for drive in drives for c in drive.corners())], 9))
    corners = corners[corners <= time[-1]]
    state = np.zeros(size)
    result = np.zeros((size, len(time)))
    for low, high in pairwise(corners.tolist()):
        inside = (time > low) & (time <= high)
        pieces = [drive.piece(low, high) for drive in drives]

        def slope(t: float, y: Array, pieces: list[Callable[[float], tuple[float, float]]] = pieces) -> list[float]:
            voltage, rate = zip(*(piece(t) for piece in pieces), strict=True)
            return derivative(y.tolist(), list(voltage), list(rate))

        stops = np.union1d(time[inside], high)
        path = solve_ivp(slope, (low, high), state, method="DOP853", t_eval=stops, rtol=1e-10, atol=1e-15).y
        result[:, inside], state = path[:, : inside.sum()], path[:, -1]
    return result


def encoder(x: Array, count: float = 0.1e-6, noise: float = 0.0, seed: int = 0) -> Array:
    """x in m rounded to counts, after Gaussian noise of standard deviation `noise` in m."""
    noisy = x + noise * np.random.default_rng(seed).standard_normal(np.shape(x))
    return count * np.round(noisy / count)


@dataclass(frozen=True)
class Recording:
    """A committed file: the stage, its drives, and how it is sampled."""

    path: str
    stage: Stage
    drives: tuple[Drive, ...]
    names: str = "x"
    sample_rate: int = 1000
    samples: int = 5000

    def table(self, samples: int | None = None) -> tuple[list[str], Array]:
        """Header and rows (time s, drives V, displacements um), all of them or the first `samples`."""
        time = np.arange(samples or self.samples) / self.sample_rate
        voltage = [np.round(drive(time), 12) for drive in self.drives]
        x = 1e6 * encoder(simulate(self.stage, time, self.drives))
        header = ["time [s]", *(f"u_{name} [V]" for name in self.names), *(f"{name} [um]" for name in self.names)]
        return header, np.column_stack([time, *voltage, *np.round(x, 1)])

    def write(self, folder: Path) -> None:
        header, rows = self.table()
        file = folder / self.path
        file.parent.mkdir(parents=True, exist_ok=True)
        lines = [",".join(header), *(",".join(map(repr, row)) for row in rows.tolist())]
        file.write_text("\n".join(lines) + "\n", encoding="utf-8")


def recordings(k12: float = -3.23e6) -> list[Recording]:
    """Every committed file: Case I, Case II and the example that ships with the package."""
    x, y, both = Stage((X_PSO,)), Stage((Y_PSO,)), coupled(k12)
    loops_x = nested(130, 12, 0.2, Sine(35, 2.3, 2.8), Sine(15, 7.1, 2.8))
    loops_y = nested(90, 12, 0.2, Sine(25, 1.9, 2.8), Sine(10, 6.3, 2.8))
    waves_y = hold(45, 0.35, Sine(25, 1.3, 0.5), Sine(12, 4.7, 0.5))
    example = nested(130, 10, 0.2, Sine(35, 2.3, 2.4), Sine(15, 5.1, 2.4))
    case_1, case_2, template = "experiments/case_1/data", "experiments/case_2/data", "pzt_ident/job/examples/start"
    return [
        Recording(f"{case_1}/case_1_x.csv", x, (triangle(130, 1, 5),)),
        Recording(f"{case_1}/case_1_x_validate.csv", x, (loops_x,)),
        Recording(f"{case_1}/case_1_y.csv", y, (triangle(90, 1, 5),), "y"),
        Recording(f"{case_1}/case_1_y_validate.csv", y, (loops_y,), "y"),
        Recording(f"{case_2}/case_2.csv", both, (triangle(130, 1, 5), triangle(90, 1, 5)), "xy"),
        Recording(f"{case_2}/case_2_validate.csv", both, (loops_x, waves_y), "xy"),
        Recording(f"{template}/x_identify.csv", x, (triangle(130, 1, 4),), "x", 500, 2000),
        Recording(f"{template}/x_validate.csv", x, (example,), "x", 500, 2000),
    ]


def main() -> None:
    parser = argparse.ArgumentParser(description="Write the records of the virtual stage.")
    parser.add_argument("--out", type=Path, required=True, help="folder that the repository's paths are laid out in")
    parser.add_argument("--k12", type=float, default=-3.23e6, help="coupling stiffness of Case II in N/m")
    arguments = parser.parse_args()
    for recording in recordings(arguments.k12):
        recording.write(arguments.out)


if __name__ == "__main__":
    main()
