"""The loop over lanes around an author's block: rendered from a template, compiled by numba, cached on disk.

One source file per block, named by the hash of everything it depends on, so that a cached kernel is never stale.
"""

from __future__ import annotations

import importlib.util
import inspect
import sys
from functools import cache
from pathlib import Path
from types import FunctionType
from typing import TYPE_CHECKING, Any, NamedTuple

from pzt_ident.engine.lanes.compile_error import compile_error
from pzt_ident.files import cache_folder, write_text
from pzt_ident.model.block import (
    TILES,
    Addition,
    Bank,
    Beside,
    Block,
    Coupling,
    Modes,
    Operator,
    Place,
    Relays,
    Shift,
    argument_names,
    expm1,
)
from pzt_ident.model.contract import try_functions

if TYPE_CHECKING:
    from jinja2 import Template

TEMPLATES = Path(__file__).parent
FUNCTIONS = (
    *("prepare", "start", "step", "output", "rests", "rides", "limits", "read", "bend"),
    *("travel", "reach", "terms", "lift", "fade", "quadrant"),
    *("field", "coercive_field", "mass", "leave", "basis"),
)

TIME = ("_first", "_dt")  # what gives an addition its time, ahead of the arguments of `basis`


class Layout(NamedTuple):
    """Numbers of rows, of WIDTH numbers each, in a block's scratch: states of all copies (branches, or pairs of axes),
    then coefficients of all, coefficients of the terms, arguments of `prepare` of all (`given`), arguments of `terms`,
    and work space. An operator's coefficients are (shared, along, against), those of relays (shape, energy, shared):
    `first` and `second` are the sizes of the first two of these groups. smooth: branches are read by series."""

    states: int
    coefficients: int
    given: int
    copies: int
    work: int
    first: int
    second: int
    terms: int
    given_terms: int
    smooth: bool = False

    @property
    def idle(self) -> int:
        """Rows that are not counted as work: branches that are read by series take a third of the time of others."""
        return 2 * self.copies * (self.states + self.coefficients + self.given) // 3 if self.smooth else 0

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
    """`driven`: the block is the first of its axis and reads the drive, which is the same in every lane. `readout`: the
    input of an operator's prompt response has a tile of its own. `terms`: effects act in the block's equation. `axes`:
    number of axes of a coupling or of modes. `single`: one candidate and one sample a call."""

    driven: bool = False
    readout: bool = False
    terms: bool = False
    axes: int = 1
    single: bool = False


@cache
def compile_block(block: type[Block], variant: Variant = Variant()) -> Compiled:  # noqa: B008
    """The block's C function, from the cache or newly compiled."""
    from pzt_ident.engine import kernel, native

    template = template_of(block, variant)
    layout = layout_of(block, variant)  # type: ignore[arg-type]
    text = (TEMPLATES / f"{template}.jinja").read_text()
    sources = [text, kernel.VERSION, str(layout), str(variant), *kernel.sources("jit", "elementary")]
    sources += [str(kernel.SERIES), *kernel.sources("series")] if layout.smooth else []
    name = native.name_of(f"{block.__name__.lower()}_{template}", *sources, *author_sources(block))

    def tile() -> Any:
        path = cache_folder() / f"{name}.py"
        if not path.exists():
            write_text(path, render(text, block, layout, variant))
        return compiled(path, block).tile

    return Compiled(native.address_of(name, tile), layout)


def template_of(block: type[Block], variant: Variant) -> str:
    if issubclass(block, Operator):
        return "driven_operator" if variant.driven else "operator"
    if has(block, "read") and not variant.single:
        return "smooth_bank"
    templates = {
        Addition: "addition",
        Coupling: "coupling",
        Modes: "modes",
        Bank: "bank",
        Shift: "shift",
        Relays: "relays",
    }
    return next((name for kind, name in templates.items() if issubclass(block, kind)), "plain")


def has(block: type[Block], word: str) -> bool:
    """Whether the block is a bank with an optional function."""
    return issubclass(block, Bank) and getattr(block, word, None) is not None


def bank_work(block: type[Bank], smooth: bool) -> int:
    """Rows of work space, as bank.jinja, or smooth_bank.jinja, lays it out."""
    from pzt_ident.engine.kernel import SERIES

    return 14 + 6 * max(SERIES) if smooth else 3 if has(block, "rests") else 0


def relays_work(block: type[Relays]) -> int:
    """Rows of work space, as relays.jinja lays it out: shares, weights, coercive fields, sums, cumulative weights, the
    range of moving shares of each coercive field, the last field, six tables; whether the lane is a copy."""
    tables = 6 * (block.fine + 1) * block.columns
    return (block.coercives + 3) * block.interactions + 3 * block.coercives + 3 + tables


@cache
def layout_of(block: type[Block], variant: Variant) -> Layout:
    """Counted by calling the block's functions once, with parameters in the middle of their bounds."""
    groups = try_functions(block)
    operator, relays = issubclass(block, Operator), issubclass(block, Relays)
    names = ("shared", "along", "against") if operator else ("shape", "energy", "shared")
    ungrouped = groups.get("coefficients", ())
    parts = [len(groups[name]) for name in names] if operator or relays else [0, 0, len(ungrouped)]
    states = len(groups.get("states", ()))
    axes, smooth = variant.axes, template_of(block, variant) == "smooth_bank"
    copies = (
        block.branches if issubclass(block, Bank | Modes) else axes * (axes - 1) if issubclass(block, Coupling) else 1
    )
    work = (
        (4 if variant.driven else 3)
        if operator
        else bank_work(block, smooth)
        if issubclass(block, Bank)
        else relays_work(block)
        if issubclass(block, Relays)
        else 0
    )
    given_terms = argument_names(block.terms) if variant.terms else ()  # type: ignore[attr-defined]
    terms = len(groups["terms"]) if variant.terms else 0
    given = len(block.arguments()) + (2 * axes if issubclass(block, Modes) else 0)
    given += len(TIME) if issubclass(block, Addition) else 0
    return Layout(states, sum(parts), given, copies, work, parts[0], parts[1], terms, len(given_terms), smooth)


def render(text: str, block: type[Block], layout: Layout, variant: Variant) -> str:
    """The kernel's source; the header of each template names the symbols."""
    from pzt_ident.engine import kernel

    return template_of_text(text).render(
        S=[f"s{i}" for i in range(layout.states)],
        K=[f"k{i}" for i in range(layout.coefficients)],
        G=layout.given,
        given=layout.first_given,
        first=layout.first,
        second=layout.second,
        copies=layout.copies,
        T=[f"e{i}" for i in range(layout.terms)],
        B=[f"b{i}" for i in range(block.amounts())] if issubclass(block, Addition) else [],
        GT=layout.given_terms,
        readout=variant.readout,
        rests=has(block, "rests"),
        SERIES=kernel.SERIES,
        quadrant=getattr(block, "quadrant", None) is not None,
        block=block,
        rows=layout.rows,
        work=layout.rows - layout.work,
        beside=issubclass(block, Beside),
        axes=variant.axes,
        place=block.place,
        Place=Place,
        TILES=TILES,
        W=1 if variant.single else kernel.WIDTH,
        TILE=1 if variant.single else kernel.TILE,
        UNROLL=1 if variant.single else kernel.UNROLL,
    )


@cache
def template_of_text(text: str) -> Template:
    """Of lines of code."""
    from jinja2 import Environment, StrictUndefined

    return Environment(trim_blocks=True, lstrip_blocks=True, undefined=StrictUndefined).from_string(text)


def compiled(path: Path, block: type[Block]) -> Any:
    """Raises InputError for an author's function that numba cannot compile."""
    from numba.core.errors import NumbaError

    from pzt_ident.engine import elementary  # noqa: F401  numba learns of them

    try:
        return load(path, block)
    except NumbaError as error:
        authored = functions(block)
        called = {helper for function in authored.values() for helper in helpers(function)}
        raise compile_error(block, str(error), authored, called) from None


def load(path: Path, block: type[Block]) -> Any:
    """Import the rendered source with the author's functions in it."""
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec and spec.loader
    module = importlib.util.module_from_spec(spec)
    sys.modules[path.stem] = module
    for word, function in functions(block).items():
        setattr(module, word, jitted(function))
    spec.loader.exec_module(module)
    return module


def functions(block: type[Block]) -> dict[str, FunctionType]:
    """The functions of the author, by name; a parameter may have the name of a function of another kind of block."""
    attributes = {word: getattr(block, word, None) for word in FUNCTIONS}
    return {word: function for word, function in attributes.items() if isinstance(function, FunctionType)}


@cache
def jitted(function: FunctionType) -> Any:
    """The function for numba, with the plain functions that it calls registered: compiled once for all blocks and
    variants that have it."""
    from numba import njit

    for helper in helpers(function):
        register(helper)
    return njit(forceinline=True)(function)


@cache
def register(helper: FunctionType) -> None:
    """Let numba compile a plain function where another one calls it."""
    from numba.extending import register_jitable

    register_jitable(forceinline=True)(helper)


def helpers(function: FunctionType) -> set[FunctionType]:
    """The plain functions that a function calls, directly or through others, but for the elementary ones."""
    called: set[FunctionType] = set()
    for word in function.__code__.co_names:
        helper = function.__globals__.get(word)
        if isinstance(helper, FunctionType) and helper.__module__ != expm1.__module__:
            called |= {helper} | helpers(helper)
    return called


def author_sources(block: type[Block]) -> list[str]:
    """The sources of all files that a block's functions come from."""
    authored = functions(block).values()
    called = {helper for function in authored for helper in {function} | helpers(function)}
    modules = {block.__module__} | {function.__module__ for function in called}
    return [inspect.getsource(sys.modules[name]) for name in sorted(modules)]
