"""The rendered kernel of a block, for one sample of one candidate, on named fields.

`init` is what it does with the parameters alone, `step` what is left for each sample. Both are `Function`s: `c` is the
block's own record of numbers, `t` the signals of its axis (or of all axes), `u` the last drives, `fresh` the first
sample.
"""

from __future__ import annotations

import ast
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

from pzt_ident.control.export.expressions import prefix_of
from pzt_ident.control.export.fields import Fields, InFields
from pzt_ident.control.export.lower import Library, Lowering
from pzt_ident.control.export.special import Put, Special, Statements
from pzt_ident.control.export.split import Split, is_coefficient, is_fresh
from pzt_ident.control.export.trees import Function, assigned, copied, loaded, number, reads
from pzt_ident.engine.lanes import TEMPLATES, functions, layout_of, render, template_of
from pzt_ident.model.block import Block


@dataclass
class Kernel:
    """A block in its variant: `init` and `step` act on a record `fields`. `words`: what init takes."""

    name: str
    block: type[Block]
    fields: Fields
    init: Function
    step: Function


def kernel_of(library: Library, block: type[Block], variant: Any, word: str, latest: int) -> Kernel:
    """latest: the index of the newest drive in u."""
    layout = layout_of(block, variant)  # type: ignore[arg-type]
    text = (TEMPLATES / f"{template_of(block, variant)}.jinja").read_text()
    tree = ast.parse(render(text, block, layout, variant))
    tile = next(node for node in tree.body if isinstance(node, ast.FunctionDef))
    fields = Fields(block, layout, variant)
    special = Special({"n": number(1), "first": number(latest)}, tile, InFields(fields))
    body = special.block(tile.body)
    body = Kept(fields.short - rewritten(body)).block(body)
    early, late = Split(body).init(body), Split(body).step(body)
    made = partial(lowered, library, functions(block), word)
    init, step = made(f"{word}_init", early), made(word, late)
    init.parameters = fields.used(reads(init.body))
    return Kernel(word, block, fields, init, step)


def lowered(library: Library, known: dict[str, Any], word: str, called: str, body: list[ast.stmt]) -> Function:
    inner = TileLowering(library, None, called, known)
    inner.word = word
    return Function(library.names.give((word, called), called, word), "", [], 0, inner.block(body))


class TileLowering(Lowering):
    """Calls the block's own functions by the block's name."""

    word = ""

    def wish(self, node: ast.Call, source: Any) -> tuple[str, str]:
        assert isinstance(node.func, ast.Name)
        return f"{self.word}_{node.func.id}", prefix_of(source.__module__)


def rewritten(body: Sequence[ast.stmt]) -> set[str]:
    """Coefficients that get another value for a sample, which is not kept."""
    words: set[str] = set()
    for statement in body:
        if isinstance(statement, ast.For) or (isinstance(statement, ast.If) and not is_fresh(statement)):
            words |= rewritten(statement.body)
        elif isinstance(statement, ast.Assign) and not isinstance(statement.value, ast.Attribute | ast.Subscript):
            words |= {word for word in assigned([statement]) if is_coefficient(word)}
    return words


class Kept(Statements):
    """Fields in the place of words such as s0 and k0, into which a kernel loads them and from which it stores them."""

    def __init__(self, words: set[str]) -> None:
        self.words = words
        self.fields: dict[str, ast.expr] = {}

    def block(self, body: Sequence[ast.stmt]) -> list[ast.stmt]:
        for statement in reversed(body):
            if isinstance(statement, ast.Assign) and self.is_kept(statement.value):
                self.fields[statement.value.id] = loaded(statement.targets[0])  # type: ignore[attr-defined]
        return super().block(body)

    def is_kept(self, node: ast.expr) -> bool:
        return isinstance(node, ast.Name) and node.id in self.words

    def statement(self, statement: ast.stmt) -> list[ast.stmt]:
        if isinstance(statement, ast.Assign):
            target, value = statement.targets[0], statement.value
            if self.is_kept(target) and isinstance(value, ast.Attribute | ast.Subscript):
                self.fields[target.id] = value  # type: ignore[attr-defined]
                return []
            if self.is_kept(value) and isinstance(target, ast.Attribute | ast.Subscript):
                return []
        return super().statement(statement)

    def expression(self, node: Any) -> Any:
        return Put(self.fields, stores=True).visit(copied(node))
