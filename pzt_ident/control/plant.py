"""The linear plant that a sampled controller sees of a stage: from its drive, held over each sample, to its reading."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from pzt_ident.control.stage import MATERIAL, MECHANICS, Stage
from pzt_ident.model.block import Place

if TYPE_CHECKING:
    from control import StateSpace

Array = NDArray[np.float64]

DYNAMICS = MECHANICS | {Place.DELAY, Place.AMPLIFIER, Place.OUTPUT, Place.SENSOR}
SAMPLES = 64  # of a pulse response, beyond its dead time
SMALL = 1e-3  # of the largest drive, the end of a ramp
ORDER = 8  # of the slope of a ramp response
RANK = 1e-7  # of the largest singular value, below which one is rounding
CYCLES = (1.0, 0.5, 0.25)  # amplitudes, over the largest drive, of the loops whose slopes are looked at
LEG = 400  # samples
GRID = 1500  # frequencies, by ratio and by difference
AROUND = np.concatenate([-np.geomspace(0.01, 100, 200)[::-1], [0.0], np.geomspace(0.01, 100, 200)])  # widths of a pole
NARROWEST, NEAR_ZERO = 1e-9, 0.1


@dataclass(frozen=True)
class Plant:
    """dynamics: discrete state space of static gain one, or near it; what is asked of the stage to what its sensor
    reads. gain: the largest slope of the material before it, m/V where the drive is in V."""

    dynamics: StateSpace
    gain: float

    @property
    def dt(self) -> float:
        return float(self.dynamics.dt)

    @cached_property
    def frequencies(self) -> Array:
        """rad/s, to just beyond half the sample rate, where a loop may cross the real axis; dense around every pole."""
        nyquist = np.pi / self.dt
        poles = self.dynamics.poles()
        poles = poles[np.abs(poles) > NEAR_ZERO]
        width = np.maximum(1 - np.abs(poles), NARROWEST)[:, None] / self.dt
        near = np.abs(np.angle(poles))[:, None] / self.dt + width * AROUND
        spread = np.concatenate([nyquist * np.geomspace(1e-5, 1, GRID), nyquist * np.arange(1, GRID) / GRID, near.flat])
        return np.append(np.unique(spread[(spread > 0) & (spread <= nyquist)]), nyquist * (1 + 1 / GRID))


def plant_of(stage: Stage, axis: int, span: tuple[float, float], substeps: int) -> Plant:
    """The plant of an axis at the sample time of a controller, which is `substeps` times that of the stage.

    Actuation, mechanics and sensor are realised exactly, from their response to a drive that is held for a sample
    (eigensystem realization, Juang & Pappa 1985, J. Guidance 8, 620). The material between them counts by its largest
    slope on loops within a span of the drive, since there the loop gain is largest; so does a resonance of the readout.
    """
    import control

    gain = largest_slope(stage, axis, span)
    pulse = held_pulse(stage, axis, SMALL * max(map(abs, span)) * abs(gain), substeps)
    half = pulse.size // 2 - 1
    _, sizes = control.eigensys_realization(pulse, 1, half, half)
    realization, _ = control.eigensys_realization(pulse, int(np.count_nonzero(sizes > RANK * sizes[0])), half, half)
    return Plant(control.ss(realization.A, realization.B, realization.C, 0.0, stage.dt * substeps), gain)


def largest_slope(stage: Stage, axis: int, span: tuple[float, float]) -> float:
    """Of the material's response over the drive, on loops within a span that grow smaller."""
    corners = [0.0, *(level for share in CYCLES for level in (share * span[1], share * span[0]))]
    knots = np.arange(len(corners)) * LEG
    drive = np.zeros((len(stage.model.axes), knots[-1] + 1))
    drive[axis] = np.interp(np.arange(drive.shape[1]), knots, corners)
    moves = np.diff(drive[axis])
    slopes = np.diff(stage.respond(drive, MATERIAL)[axis])[moves != 0] / moves[moves != 0]
    return float(slopes[np.argmax(np.abs(slopes))])


def held_pulse(stage: Stage, axis: int, size: float, substeps: int) -> Array:
    """Response of the dynamics, at the start of each sample, to an input of one that is held over the first of them.

    A stage takes its drive as linear between its samples, so its response to a ramp is exact, and that to a step is the
    slope of it. The drift and hum that a reading has at rest are left out.
    """
    late = round(stage.late[axis])
    samples = SAMPLES + 2 * (late // substeps)
    time = np.arange(substeps * samples + 1)
    drive = np.zeros((len(stage.model.axes), time.size))
    at_rest = stage.respond(drive, DYNAMICS)[axis]
    drive[axis] = size * time / time[-1]
    ramp = (stage.respond(drive, DYNAMICS)[axis] - at_rest) * (time[-1] / size)
    step = [slope_at(ramp[late:], end - late) for end in time[::substeps]]
    return np.diff(step, prepend=0.0)


def slope_at(signal: Array, end: int) -> float:
    """Slope at sample `end` of a signal that is zero up to its first one, by backward differences from there on."""
    order = min(ORDER, max(end, 0))
    return float(sum(np.diff(signal[end - order : end + 1], k)[-1] / k for k in range(1, order + 1)))
