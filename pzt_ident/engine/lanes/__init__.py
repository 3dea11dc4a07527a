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

from pzt_ident.engine.lanes.refusal import refusal
from pzt_ident.files import cache_folder
from pzt_ident.model.block import Bank, Beside, Block, Coupling, Modes, Operator, Place, Relays, Shift, asked
from pzt_ident.model.contract import tried

TEMPLATES = Path(__file__).parent
FUNCTIONS = (
    *("prepare", "start", "step", "output", "rests"),
    *("travel", "near", "exact", "terms", "lift", "fade"),
    *("field", "coercive_field", "mass", "leave"),
)


class Layout(NamedTuple):
    """Rows of WIDTH numbers in a block's scratch: states of all copies (branches, or pairs of axes), coefficients of
    all, what `prepare` is given of all, then work. An operator's coefficients are shared, along, against, those of
    relays shape, energy, shared: `first` and `second` count the former two. Its terms have coefficients and a share of
    what is given of their own."""

    states: int
    coefficients: int
    given: int
    copies: int
    work: int
    first: int
    second: int
    terms: int
    given_terms: int

    @property
    def first_given(self) -> int:
        return self.copies * (self.states + self.coefficients) + self.terms

    @property
    def rows(self) -> int:
        return self.first_given + self.copies * self.given + self.given_terms + self.work


class Compiled(NamedTuple):
    address: int
    layout: Layout


class Variant(NamedTuple):
    """`driven`: the block reads the drive, the same in every lane, and is the first of its axis. `readout`: what drives
    an operator's prompt response has a tile of its own. `terms`: effects act in its equation. `axes`: of a coupling."""

    driven: bool = False
    readout: bool = False
    terms: bool = False
    axes: int = 1


@cache
def compile_block(block: type[Block], variant: Variant = Variant()) -> Compiled:  # noqa: B008
    """The block's C function."""
    from pzt_ident.engine import elementary, kernel

    template = template_of(block, variant)
    layout = layout_of(block, variant)
    text = (TEMPLATES / f"{template}.jinja").read_text()
    known = [inspect.getsource(module) for module in (kernel, elementary)]
    sources = [text, kernel.VERSION, str(layout), str(variant), *known, *authors(block)]
    sources.append(block.__module__)  # which the cached code looks up
    key = hashlib.sha256("\0".join(sources).encode()).hexdigest()[:16]
    path = cache_folder() / f"{block.__name__.lower()}_{template}_{key}.py"
    if not path.exists():
        write(path, render(text, block, layout, variant, kernel))
    return Compiled(compiled(path, block).tile.address, layout)


def template_of(block: type[Block], variant: Variant) -> str:
    if issubclass(block, Operator):
        return "driven_operator" if variant.driven else "operator"
    named = {Coupling: "coupling", Modes: "modes", Bank: "bank", Shift: "shift", Relays: "relays"}
    return next((name for kind, name in named.items() if issubclass(block, kind)), "plain")


def rests(block: type[Block]) -> bool:
    """Whether the branches of a bank say when they hold still."""
    return issubclass(block, Bank) and getattr(block, "rests", None) is not None


def relays_room(block: type[Relays]) -> int:
    """Shares, weights, coercive fields, sums, the weight below each, between where each coercive field's are not at
    rest, the field before, six tables; whether lanes are alike."""
    tables = 6 * (block.fine + 1) * block.columns
    return (block.coercives + 3) * block.interactions + 3 * block.coercives + 3 + tables


def layout_of(block: type[Block], variant: Variant) -> Layout:
    """Counted by asking the block itself, with parameters in the middle of their bounds."""
    groups = tried(block)
    operator, relays = issubclass(block, Operator), issubclass(block, Relays)
    names = ("shared", "along", "against") if operator else ("shape", "energy", "shared")
    whole = groups.get("coefficients", ())
    parts = [len(groups[name]) for name in names] if operator or relays else [0, 0, len(whole)]
    states = len(groups.get("states", ()))
    axes = variant.axes
    copies = (
        block.branches if issubclass(block, Bank | Modes) else axes * (axes - 1) if issubclass(block, Coupling) else 1
    )
    work = 7 if operator else 3 if rests(block) else relays_room(block) if issubclass(block, Relays) else 0
    asking = asked(block.terms) if variant.terms else ()  # type: ignore[attr-defined]
    terms = len(groups["terms"]) if variant.terms else 0
    given = len(block.arguments()) + (2 * axes if issubclass(block, Modes) else 0)
    return Layout(states, sum(parts), given, copies, work, parts[0], parts[1], terms, len(asking))


def render(text: str, block: type[Block], layout: Layout, variant: Variant, kernel: ModuleType) -> str:
    from jinja2 import Environment, StrictUndefined

    made = Environment(trim_blocks=True, lstrip_blocks=True, undefined=StrictUndefined).from_string(text)
    return made.render(
        S=[f"s{i}" for i in range(layout.states)],
        K=[f"k{i}" for i in range(layout.coefficients)],
        G=layout.given,
        given=layout.first_given,
        first=layout.first,
        second=layout.second,
        copies=layout.copies,
        T=[f"e{i}" for i in range(layout.terms)],
        GT=layout.given_terms,
        readout=variant.readout,
        rests=rests(block),
        block=block,
        rows=layout.rows,
        work=layout.rows - layout.work,
        beside=issubclass(block, Beside),
        axes=variant.axes,
        place=block.place,
        Place=Place,
        TILES=kernel.TILES,
        W=kernel.WIDTH,
        TILE=kernel.TILE,
        UNROLL=kernel.UNROLL,
    )


def write(path: Path, text: str) -> None:
    with tempfile.NamedTemporaryFile("w", dir=path.parent, suffix=".tmp", delete=False) as file:
        file.write(text)
    os.replace(file.name, path)


def compiled(path: Path, block: type[Block]) -> Any:
    """Raises InputError for an author's function that numba cannot compile."""
    from numba.core.errors import NumbaError

    try:
        return load(path, block)
    except NumbaError as error:
        own = functions(block)
        called = {helper for function in own.values() for helper in helpers(function)}
        raise refusal(block, str(error), own, called) from None


def load(path: Path, block: type[Block]) -> Any:
    """Import the written-out source with the author's functions in it."""
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec and spec.loader
    module = importlib.util.module_from_spec(spec)
    sys.modules[path.stem] = module
    for word, function in functions(block).items():
        setattr(module, word, jitted(function))
    spec.loader.exec_module(module)
    return module


def functions(block: type[Block]) -> dict[str, FunctionType]:
    """What an author has written; a parameter may have the name of a function of another kind of block."""
    found = {word: getattr(block, word, None) for word in FUNCTIONS}
    return {word: function for word, function in found.items() if isinstance(function, FunctionType)}


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
        if isinstance(helper, FunctionType) and helper.__module__ != Block.__module__:
            found |= {helper} | helpers(helper)
    return found


def authors(block: type[Block]) -> list[str]:
    """The sources of all files that a block's functions come from."""
    own = functions(block).values()
    every = {block.__module__} | {each.__module__ for function in own for each in {function} | helpers(function)}
    return [inspect.getsource(sys.modules[name]) for name in sorted(every)]
