"""What the machine could do at best: its fastest arithmetic and memory, and how much of both a model needs."""

from __future__ import annotations

import ast
import inspect
import textwrap
import time
from collections.abc import Callable
from types import FunctionType
from typing import Any, NamedTuple

import numpy as np
from numba import njit

from pzt_ident.engine import elementary
from pzt_ident.engine.jit import call, compiled, widen
from pzt_ident.engine.kernel import TILE, WIDTH
from pzt_ident.model.block import Addition, Bank, Block, Operator
from pzt_ident.model.chain import Chain
from pzt_ident.model.elementary import __name__ as ELEMENTARY

CHAINS, STEPS = 4, 16  # of a * x + y, each on WIDTH lanes
ERROR = 5  # operations a sample: e, its sum, and that of its square
NUMBER = 8  # bytes


class Machine(NamedTuple):
    """Operations and bytes a second: a multiplication with an addition is two, a reading and a writing are two."""

    operations: float
    bytes: float

    def seconds(self, model: Chain, samples: int, constant: bool = False) -> float:
        """At best, for one candidate: whichever of arithmetic and first cache takes longer. constant: a hysteresis
        operator keeps its coefficients from step to step."""
        forms = (*map(model.form_of, model.blocks), *model.additions)
        needs = sum(operations_of(form, constant) for form in forms) + ERROR
        needs += sum(operations(b.lift) + operations(b.fade) for b in forms if hasattr(b, "lift") and model.terms(b))
        passes = len(model.blocks) + sum(block.amounts() + 1 for block in model.additions) + 1
        return samples * max(needs / self.operations, 2 * NUMBER * passes / self.bytes)


@compiled
def arithmetic(samples, first, fresh, drive, runs, scratch, tile, lanes):
    """CHAINS * STEPS multiplications with an addition a sample and lane, in registers."""
    widen()
    for _ in range(samples):
        for j in range(WIDTH):
            x, y = scratch[j], scratch[WIDTH + j]
            a, b, c, d = tile[j], tile[WIDTH + j], tile[2 * WIDTH + j], tile[3 * WIDTH + j]
            for _ in range(STEPS):
                a, b, c, d = a * x + y, b * x + y, c * x + y, d * x + y
            tile[j], tile[WIDTH + j], tile[2 * WIDTH + j], tile[3 * WIDTH + j] = a, b, c, d


@compiled
def memory(samples, first, fresh, drive, runs, scratch, tile, lanes):
    """One reading and one writing a sample and lane, within the first cache."""
    widen()
    for i in range(samples):
        for j in range(WIDTH):
            tile[i * WIDTH + j] = tile[i * WIDTH + j] + 1.0


@njit
def repeat(address, times, scratch, tile):
    for _ in range(times):
        call(address, TILE, 0, 0, tile.ctypes.data, tile.ctypes.data, scratch.ctypes.data, tile.ctypes.data, WIDTH)


def machine() -> Machine:
    """Measured, the best of 200 goes."""
    scratch, tile, times = np.full(2 * WIDTH, 0.5), np.ones(TILE * WIDTH), 200

    def rate(function: Any) -> float:
        """Lanes a second, a sample each."""
        best = np.inf
        for _ in range(200):
            begun = time.process_time()
            repeat(function.address, times, scratch, tile)
            best = min(best, time.process_time() - begun)
        return times * TILE * WIDTH / best

    repeat(memory.address, 1, scratch, tile)
    return Machine(2 * CHAINS * STEPS * rate(arithmetic), 2 * NUMBER * rate(memory))


def operations_of(block: type[Block], constant: bool = False) -> int:
    """What the equation of a block needs in a sample, as its author wrote it."""
    if issubclass(block, Addition):
        signals = block.amounts() + 1
        return operations(block.basis) + signals * (signals + 1)
    if issubclass(block, Operator):
        return (0 if constant else operations(block.travel)) + operations(block.output) + 2
    if issubclass(block, Bank):
        return block.branches * (operations(block.step) + 1) + operations(block.output)
    step = getattr(block, "step", None)
    return operations(step) if step else 0


def operations(function: Callable[..., Any]) -> int:
    """Arithmetic operations, comparisons and choices in a function and in those that it calls."""
    tree = ast.parse(textwrap.dedent(inspect.getsource(function)))
    return sum(cost(node, function) for node in ast.walk(tree))


def cost(node: ast.AST, function: Callable[..., Any]) -> int:
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
        called = function.__globals__.get(node.func.id)
        called = getattr(elementary, node.func.id) if getattr(called, "__module__", "") == ELEMENTARY else called
        return operations(called) if isinstance(called, FunctionType) else 1
    return isinstance(node, ast.BinOp | ast.Compare | ast.IfExp) or isinstance(getattr(node, "op", None), ast.USub)
