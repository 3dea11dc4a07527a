"""Records that begin with a step: the response moves while the drive hardly does."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.record import Record

HARDLY = 0.1  # of the range of the drive, within which the response
FAR = 0.3  # of its own moves further than any hysteresis lets it


def start_steps(record: Record) -> list[str]:
    """A sentence for each measured axis of which the response moves at the start as after a step of the drive."""
    if record.rest_at or record.run_in:
        return []
    pairs = [(record.axes[axis], record.drive[axis], record.response[axis]) for axis in record.measured]
    return [
        f"{axis} moves by {100 * share:.0f} % of its range while the drive first moves by {100 * HARDLY:.0f} % of its, "
        "as after a step: if the stage rested at another drive until then, say so, as by `rest_at: 0 V`"
        for axis, drive, response in pairs
        if (share := first_move(drive, response)) >= FAR
    ]


def first_move(drive: NDArray[np.float64], response: NDArray[np.float64]) -> float:
    """The share of its range by which the response moves while the drive first moves by HARDLY: both (samples,)."""
    left = np.abs(drive - drive[0]) > HARDLY * np.ptp(drive)
    moved = np.abs(response - response[0])[: int(left.argmax())]
    return float(moved.max(initial=0.0) / (np.ptp(response) or 1.0))
