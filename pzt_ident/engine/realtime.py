"""A chain of blocks one sample at a time, and its input from its output, sample by sample."""

from __future__ import annotations

import numpy as np
from numba import njit

from pzt_ident.engine import root
from pzt_ident.engine.jit import call
from pzt_ident.model.block import TILES

SWEEPS = 100  # of an axis after the other, where axes act on each other
EXACT = 1e-14  # of the largest output


@njit(nogil=True, cache=True)
def advance(program, scratch, tiles, window, inputs, fresh):
    """Take every operation of the program through one sample.

    program: (operations, 3), each the address of a function, its place in the scratch and its tile. window: (axes,
    1 + length), the last inputs of each axis, the newest at the end. tiles: (TILES * axes,); on return tiles[TILES * a]
    is the output of axis a.
    """
    length = window.shape[1]
    for axis in range(inputs.size):
        for i in range(length - 1):
            window[axis, i] = inputs[axis] if fresh else window[axis, i + 1]
        window[axis, length - 1] = inputs[axis]
        tiles[TILES * axis] = inputs[axis]
    for step in range(program.shape[0]):
        axis = program[step, 2] // TILES
        call(  # type: ignore[call-arg]
            program[step, 0],
            1,
            length - 2,
            1 if fresh else 0,
            window[axis].ctypes.data + 8,
            window[axis].ctypes.data + 8,
            scratch.ctypes.data + 8 * program[step, 1],
            tiles.ctypes.data + 8 * program[step, 2],
            1,
        )


@njit(nogil=True, cache=True)
def respond(program, scratch, tiles, window, drive, substeps, fresh, output):
    """Outputs (axes, samples) to a drive (axes, samples) that is linear between its samples. window[:, -1] holds the
    drive before the first sample unless this is `fresh`, at rest under the first sample."""
    axes = drive.shape[0]
    before, inputs = np.empty(axes), np.empty(axes)
    for i in range(drive.shape[1]):
        start = fresh and i == 0
        for axis in range(axes):
            before[axis] = window[axis, -1]
        for k in range(1, 2 if start else substeps + 1):
            for axis in range(axes):
                share = (drive[axis, i] - before[axis]) * (k / substeps)
                inputs[axis] = drive[axis, 0] if start else before[axis] + share
            advance(program, scratch, tiles, window, inputs, start)
        for axis in range(axes):
            output[axis, i] = tiles[TILES * axis]


@njit(nogil=True, cache=True)
def limited(asked, before, limits):
    """What an amplifier puts out: limits are the least and the largest drive and its largest change in a sample."""
    level = min(max(asked, limits[0]), limits[1])
    return min(max(level, before - limits[2]), before + limits[2])


@njit(nogil=True, cache=True)
def regulate(program, scratch, tiles, window, substeps, target, ahead, gains, limits, quantum, delay, drive, reading):
    """PI control of the outputs to a target, with a feedforward that is known ahead, from rest under its first sample.

    target, ahead, reading: (axes, samples). gains: (axes, 3), of the error, of its sum, and of what the limits take
    away, which goes back into the sum. limits: (axes, 3), as in `limited`. quantum: (axes,), a count of the sensor, or
    0. delay: samples from a reading to the drive that answers it. drive: (axes, steps * samples); it jumps at the start
    of a sample, within one step, and holds for the others.
    """
    axes, samples = target.shape
    steps = drive.shape[1] // samples
    level, integral, output = np.zeros((axes, delay + 1)), np.zeros(axes), np.empty((axes, steps))
    for axis in range(axes):
        for i in range(delay + 1):
            early = ahead[axis, min(max(i - 1, 0), samples - 1)]
            level[axis, i] = min(max(early, limits[axis, 0]), limits[axis, 1])
    respond(program, scratch, tiles, window, level[:, :1].copy(), substeps, True, output)
    for i in range(samples):
        for axis in range(axes):
            reading[axis, i] = tiles[TILES * axis]
            if quantum[axis] > 0:
                reading[axis, i] = quantum[axis] * np.round(reading[axis, i] / quantum[axis])
            error = target[axis, i] - reading[axis, i]
            integral[axis] += gains[axis, 1] * error
            asked = ahead[axis, min(i + delay, samples - 1)] + gains[axis, 0] * error + integral[axis]
            for k in range(delay):
                level[axis, k] = level[axis, k + 1]
            level[axis, -1] = limited(asked, level[axis, -1], limits[axis])
            integral[axis] += gains[axis, 2] * (level[axis, -1] - asked)
            for k in range(steps * i, steps * (i + 1)):
                drive[axis, k] = level[axis, 0]
        respond(program, scratch, tiles, window, drive[:, steps * i : steps * (i + 1)], substeps, False, output)


@njit(nogil=True, cache=True)
def beyond(tiles, target, weights):
    """Weighted sum of the outputs beyond their target."""
    total = 0.0
    for axis in range(target.size):
        total += weights[axis] * (tiles[TILES * axis] - target[axis])
    return total


@njit(nogil=True, cache=True)
def put(scratch, window, saved, kept):
    """Fill scratch and window with those that were saved, by loops: slices would be half of the compilation."""
    for i in range(saved.size):
        scratch[i] = saved[i]
    for axis in range(kept.shape[0]):
        for i in range(kept.shape[1]):
            window[axis, i] = kept[axis, i]


@njit(nogil=True, cache=True)
def seek(program, scratch, tiles, window, saved, kept, target, weights, fresh, search, trial, axis):
    """Move the input of one axis to where the weighted outputs meet their target; the state stays as `saved`."""
    more = True
    while more:
        trial[axis] = search[root.X]
        advance(program, scratch, tiles, window, trial, fresh)
        put(scratch, window, saved, kept)
        more = root.propose(search, beyond(tiles, target, weights))
    trial[axis] = search[root.X]


@njit(nogil=True, cache=True)
def solve(program, scratch, tiles, window, target, free, limits, move, slopes, mixing, fresh, inputs, wrong, missed):
    """Inputs (axes, samples) under which the outputs are the target (axes, samples).

    free: axes that are solved for, one after the other until all are met; the others keep what is in `inputs`.
    limits: (axes, 2). move: (axes,), the largest change of an input in a sample. slopes: (axes,), estimates of the
    slope of each output, whose signs count. mixing: (axes, axes), mixes the outputs so that each depends on its own
    input, as nearly as can be. wrong: (axes, samples), set to 1 where an output first moves away from its target.
    missed: (axes, samples), outputs beyond their target.
    """
    search = np.zeros(root.SIZE)
    saved, kept = scratch.copy(), window.copy()
    scale = np.zeros(target.shape[0])
    for axis in range(target.shape[0]):
        for i in range(target.shape[1]):
            scale[axis] = max(scale[axis], EXACT * abs(target[axis, i]))
        scale[axis] += 1e-300
    trial = window[:, -1].copy()
    for i in range(target.shape[1]):
        first = fresh and i == 0
        before = trial.copy()
        for axis in range(trial.size):
            if not free[axis]:
                trial[axis] = inputs[axis, i]
        for _ in range(SWEEPS if free.sum() > 1 else 1):
            for axis in range(trial.size):
                if free[axis]:
                    low, high = limits[axis, 0], limits[axis, 1]
                    if not first:
                        low, high = max(low, before[axis] - move[axis]), min(high, before[axis] + move[axis])
                    root.begin(search, trial[axis], 1e-9 * abs(trial[axis]) + 1e-12, low, high, slopes[axis])
                    asked = target[:, i], mixing[axis]
                    seek(program, scratch, tiles, window, saved, kept, *asked, first, search, trial, axis)
                    wrong[axis, i] = max(wrong[axis, i], search[root.WRONG])
            advance(program, scratch, tiles, window, trial, first)
            met = True
            for axis in range(trial.size):
                met = met and (not free[axis] or abs(tiles[TILES * axis] - target[axis, i]) <= scale[axis])
            if met:
                break
            put(scratch, window, saved, kept)
        if not met:
            advance(program, scratch, tiles, window, trial, first)
        put(saved, kept, scratch, window)
        for axis in range(trial.size):
            inputs[axis, i] = trial[axis]
            missed[axis, i] = tiles[TILES * axis] - target[axis, i]
