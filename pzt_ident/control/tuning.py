"""PI gains for a sampled loop around an identified stage: what they are worth, and the best ones within margins."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pzt_ident.control.plant import Plant
from pzt_ident.errors import InputError

if TYPE_CHECKING:
    from control import StateSpace

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

KP = np.linspace(0.0, 2.0, 21)  # times the gain of the plant
KI = np.geomspace(4.0, 1e-5, 40)  # times the gain of the plant and the sample time
ZOOMS = 4
UNDAMPED = 1 - 1e-6  # magnitude of a pole


class Margins(NamedTuple):
    """gain: factor by which the gain of the loop may change. phase: degrees by which its phase may. sensitivity: the
    largest amplification of a disturbance, one over the distance of the loop from -1."""

    gain: float
    phase: float
    sensitivity: float


@dataclass(frozen=True)
class Loop:
    """A plant under u(i + delay) = kp e(i) + ki dt (e(0) + ... + e(i)), gains in drive over response, SI units."""

    plant: Plant
    delay: int
    kp: float
    ki: float

    @property
    def opened(self) -> StateSpace:
        """From the error to the reading."""
        return opened(self.plant, self.delay, self.kp * self.plant.gain, self.ki * self.plant.gain * self.plant.dt)

    @cached_property
    def poles(self) -> Complex:
        """Of the closed loop, exact."""
        return np.linalg.eigvals(closed(self.opened)).astype(np.complex128)

    @property
    def radius(self) -> float:
        """The largest magnitude of a pole: the loop is stable where it is below one."""
        return float(np.abs(self.poles).max())

    @cached_property
    def response(self) -> Complex:
        """Of the open loop at the frequencies of the plant."""
        loop, z = self.opened, np.exp(1j * self.plant.frequencies * self.plant.dt)
        states = np.linalg.solve(z[:, None, None] * np.eye(loop.nstates) - loop.A, loop.B.astype(complex))
        return np.asarray(loop.C @ states + loop.D)[:, 0, 0]

    @property
    def margins(self) -> Margins:
        """Of a stable loop."""
        import control

        data = control.frd(self.response, self.plant.frequencies, smooth=True)
        gain, phase, *_ = map(float, control.stability_margins(data))
        return Margins(max(gain, 1 / gain), abs(phase), float(np.abs(1 / (1 + self.response)).max()))

    @property
    def bandwidth(self) -> float:
        """Frequency, Hz, from which the reading follows less than 0.707 of the reference; half the sample rate where
        there is none."""
        lost = np.flatnonzero(np.abs(self.response / (1 + self.response)) < np.sqrt(0.5))
        return float(self.plant.frequencies[lost[0] if lost.size else -1] / (2 * np.pi))


def opened(plant: Plant, delay: int, kp: float, ki: float) -> StateSpace:
    """The open loop; gains over those of the plant, ki in a sample. Its matrices are linear in the gains."""
    import control

    pi = control.ss([[1.0]], [[1.0]], [[ki]], [[kp + ki]], plant.dt)
    line, end = np.eye(delay, k=1), np.eye(delay)
    late = control.ss(line, end[:, -1:], end[:1], 0.0, plant.dt) * pi if delay else pi
    return plant.dynamics * late


def closed(loop: StateSpace) -> Array:
    return loop.A - loop.B @ loop.C


def tune(plant: Plant, delay: int, gain_margin: float, phase_margin: float) -> Loop:
    """The PI gains of greatest ki that keep both margins in a stable loop: the integral of the error that a step of the
    load leaves is 1 / ki (Astrom & Hagglund 2006, Advanced PID Control, 4.9 and 6.8).

    Raises InputError where none do.
    """
    search = Search(plant, delay, gain_margin, np.radians(phase_margin))
    grid = KP
    for _ in range(ZOOMS):
        integral = [search.largest(kp) for kp in grid]
        best = int(np.argmax(integral))
        kp, ki = float(grid[best]), integral[best]
        grid = np.linspace(grid[max(best - 1, 0)], grid[min(best + 1, grid.size - 1)], 9)
    if not ki > 0:
        free = np.abs(plant.dynamics.poles()).max() > UNDAMPED
        remedy = "give the resonance its damping, which slow data do not determine" if free else "ask for less margin"
        raise InputError(
            f"no PI gains keep a gain margin of {gain_margin:g} and a phase margin of {phase_margin:g} degrees",
            remedy=f"{remedy}, or sample faster",
        )
    return Loop(plant, delay, kp / plant.gain, ki / (plant.gain * plant.dt))


class Search:
    """Which gains keep the margins, many at once; gains over those of the plant, ki in a sample."""

    def __init__(self, plant: Plant, delay: int, gain: float, phase: float) -> None:
        self.gain, self.phase = gain, phase
        none, kp, ki = (opened(plant, delay, *gains) for gains in ((0.0, 0.0), (1.0, 0.0), (0.0, 1.0)))
        self.free = closed(none)
        self.by_kp, self.by_ki = closed(kp) - self.free, closed(ki) - self.free
        z = np.exp(1j * plant.frequencies * plant.dt)
        self.proportional, self.integral = kp(z), ki(z)

    def largest(self, kp: float) -> float:
        """The largest ki that keeps the margins, 0 where none does."""
        grid, largest = KI, 0.0
        for _ in range(ZOOMS):
            kept = np.flatnonzero(self.keeps(kp, grid))
            if not kept.size:
                break
            largest = float(grid[kept[0]])
            grid = np.geomspace(grid[max(kept[0] - 1, 0)], largest, 12)
        return largest

    def keeps(self, kp: float, ki: Array) -> NDArray[np.bool_]:
        matrices = self.free + kp * self.by_kp + ki[:, None, None] * self.by_ki
        good = np.abs(np.linalg.eigvals(matrices)).max(axis=1) < 1
        loops = kp * self.proportional + ki[good, None] * self.integral
        good[good] = ~(turned(loops, self.phase) | amplified(loops, self.gain))
        return good


def turned(loops: Complex, phase: float) -> NDArray[np.bool_]:
    """Where a loop crosses the unit circle within a phase of -1."""
    size, angle = np.log(np.abs(loops)), np.angle(-loops)
    crosses = size[:, 1:] * size[:, :-1] <= 0
    share = size[:, :-1] / np.where(crosses, size[:, :-1] - size[:, 1:], 1.0)
    near = np.abs(angle[:, :-1] + share * np.angle(loops[:, 1:] / loops[:, :-1])) < phase
    return np.any(crosses & near, axis=1)


def amplified(loops: Complex, gain: float) -> NDArray[np.bool_]:
    """Where a loop crosses the negative real axis within a factor of -1."""
    real, imaginary = loops.real, loops.imag
    crosses = imaginary[:, 1:] * imaginary[:, :-1] <= 0
    share = imaginary[:, :-1] / np.where(crosses, imaginary[:, :-1] - imaginary[:, 1:], 1.0)
    at = -(real[:, :-1] + share * np.diff(real, axis=1))
    return np.any(crosses & (at > 1 / gain) & (at < gain), axis=1)
