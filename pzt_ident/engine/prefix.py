"""What the first blocks of a chain make of a record where all candidates have them alike: run once, and kept."""

from __future__ import annotations

from contextlib import suppress
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.record import Record
from pzt_ident.engine.kernel import PADDING, WIDTH, address, run
from pzt_ident.engine.program import Program

Array = NDArray[np.float64]
Steps = NDArray[np.int64]

KEPT = 4  # prefixes of a record
MOST_SAMPLES = 2**20  # steps of a record: of a longer one nothing is kept
SIGNALS: WeakKeyDictionary[Record, dict[Any, Array | None]] = WeakKeyDictionary()


def shared_prefix(program: Program, scratch: Array, steps: Steps, signals: Array, count: int) -> tuple[Steps, Array]:
    """The steps with the first of them, the count that all candidates share, in place of fills with what they make, and
    the signals with that as further rows; as they are where nothing is shared, or where it is asked for the first time
    of few candidates. scratch: before it is run."""
    if not count or signals.shape[1] > MOST_SAMPLES:
        return steps, signals
    alone = scratch.reshape(len(scratch), -1, WIDTH)[0, : program.ends[count - 1], 0]
    key = alone.tobytes(), steps[:count].tobytes(), id(signals)
    kept = SIGNALS.setdefault(program.record, {})
    again = key in kept
    longer = kept.pop(key, None)
    if longer is None and (again or len(scratch) > 1):
        longer = np.vstack([signals, tiles_after(program, scratch[:1].copy(), steps[:count], signals)])
    kept[key] = longer
    for oldest in list(kept)[:-KEPT]:
        with suppress(KeyError):  # gone by another thread
            del kept[oldest]
    if longer is None:
        return steps, signals
    fills = [(address("fill"), 0, len(signals) + tile, tile, 0) for tile in range(program.tiles)]
    return np.vstack([np.array(fills, dtype=np.int64), steps[count:]]), longer


def shared_operations(program: Program, scratch: Array) -> int:
    """How many operations, from the first on, have the same numbers for all candidates; 0 if no operator is among
    them, which is what is worth sparing, or nothing is behind."""
    lanes, needed = scratch.reshape(len(scratch), -1, WIDTH)[:, : program.chain_rows], program.operator_end
    if needed is None or (lanes[0, :needed, 0] != lanes[0, :needed, 1]).any():
        return 0
    differing = np.flatnonzero((lanes != lanes[:1, :, :1]).any(axis=(0, 2)))
    alike = int(differing[0]) if differing.size else program.chain_rows
    count = int(np.searchsorted(program.ends, alike, side="right"))
    return count if alike >= needed and count < len(program.operations) else 0


def tiles_after(program: Program, scratch: Array, steps: Steps, signals: Array) -> Array:
    """The signals of all tiles after some steps of one candidate, as rows of the kernel's signals."""
    samples = signals.shape[1] - 1 - PADDING
    tiles = np.empty((1, program.tiles, samples))
    run(steps, signals, scratch, 1, program.tiles, 0, samples, 0, 1, tiles, np.arange(program.tiles))
    return np.pad(tiles[0], ((0, 0), (1, PADDING)), mode="edge")
