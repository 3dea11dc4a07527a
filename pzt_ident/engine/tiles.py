"""C functions that are the same for all blocks: they fill and keep tiles, add up errors, and run them all."""

from __future__ import annotations

from numba import cfunc, types

from pzt_ident.engine.jit import OPTIONS, call, compiled, pointer, spread, widen
from pzt_ident.engine.kernel import TILE, WIDTH


@compiled
def fill(samples, first, fresh, drive, runs, scratch, tile, lanes):
    """The drive itself, the same in every lane."""
    widen()  # type: ignore[call-arg]
    for i in range(samples):
        spread(tile, i, drive[first + i])


@compiled
def keep_prompt(samples, first, fresh, drive, runs, scratch, tile, lanes):
    """Keep the drive ahead of the readout blocks, the input of the operator's prompt response."""
    for i in range(samples * WIDTH):
        tile[TILE * WIDTH + i] = tile[i]


@compiled
def keep_force(samples, first, fresh, drive, runs, scratch, tile, lanes):
    """Keep the force on the mechanics."""
    for i in range(samples * WIDTH):
        tile[2 * TILE * WIDTH + i] = tile[i]


@compiled
def keep_prompt_of_sample(samples, first, fresh, drive, runs, scratch, tile, lanes):
    """The same for one candidate and one sample a call."""
    tile[1] = tile[0]


@compiled
def keep_force_of_sample(samples, first, fresh, drive, runs, scratch, tile, lanes):
    """The same for one candidate and one sample a call."""
    tile[2] = tile[0]


@compiled
def errors(samples, first, fresh, response, runs, sums, tile, lanes):
    """Add up e and e^2, e = y - response."""
    widen()  # type: ignore[call-arg]
    even = samples - samples % 2
    for i in range(0, even, 2):
        r0, r1 = response[first + i], response[first + i + 1]
        for j in range(WIDTH):
            e0, e1 = tile[i * WIDTH + j] - r0, tile[(i + 1) * WIDTH + j] - r1
            sums[j] += e0 + e1
            sums[WIDTH + j] += e0 * e0 + e1 * e1
    for i in range(even, samples):
        for j in range(WIDTH):
            e0 = tile[i * WIDTH + j] - response[first + i]
            sums[j] += e0
            sums[WIDTH + j] += e0 * e0


@compiled
def products(samples, first, fresh, response, runs, sums, tile, lanes):
    """Add up e = y - response and the signals of additions, and the products of each pair of them: x_0, x_0 x_0, x_1,
    x_1 x_0, x_1 x_1, ..., with x_0 = e. Row 0 of sums: the number of signals; row 1: the tile of e, ahead of theirs,
    counted from that of y."""
    widen()  # type: ignore[call-arg]
    count, begin = int(sums[0]), int(sums[WIDTH]) * TILE * WIDTH
    for i in range(samples):
        for j in range(WIDTH):
            tile[begin + i * WIDTH + j] = tile[i * WIDTH + j] - response[first + i]
    row, even = 2 * WIDTH, samples - samples % 4
    for k in range(count + 1):
        x = begin + k * TILE * WIDTH
        for i in range(0, even, 4):
            for j in range(WIDTH):
                a = x + i * WIDTH + j
                sums[row + j] += tile[a] + tile[a + WIDTH] + (tile[a + 2 * WIDTH] + tile[a + 3 * WIDTH])
        for i in range(even, samples):
            for j in range(WIDTH):
                sums[row + j] += tile[x + i * WIDTH + j]
        for m in range(k + 1):
            row += WIDTH
            y = begin + m * TILE * WIDTH
            for i in range(0, even, 4):
                for j in range(WIDTH):
                    a, b = x + i * WIDTH + j, y + i * WIDTH + j
                    first_two = tile[a] * tile[b] + tile[a + WIDTH] * tile[b + WIDTH]
                    last_two = tile[a + 2 * WIDTH] * tile[b + 2 * WIDTH] + tile[a + 3 * WIDTH] * tile[b + 3 * WIDTH]
                    sums[row + j] += first_two + last_two
            for i in range(even, samples):
                for j in range(WIDTH):
                    sums[row + j] += tile[x + i * WIDTH + j] * tile[y + i * WIDTH + j]
        row += WIDTH


whole, integers = types.intp, types.CPointer(types.int64)


@cfunc(types.void(integers, *[whole] * 9, pointer, *[whole] * 4, pointer, whole, integers, whole), **OPTIONS)
def run(program, steps, signals, rows, row, scratch, groups, group, candidates, at, tiles, begin, end, since, stride,
        output, kept, wanted, count):  # fmt: skip
    """Run every group through the samples from `begin` to `end`, as `kernel.run`, which see. program: (steps, 5).
    signals: address of `rows` rows of `row` bytes. scratch: address of `groups` groups of `group` bytes. tiles: also as
    an address, `at`. output: (candidates, count, kept). wanted: (count,), the tiles of the output."""
    for g in range(groups):
        lanes = min(WIDTH, candidates - g * WIDTH)
        for first in range(begin, end, TILE):
            here = min(TILE, end - first)
            for s in range(0, 5 * steps, 5):
                skip = max(0, program[s + 4] - first)
                if skip < here:
                    call(  # type: ignore[call-arg]
                        program[s],
                        here - skip,
                        first + skip,
                        1 if first <= program[s + 4] else 0,
                        signals + row * program[s + 2] + 8,
                        signals + row * min(program[s + 2] + 1, rows - 1) + 8,
                        scratch + group * g + 8 * WIDTH * program[s + 1],
                        at + 8 * WIDTH * (TILE * program[s + 3] + skip),
                        lanes,
                    )
            left = max(first, since)
            left += (since - left) % stride
            for k in range(count if kept else 0):
                i = left
                while i < first + here:
                    for j in range(lanes):
                        place = ((g * WIDTH + j) * count + k) * kept + (i - since) // stride
                        output[place] = tiles[(wanted[k] * TILE + i - first) * WIDTH + j]
                    i += stride
