"""The drive ahead of a record, of which nothing is recorded: the stage moves, or has moved, when its recording begins.

It sets out from 0 V, demagnetised and at rest, and ends one sample ahead of the record. An axis that rests throughout
the record rests ahead of it.
"""

import math

import numpy as np

from .campaign import through

SHORTEST, LONGEST = 1 / 20, 1 / 3  # of a record, for a way through the whole range
REST, MOST = (0.2, 2.0), 10000  # seconds, and samples of a rest


def begin(rng, records, ranges):
    """Put a drive ahead of every record, {axis: (low, high)} the ranges of the stage; the way that is drawn for all."""
    way = str(rng.choice(list(WAYS)))
    for record in records:
        WAYS[way](rng, record, ranges)
    return way


def cut(rng, record, ranges):
    """The record is cut out of a run in which its drive is played again and again, with a line back to its start."""
    ends = {axis: [u[-1], u[0]] for axis, u in record.drives.items()}
    back, size = _samples(record, ends, ranges), record.samples
    first = int(rng.uniform(0.1, 0.9) * size)
    if rng.random() < 0.3:
        first += size + back - 1  # the whole drive has been played once
    for axis, (last, start) in ends.items():
        line = np.linspace(last, start, back + 1)[1:-1]
        run = np.tile(np.concatenate([record.drives[axis], line]), 3)
        record.ahead[axis], record.drives[axis] = run[:first], run[first : first + size]


def after(rng, record, ranges):
    """Two to four turns within the range, the first drive value, and a rest there."""
    count, upper = int(rng.integers(2, 5)), int(rng.integers(2))
    turns = {}
    for axis, u in record.drives.items():
        low, high = ranges[axis]
        middle = (low + high) / 2
        sides = [(middle, high) if (i + upper) % 2 else (low, middle) for i in range(count)]
        turns[axis] = [0.0, *(float(rng.uniform(*side)) for side in sides), u[0]]
    rest = rng.uniform(REST[0], max(REST[0], min(REST[1], MOST / record.rate)))
    _approach(record, turns, ranges)
    for axis, u in record.drives.items():
        record.ahead[axis] = np.append(record.ahead[axis], np.full(math.ceil(rest * record.rate), u[0]))


def cycled(rng, record, ranges):
    """Three times through the whole range, and from its last end to the first drive value, without a rest."""
    turns = {}
    for axis, u in record.drives.items():
        ends = ranges[axis] if rng.random() < 0.5 else ranges[axis][::-1]
        turns[axis] = [0.0, *(list(ends) * 3), u[0]]
    _approach(record, turns, ranges)


WAYS = {"cut": cut, "after": after, "cycled": cycled}


def _approach(record, turns, ranges):
    """Through the turns at a constant rate; the last of them is the record's first sample."""
    turns = {axis: points if np.ptp(record.drives[axis]) else points[-1:] * 2 for axis, points in turns.items()}
    t = np.arange(_samples(record, turns, ranges) + 1.0)
    for axis, points in turns.items():
        record.ahead[axis] = through(t, points)[:-1]


def _samples(record, turns, ranges):
    """Samples that the axis with the longest way takes through its turns at the mean rate of its drive."""
    longest = 1.0
    for axis, u in record.drives.items():
        if way := float(np.sum(np.abs(np.diff(turns[axis])))):
            swing = float(np.ptp(ranges[axis]))
            rate = np.clip(np.mean(np.abs(np.diff(u))), swing / LONGEST / len(u), swing / SHORTEST / len(u))
            longest = max(longest, way / rate)
    return math.ceil(longest)
