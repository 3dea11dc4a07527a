"""Slow twin of the kernel: the author's own functions, one candidate, one sample after the other, in plain Python."""

import math

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.signal import resample

from pzt_ident.block import Bank, Coupling, Operator


def simulate(model, record, theta):
    """What `Model.simulate` gives for one candidate: (measured axes, samples). Once a number overflows, NaN."""
    times = model.oversample
    signals = [np.tile(fine(row, times, record.run_in), record.run_in + 1) for row in record.drive]
    for block in model.blocks:
        before = list(signals)
        for axis in range(len(signals)):
            others = [b for b in range(len(signals)) if b != axis] if issubclass(block, Coupling) else [axis]
            for other in others:
                known = {"dt": [record.dt / times], "span": [np.ptp(record.drive[axis])]}
                if values := parameters(model, block, axis, other, theta):
                    inputs = (signals[axis], before[other])
                    signals[axis] = act(block, values | known, *inputs)
    since = record.run_in * record.samples * times
    return np.array([signals[axis][since::times] for axis in model.measured])


def fine(drive, times, periodic):
    if times == 1:
        return drive
    if periodic:
        return resample(drive, times * len(drive))
    after_the_last = np.minimum(np.arange(times * len(drive)) / times, len(drive) - 1)
    return CubicSpline(np.arange(len(drive)), drive)(after_the_last)


def parameters(model, block, axis, other, theta):
    """Values by name; an axis that is not measured takes those of the first that is, and nothing from another axis."""
    if axis not in model.measured:
        if other != axis:
            return None
        axis = other = model.measured[0]
    found = {}
    for slot, value in zip(model.slots, theta, strict=True):
        if (slot.block, slot.axis, slot.other) == (block, axis, other):
            found.setdefault(slot.parameter.name, []).append(value)
    return found or {"": [None]}


def prepare(block, values, branch=0):
    """The author's `prepare`, of one branch."""
    own = {word: each[branch] if len(each) > 1 else each[0] for word, each in values.items()} | {"branch": branch}
    return block.prepare(*(own[word] for word in block.arguments()))


def act(block, values, signal, other):
    if issubclass(block, Operator):
        return operator(block, prepare(block, values), signal)
    if issubclass(block, Bank):
        return bank(block, [prepare(block, values, branch) for branch in range(block.branches)], signal)
    numbers = prepare(block, values)
    if issubclass(block, Coupling):
        return np.array([block.step(y, f, *numbers) for y, f in zip(signal, other, strict=True)])
    return plain(block, numbers, signal)


def plain(block, numbers, signal):
    state, result = block.start(signal[0], *numbers), []
    for u in signal:
        *state, y = np.atleast_1d(block.step(*state, u, *numbers)).tolist()
        result.append(y)
    return np.array(result)


def bank(block, each, signal):
    states, result = [block.start(signal[0], *numbers) for numbers in each], []
    for u in signal:
        total = 0.0
        for i, numbers in enumerate(each):
            *states[i], y = block.step(*states[i], u, *numbers)
            total += y
        result.append(block.output(u, total, *each[0]))
    return np.array(result)


def operator(block, coefficients, signal):
    """Only `exact`, in every sample."""
    shared, along, against = coefficients
    (h,), before, result = block.start(signal[0]), signal[0], []
    for u in signal:
        sign = 1.0 if u >= before else -1.0
        try:
            h, before = sign * block.exact(sign * h, abs(u - before), along, against), u
        except OverflowError:
            h = math.nan
        result.append(block.output(h, u, *shared))
    return np.array(result)
