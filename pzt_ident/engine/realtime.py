"""A chain of blocks one sample at a time, and its input from its output, sample by sample."""

from __future__ import annotations

import numpy as np
from numba import njit

from pzt_ident.engine import root
from pzt_ident.engine.kernel import call, compiled
from pzt_ident.model.block import TILES

SWEEPS = 100  # of an axis after the other, where axes act on each other
EXACT = 1e-14  # of the largest output


@compiled
def keep_prompt(samples, first, fresh, drive, runs, scratch, tile):
    """Keep the drive ahead of the readout blocks, the input of the operator's prompt response."""
    tile[1] = tile[0]


@compiled
def keep_force(samples, first, fresh, drive, runs, scratch, tile):
    """Keep the force on the mechanics."""
    tile[2] = tile[0]


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
        )


@njit(nogil=True, cache=True)
def respond(program, scratch, tiles, window, drive, substeps, fresh, output):
    """Outputs (axes, samples) to a drive (axes, samples) that is linear between its samples. window[:, -1] holds the
    drive before the first sample unless this is `fresh`, at rest under the first sample."""
    for i in range(drive.shape[1]):
        before = window[:, -1].copy()
        for k in range(1, substeps + 1):
            if fresh and i == 0:
                if k == 1:
                    advance(program, scratch, tiles, window, drive[:, 0].copy(), True)
            else:
                advance(program, scratch, tiles, window, before + (drive[:, i] - before) * (k / substeps), False)
        for axis in range(drive.shape[0]):
            output[axis, i] = tiles[TILES * axis]


@njit(nogil=True, cache=True)
def beyond(tiles, target, weights):
    """Weighted sum of the outputs beyond their target."""
    total = 0.0
    for axis in range(target.size):
        total += weights[axis] * (tiles[TILES * axis] - target[axis])
    return total


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
        scale[axis] = EXACT * np.abs(target[axis]).max() + 1e-300
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
                    more = True
                    while more:
                        trial[axis] = search[root.X]
                        advance(program, scratch, tiles, window, trial, first)
                        scratch[:], window[:] = saved, kept
                        more = root.propose(search, beyond(tiles, target[:, i], mixing[axis]))
                    trial[axis] = search[root.X]
                    wrong[axis, i] = max(wrong[axis, i], search[root.WRONG])
            advance(program, scratch, tiles, window, trial, first)
            met = True
            for axis in range(trial.size):
                met = met and (not free[axis] or abs(tiles[TILES * axis] - target[axis, i]) <= scale[axis])
            if met:
                break
            scratch[:], window[:] = saved, kept
        if not met:
            advance(program, scratch, tiles, window, trial, first)
        saved[:], kept[:] = scratch, window
        inputs[:, i] = trial
        for axis in range(trial.size):
            missed[axis, i] = tiles[TILES * axis] - target[axis, i]
