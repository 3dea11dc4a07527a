"""What an amplifier can do: level, slew rate and current."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Limits:
    """Of each axis the least and the largest drive, (axes, 2), and its largest change in a second, (axes,), SI units.

    A capacitive load that takes the current I changes its voltage by at most I / C in a second.
    """

    drive: Array
    slew: Array

    def within(self, other: Limits) -> Limits:
        """The narrower limits of the two."""
        low, high = other.drive.T
        return Limits(np.clip(self.drive, low[:, None], high[:, None]), np.minimum(self.slew, other.slew))

    def clip(self, drive: Array, dt: float) -> Array:
        """The drive (axes, samples) that an amplifier puts out which is asked for another one."""
        clipped = np.clip(drive, self.drive[:, :1], self.drive[:, 1:])
        for axis, move in enumerate(self.slew * dt):
            if np.abs(np.diff(clipped[axis])).max(initial=0) > move:
                clipped[axis] = followed(clipped[axis], move)
        return clipped


def followed(drive: Array, move: float) -> Array:
    """A drive (samples,) that follows another one by at most `move` a sample."""
    output, level = np.empty(drive.shape), drive[0]
    for i, asked in enumerate(drive):
        level += min(max(asked - level, -move), move)
        output[i] = level
    return output
