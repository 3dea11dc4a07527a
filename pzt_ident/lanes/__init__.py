"""The lane loop around an author's block: written out from a template, compiled by numba, kept on the disk.

One file of source a block, named by the hash of all that it is made of, so that a cached kernel is never stale.
"""

from __future__ import annotations

import hashlib
import importlib.util
import inspect
import os
import sys
import tempfile
from functools import cache
from pathlib import Path
from types import FunctionType, ModuleType
from typing import Any, NamedTuple

from pzt_ident.block import Bank, Block, Coupling, Operator
from pzt_ident.files import cache_folder

TEMPLATES = Path(__file__).parent
FUNCTIONS = ("prepare", "start", "step", "travel", "near", "exact", "output")


class Layout(NamedTuple):
    """Rows of WIDTH numbers in a block's scratch: states of all copies (branches, or pairs of axes), coefficients of
    all, what `prepare` is given of all, then work. An operator's coefficients are shared, along, against."""

    states: int
    coefficients: int
    given: int
    copies: int
    work: int
    shared: int

    @property
    def first_given(self) -> int:
        return self.copies * (self.states + self.coefficients)

    @property
    def rows(self) -> int:
        return self.copies * (self.states + self.coefficients + self.given) + self.work


class Compiled(NamedTuple):
    address: int
    layout: Layout


@cache
def compile_block(block: type[Block], axes: int, driven: bool) -> Compiled:
    """The block's C function. `driven`: it reads the drive, the same in every lane, and is the first of its axis."""
    from pzt_ident import kernel

    template = template_of(block, driven)
    layout = layout_of(block, axes, kernel.TILE)
    text = (TEMPLATES / f"{template}.jinja").read_text()
    author, host = inspect.getsource(inspect.getmodule(block)), inspect.getsource(kernel)  # type: ignore[arg-type]
    sources = [text, kernel.VERSION, str(layout), str(axes), author, host]
    key = hashlib.sha256("\0".join(sources).encode()).hexdigest()[:16]
    path = cache_folder() / f"{block.__name__.lower()}_{template}_{key}.py"
    if not path.exists():
        write(path, render(text, layout, axes, kernel))
    return Compiled(load(path, block).tile.address, layout)


def template_of(block: type[Block], driven: bool) -> str:
    if issubclass(block, Operator):
        return "driven_operator" if driven else "operator"
    return "coupling" if issubclass(block, Coupling) else "bank" if issubclass(block, Bank) else "plain"


def layout_of(block: type[Block], axes: int, tile: int) -> Layout:
    """Counted by asking the block itself, with parameters in the middle of their bounds."""
    known = {p.name: sum(p.bounds) / 2 for p in block.parameters().values()} | {"dt": 1e-3, "span": 1.0, "branch": 0}
    prepared = block.prepare(*(known[word] for word in block.arguments()))  # type: ignore[attr-defined]
    operator, coupling = issubclass(block, Operator), issubclass(block, Coupling)
    count = sum(len(part) for part in prepared) if operator else len(prepared)
    example = () if operator else prepared
    states = 0 if coupling else len(block.start(0.0, *example))  # type: ignore[attr-defined]
    copies = block.branches if issubclass(block, Bank) else axes * (axes - 1) if coupling else 1
    work = 7 if operator else tile if issubclass(block, Bank) else 0
    return Layout(states, count, len(block.arguments()), copies, work, len(prepared[0]) if operator else 0)


def render(text: str, layout: Layout, axes: int, kernel: ModuleType) -> str:
    from jinja2 import Environment, StrictUndefined

    made = Environment(trim_blocks=True, lstrip_blocks=True, undefined=StrictUndefined).from_string(text)
    return made.render(
        S=[f"s{i}" for i in range(layout.states)],
        K=[f"k{i}" for i in range(layout.coefficients)],
        G=layout.given,
        given=layout.first_given,
        shared=layout.shared,
        copies=layout.copies,
        axes=axes,
        W=kernel.WIDTH,
        TILE=kernel.TILE,
        UNROLL=kernel.UNROLL,
    )


def write(path: Path, text: str) -> None:
    with tempfile.NamedTemporaryFile("w", dir=path.parent, suffix=".tmp", delete=False) as file:
        file.write(text)
    os.replace(file.name, path)


def load(path: Path, block: type[Block]) -> Any:
    """Import the written-out source with the author's functions in it."""
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec and spec.loader
    module = importlib.util.module_from_spec(spec)
    sys.modules[path.stem] = module
    for word in FUNCTIONS:
        if function := getattr(block, word, None):
            setattr(module, word, jitted(function))
    spec.loader.exec_module(module)
    return module


def jitted(function: FunctionType) -> Any:
    """The function and the plain functions that it calls, as numba sees them."""
    from numba import njit
    from numba.extending import register_jitable

    for helper in helpers(function):
        register_jitable(forceinline=True)(helper)
    return njit(forceinline=True)(function)


def helpers(function: FunctionType) -> set[FunctionType]:
    found: set[FunctionType] = set()
    for word in function.__code__.co_names:
        helper = function.__globals__.get(word)
        if isinstance(helper, FunctionType) and helper.__module__ == function.__module__:
            found |= {helper} | helpers(helper)
    return found
