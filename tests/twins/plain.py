"""Slow twin of the kernel: the author's own functions, one candidate, one sample after the other, in plain Python."""

import math
from itertools import pairwise, permutations
from types import SimpleNamespace

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.signal import resample

from pzt_ident.model.block import Bank, Beside, Coupling, Modes, Operator, Place, Relays, Shift, argument_names

SIZES = ("span", "peak")  # of the drive of the axis itself


@np.errstate(over="ignore", invalid="ignore")
def simulate(model, record, theta):
    """What `Model.simulate` gives for one candidate: (measured axes, samples). Once a number overflows, NaN.

    The prompt response of an operator is driven by what the readouts make of the drive, its memory by the drive. What
    was before the record is nothing: its amounts are at their null.
    """
    drives = [np.tile(fine(row, model, record), record.run_in + 1) for row in record.drive]
    drives = [
        np.append(rise(row[0], level, model, record), row) for row, level in zip(drives, at_rest(record), strict=True)
    ]
    early = [block for block in model.blocks if block.place < Place.READOUT and not block.lead]
    readouts = [block for block in model.blocks if block.place == Place.READOUT]
    middle = [block for block in model.blocks if Place.READOUT < block.place < Place.GUIDE]
    late = [block for block in model.blocks if block.place >= Place.GUIDE]

    entering = through(early, model, record, theta, drives)
    prompt = through(readouts, model, record, theta, entering)
    operated = any(block.place == Place.OPERATOR for block in middle)
    forces = through(middle, model, record, theta, entering if operated else prompt, prompt)
    signals = through(late, model, record, theta, forces, forces)
    times = model.oversample * record.steps
    ahead = len(record.rest_at[:1]) + record.run_in * record.samples
    return np.array([signals[axis][ahead * times :: times] for axis in model.measured])


def at_rest(record):
    """The drive of each axis until the sample ahead of those records that have one; else None."""
    given = record.rest_at or [None] * len(record.drive)
    return [row[0] if level is None else level for level, row in zip(given, record.drive, strict=False)]


def rise(drive, level, model, record):
    """The line from rest to the first drive, a sample long."""
    times = model.oversample * record.steps if record.rest_at else 0
    return [level + (drive - level) * n / times for n in range(times)]


def through(chain, model, record, theta, signals, aside=None):
    """The signals of all axes behind some blocks; `aside` are those that a block may read besides."""
    for block in chain:
        if issubclass(block, Coupling):
            signals = couple(block, model, record, theta, signals)
            continue
        given = [parameters(model, block, record, axis, axis, theta) for axis in range(len(signals))]
        if issubclass(block, Modes):
            signals = together(block, given, model.measured[0], signals)
            continue
        terms = bool(model.terms(block))
        signals = [
            act(model.form_of(block), *each, terms) for each in zip(given, signals, aside or signals, strict=True)
        ]
    return signals


def couple(block, model, record, theta, before):
    after = list(before)
    for axis, other in permutations(range(len(before)), 2):
        values = parameters(model, block, record, axis, other, theta)
        if values is not None:
            numbers = asking(block.prepare, values | of_others(model, block, record, axis, other, theta))
            states, moved = block.start(after[axis][0], before[other][0], *numbers), []
            for y, f in zip(after[axis], before[other], strict=True):
                result = block.step(*states, y, f, *numbers)
                *states, y = result if isinstance(result, tuple) else (result,)
                moved.append(y)
            after[axis] = np.array(moved)
    return after


def of_others(model, block, record, axis, other, theta):
    """What a coupling asks of the mechanics of both axes, and of the same pair the other way round."""
    host = block.mechanics_in(model.blocks)
    if host is None:
        return {}
    own, there = (parameters(model, host, record, each, each, theta) for each in (axis, other))
    there |= parameters(model, block, record, other, axis, theta) or {"ratio": [0.0]}
    return own | {f"other_{word}": value for word, value in there.items()}


def together(block, given, first, signals):
    """Every mode under the forces of all axes, each axis moved by all modes; one that is not measured does neither."""
    enters, leaves = block.weights
    ones = [1.0] * block.branches
    moved = [np.zeros(len(signal)) for signal in signals]
    for mode in range(block.branches):
        pushes = [0.0 if own is None else own.get(enters, ones)[mode] for own in given]
        numbers = asking(block.prepare, given[first], mode)
        q = plain(block, numbers, sum(push * signal for push, signal in zip(pushes, signals, strict=True)))
        moved = [y if own is None else y + own[leaves][mode] * q for y, own in zip(moved, given, strict=True)]
    return moved


def fine(drive, model, record):
    """A line between samples, the last one held, or a smooth curve for a block that asks for it."""
    count, times = len(drive), model.oversample * record.steps
    grid = np.arange(times * count) / times
    if model.oversample == 1:
        return np.interp(grid, np.arange(count), drive, period=count if record.run_in else None)
    if record.run_in:
        return resample(drive, times * count)
    return CubicSpline(np.arange(count), drive)(np.minimum(grid, count - 1))


def parameters(model, block, record, axis, other, theta):
    """Values by name; an axis that is not measured takes nothing from another axis, and the values of the first that is
    where it is not given its own."""
    found = {"dt": [record.dt / model.oversample / record.steps], "span": [np.ptp(record.drive[axis])]}
    found["from_rest"] = [float(any(item.about_rest for item in (*model.blocks, *model.listed_terms)))]
    found |= {"peak": [np.abs([*record.drive[axis], at_rest(record)[axis]]).max()]} | {
        word: [n] for word, n in block.numbers().items()
    }
    found |= {name: [each.null] for name, each in block.parameters().items() if each.null is not None}
    if axis not in model.measured:
        if other != axis or issubclass(block, Modes):
            return None
        given = {s.word: [v] for s, v in zip(model.entries, theta, strict=True) if s.block is block and s.axis == axis}
        first = model.measured[0]
        return parameters(model, block, record, first, first, theta) | {word: found[word] for word in SIZES} | given
    own = {}
    for entry, value in zip(model.entries, theta, strict=True):
        if entry.block is block and ((entry.axis, entry.other) == (axis, other) or entry.name in model.shared):
            own.setdefault(entry.parameter.name, []).append(value)
    return found | own


def asking(function, values, branch=0):
    """The author's `prepare` or `terms`, of one branch."""
    own = {word: each[branch] if len(each) > 1 else each[0] for word, each in values.items()} | {"branch": branch}
    return function(*(own[word] for word in argument_names(function)))


def act(block, values, signal, aside, terms):
    if issubclass(block, Operator):
        numbers = asking(block.terms, values) if terms else None
        return operator(block, asking(block.prepare, values), numbers, signal, aside)
    if issubclass(block, Bank):
        prompt = aside if block.place == Place.OPERATOR else signal
        values = values | solved(block, values)
        return bank(block, [asking(block.prepare, values, branch) for branch in range(block.branches)], signal, prompt)
    numbers = asking(block.prepare, values)
    if issubclass(block, Relays):
        return relays(block, numbers, signal, aside)
    if issubclass(block, Shift):
        late = np.arange(len(signal)) - numbers[0]
        return np.interp(late, np.arange(len(signal)), signal)
    return plain(block, numbers, signal, *([aside] if issubclass(block, Beside) else []))


def solved(block, values):
    if not block.solved:
        return {}
    own = SimpleNamespace(**{word: each if len(each) > 1 else each[0] for word, each in values.items()})
    return dict(zip(block.solved, map(list, block.solve(own)), strict=True))


def plain(block, numbers, *inputs):
    state, result = block.start(inputs[-1][0], *numbers), []
    for each in zip(*inputs, strict=True):
        *state, y = np.atleast_1d(block.step(*state, *each, *numbers)).tolist()
        result.append(y)
    return np.array(result)


def bank(block, each, signal, prompt):
    states, result = [block.start(signal[0], *numbers) for numbers in each], []
    for u, v in zip(signal, prompt, strict=True):
        total = 0.0
        for i, numbers in enumerate(each):
            *states[i], y = block.step(*states[i], u, *numbers)
            total += y
        result.append(block.output(v, total, *each[0]))
    return np.array(result)


def operator(block, coefficients, terms, signal, prompt):
    """From one sample to the next. A factor on what drives h is one on h itself, as long as it is the same."""
    shared, along, against = coefficients
    (h,), before, result = block.start(signal[0]), signal[0], []
    quadrant = getattr(block, "quadrant", None)
    for u, v in zip(signal, prompt, strict=True):
        sign, distance = 1.0 if u >= before else -1.0, abs(u - before)
        middle = (u + before) / 2
        on = [
            block.quadrant(way, rate, distance, middle, sign, *shared) if quadrant else regime
            for way, rate, regime in ((1.0, along[0], along), (-1.0, against[0], against))
        ]
        up = block.lift(distance, middle, sign, *terms) if terms else 1.0
        try:
            h, before = sign * up * leg(block, sign * h / up, distance, *on), u
        except OverflowError:
            h = math.nan
        h *= block.fade(h, *terms) if terms else 1.0
        result.append(block.output(h, v, *shared))
    return np.array(result)


def leg(block, q, distance, along, against):
    """q after a monotone step, through zero where it gets there."""
    if q < 0:
        reach = block.reach(q, *against)
        if distance <= reach:
            keep, add = block.travel(distance, *against)
            return keep * q + add
        q, distance = 0.0, distance - reach
    keep, add = block.travel(distance, *along)
    return keep * q + add


def relays(block, coefficients, signal, prompt):
    """What leaves a domain in a table over the field, interpolated; all domains of a sample at once."""
    shape, energy, shared = coefficients
    spacing, half_grid = shape[0], block.interactions // 2
    grid = spacing * (np.arange(block.columns * block.fine + 1) / block.fine - block.columns // 2)
    here = np.array([block.leave(z, *energy) for z in grid]).T
    there = here[:, ::-1]  # the grid is the same about zero
    fields = [block.field(u, *shape) for u in signal]
    edges = spacing * np.arange(-half_grid, half_grid + 1)
    weights = np.array([block.mass(low, high, *shape) for low, high in pairwise(edges)]) / block.coercives
    field = np.array([block.coercive_field(i, *shape) for i in range(block.coercives)])[:, None]
    bins = list(pairwise(edges))
    up = np.array([[block.start(fields[0], half, low, high, *shape) for low, high in bins] for half in field[:, 0]])
    between, before, result = (edges[1:] + edges[:-1]) / 2, None, []
    for now, v in zip(fields, prompt, strict=True):
        middle = (now if before is None else (before + now) / 2) + between
        out, kept_up = (np.interp(middle + field, grid, row) for row in here[:2])
        back, kept_down = (np.interp(middle - field, grid, row) for row in there[:2])
        rest = back / (out + back)
        up, before = (up if before is None else rest + (up - rest) * kept_up * kept_down), now
        above, below = np.interp(now + between + field, grid, here[2]), np.interp(now + between - field, grid, there[2])
        result.append(block.output(v, np.sum((up * (above + below) - below) @ weights), *shared))
    return np.array(result)
