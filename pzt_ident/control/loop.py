"""An identified stage in closed loop: PI control with feedforward, as a sampled controller does it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pzt_ident.control.limits import Limits
from pzt_ident.control.stage import EVERYTHING, Stage
from pzt_ident.model.block import Place

Array = NDArray[np.float64]

MOVED = EVERYTHING - {Place.SENSOR}


@dataclass(frozen=True)
class PI:
    """u = feedforward + kp e + ki (integral of e), e = reference - reading (Lin & Lin 2012, eq. 24 and 25), of each
    axis, in V/m and V/(m s) where the drive is in V: 0.8 V/um is 8e5. The integral has the error just read in it.

    Where the amplifier puts out v instead of u, the integral goes back by (v - u) dt / T in each sample, T = kp / ki or
    a sample where that is more: anti-windup by back-calculation (Astrom & Hagglund 2006, Advanced PID Control, 3.5).
    """

    kp: Array
    ki: Array

    def sampled(self, dt: float) -> Array:
        """Gains (axes, 3) of the error, of its sum, and of what the limits take away."""
        kp, ki = np.asarray(self.kp, dtype=np.float64), np.asarray(self.ki, dtype=np.float64)
        back = np.abs(ki) * dt / np.maximum(np.abs(kp), np.abs(ki) * dt + 1e-300)
        return np.column_stack([kp, ki * dt, back])


@dataclass(frozen=True)
class Tracking:
    """How a stage followed a reference; each (axes, samples), SI units.

    displacement: of the stage. reading: of its sensor, in whole counts, with its lag and errors. drive: held from each
    sample to the next.
    """

    dt: float
    reference: Array
    displacement: Array
    reading: Array
    drive: Array

    @property
    def error(self) -> Array:
        """Displacement minus reference, the sign that the figures of Lin & Lin have."""
        return self.displacement - self.reference

    @property
    def rmse(self) -> Array:
        """Root mean square of the error of each axis."""
        return np.sqrt(np.mean(self.error**2, axis=1))

    @property
    def peak(self) -> Array:
        """Largest error of each axis."""
        return np.abs(self.error).max(axis=1)

    @property
    def spectrum(self) -> tuple[Array, Array]:
        """Frequencies, Hz, and the root mean square (axes, frequencies) of the error at each, its mean left out."""
        from scipy.signal import periodogram

        frequencies, power = periodogram(self.error, 1 / self.dt, scaling="spectrum")
        return frequencies, np.sqrt(power)


def closed_loop(
    stage: Stage,
    reference: Array,
    gains: PI,
    feedforward: Array | None = None,
    *,
    substeps: int = 20,
    delay: int = 1,
    quantum: float | Array = 0.0,
    limits: Limits | None = None,
) -> Tracking:
    """Let a stage follow a reference (axes, samples), from rest. With gains of zero it is the open loop.

    stage: one at the sample time of the controller over `substeps`; the drive jumps within the first of them and then
    holds. delay: samples that pass from a reading to the drive that answers it; the feedforward is known ahead and is
    not late. quantum: a count of the sensor, one or (axes,), 0 for none.
    An axis that is not measured gets the feedforward alone.
    """
    dt, axes = substeps * stage.dt, len(reference)
    ahead = np.zeros(reference.shape) if feedforward is None else feedforward
    rates = gains.sampled(dt) * np.isin(np.arange(axes), stage.model.measured)[:, None]
    within = np.full((axes, 3), np.inf) * [-1, 1, 1]
    if limits:
        within = np.column_stack([limits.drive, limits.slew * dt])
    counts = np.full(axes, np.asarray(quantum, dtype=np.float64))
    drive, reading = stage.part(EVERYTHING).regulate(reference, ahead, rates, within, counts, delay, substeps)
    rest = np.clip(ahead[:, :1], within[:, :1], within[:, 1:2])
    displacement = stage.part(MOVED).respond(np.hstack([rest, drive[:, :-1]]))[:, ::substeps]
    return Tracking(dt, reference, displacement, reading, drive[:, ::substeps])
