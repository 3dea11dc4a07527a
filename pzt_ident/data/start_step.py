"""Records that begin with a step: the response moves while the drive hardly does."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.notation import listed
from pzt_ident.data.record import Record

HARDLY = 0.1  # of the range of a drive that has hardly moved
FAR = 0.3  # of the range of a response: no hysteresis moves it as far meanwhile
FASTER = 2.0  # times as far as it ever moves later in the same time


def start_step(record: Record) -> str:
    """How far which axes move at first, where that is as after a step of which the job says nothing; else empty."""
    if record.rest_at or record.run_in:
        return ""
    moves = {record.axes[axis]: first_move(record.drive[axis], record.response[axis]) for axis in record.measured}
    stepped = [f"{axis} moves by {100 * share:.0f} % of its range" for axis, share in moves.items() if share >= FAR]
    return f"{listed(stepped)} while the drive moves by {100 * HARDLY:.0f} % of its" if stepped else ""


def first_move(drive: NDArray[np.float64], response: NDArray[np.float64]) -> float:
    """The share of its range by which the response moves at first, while the drive moves by HARDLY; 0 where it moves
    nearly as far in such a time later. drive, response: (samples,)."""
    count = int((np.abs(drive - drive[0]) > HARDLY * np.ptp(drive)).argmax())
    first = np.abs(response[:count] - response[0]).max(initial=0.0)
    later = np.abs(response[2 * count :] - response[count:-count]).max(initial=0.0) if count else 0.0
    return float(first / (np.ptp(response) or 1.0)) if first > FASTER * later else 0.0
