"""Names of the numbers that a block keeps, in the words of its author."""

from __future__ import annotations

import ast
from collections.abc import Iterable
from typing import Any, NamedTuple

from pzt_ident.control.export.trees import name, number
from pzt_ident.engine.lanes import Layout
from pzt_ident.model.block import Beside, Block, Coupling, Operator, Relays, Shift, argument_names

WORK = {"operator": ("last", "crossed", "move"), "bank": ("low", "high", "resting")}


class Group(NamedTuple):
    """Fields of all copies (branches, or pairs of axes) of a block: rows first, first + 1, ... a copy."""

    first: int
    words: tuple[str, ...]
    copies: int
    given: bool = False


class Fields:
    """Of a block's scratch as `Layout` says. A field is a number, or one a copy.

    raw: the rows behind those that have names are an array `cells`.
    """

    def __init__(self, block: type[Block], layout: Layout, variant: Any) -> None:
        self.copies = layout.copies
        states, coefficients, terms = self._words(block, layout)
        known = argument_names(block.terms) if variant.terms else ()  # type: ignore[attr-defined]
        given = (*block.arguments(), *known) if layout.copies == 1 else block.arguments()
        weights = [f"{word}_{axis}" for word in getattr(block, "weights", ()) for axis in range(variant.axes)]
        row, self.groups = 0, []
        self.short = {f"{letter}{i}" for letter, words in zip("ske", (states, coefficients, terms), strict=True)
                      for i in range(len(words))}  # fmt: skip
        for words, copies, is_given in (
            (states, layout.copies, False),
            (coefficients, layout.copies, False),
            (terms, 1, False),
            ((*given, *weights), layout.copies, True),
            (WORK.get(block.kind, ()) if layout.work == 3 else (), 1, False),
        ):
            self.groups.append(Group(row, tuple(words), copies, is_given))
            row += copies * len(words)
        self.weights, self.given = weights, given
        many = {item.name for item in block.parameters().values() if item.count is not None or self.pairs(block)}
        others = block.asked_of_others() if issubclass(block, Coupling) else ()
        self.arrays = {*many, *others, *getattr(block, "solved", ())}
        self.cells_from, self.cells = row, layout.rows - row if issubclass(block, Relays) else 0
        self.names = {
            word: group.copies for group in self.groups for word in group.words if not group.given or word in weights
        }

    @staticmethod
    def pairs(block: type[Block]) -> bool:
        """Whether each pair of axes has parameters of its own."""
        return issubclass(block, Coupling)

    @staticmethod
    def _words(block: type[Block], layout: Layout) -> tuple[list[str], list[str], list[str]]:
        """Of the states, the coefficients and the coefficients of terms, each once."""
        if issubclass(block, Operator):
            shared, regime = argument_names(block.output)[2:], argument_names(block.travel)[1:]  # type: ignore[attr-defined]
            sides = [f"{word}_{side}" for side in ("along", "against") for word in regime]
            terms = argument_names(block.lift)[3 : 3 + layout.terms] if layout.terms else ()  # type: ignore[attr-defined]
            words = unique(["h", *shared, *sides, *terms, *WORK["operator"]])
            return words[:1], words[1 : 1 + layout.coefficients], words[1 + layout.coefficients : -3]
        if issubclass(block, Shift):
            return [], ["late"], []
        if issubclass(block, Relays):
            groups = [argument_names(getattr(block, word))[1:] for word in ("field", "leave", "output")]
            words = unique([*groups[0], *groups[1], *groups[2][1:]])
            return [], words, []
        step = argument_names(block.step)  # type: ignore[attr-defined]
        inputs = 2 if issubclass(block, Beside | Coupling) else 1
        words = unique([*step[: layout.states], *step[layout.states + inputs :]])
        return words[: layout.states], words[layout.states :], []

    def used(self, words: set[str]) -> list[str]:
        """What init asks for."""
        return [word for word in dict.fromkeys(self.given) if word in words]

    def place(self, index: ast.expr, ctx: ast.expr_context) -> ast.expr:
        """The field that an index of c means."""
        offset, step, variable = affine(index)
        for group in self.groups:
            size = len(group.words)
            inside = group.first <= offset < group.first + group.copies * size
            if inside and (variable is None or (group.copies > 1 and step == size)):
                copy, word = divmod(offset - group.first, size)
                return self.field(group, group.words[word], plus(variable, copy), ctx)
        cells = ast.Attribute(name("c"), "cells", ast.Load())
        return ast.Subscript(cells, shifted(index, -self.cells_from), ctx)

    def field(self, group: Group, word: str, copy: ast.expr, ctx: ast.expr_context) -> ast.expr:
        if group.given and word == "branch":
            return copy
        if group.given and word not in self.weights:
            many = group.copies > 1 and word in self.arrays
            return ast.Subscript(name(word), copy, ctx) if many else ast.Name(word, ctx)
        attribute = ast.Attribute(name("c"), word, ast.Load() if group.copies > 1 else ctx)
        return ast.Subscript(attribute, copy, ctx) if group.copies > 1 else attribute


def unique(words: Iterable[str]) -> list[str]:
    """Words, with a number at the end where one comes again."""
    names: list[str] = []
    for word in words:
        options = [word, *(f"{word}_{n}" for n in range(2, 100))]
        names.append(next(option for option in options if option not in names))
    return names


def affine(index: ast.expr) -> tuple[int, int, ast.expr | None]:
    """offset, step and variable of offset + step * variable, or the sum of the constants of another sum."""
    if isinstance(index, ast.Constant):
        return value_of(index), 0, None
    if isinstance(index, ast.BinOp) and isinstance(index.op, ast.Add):
        left, right = affine(index.left), affine(index.right)
        if left[2] is None or right[2] is None:
            return left[0] + right[0], left[1] + right[1], left[2] or right[2]
        return left[0] + right[0], -1, index
    if isinstance(index, ast.BinOp) and isinstance(index.op, ast.Mult) and isinstance(index.right, ast.Constant):
        return 0, value_of(index.right), index.left
    return 0, 1, index


def value_of(node: ast.Constant) -> int:
    return int(node.value)  # type: ignore[arg-type]


def plus(variable: ast.expr | None, copy: int) -> ast.expr:
    if variable is None:
        return number(copy)
    return ast.BinOp(variable, ast.Add(), number(copy)) if copy else variable


def shifted(index: ast.expr, by: int) -> ast.expr:
    """index + by, with one constant."""
    terms: list[ast.expr] = []
    total = by
    stack = [index]
    while stack:
        node = stack.pop(0)
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add):
            stack = [node.left, node.right, *stack]
        elif isinstance(node, ast.BinOp) and isinstance(node.op, ast.Sub) and isinstance(node.right, ast.Constant):
            stack, total = [node.left, *stack], total - value_of(node.right)
        elif isinstance(node, ast.Constant):
            total += value_of(node)
        else:
            terms.append(node)
    if total or not terms:
        terms.append(number(abs(total)))
    result = terms[0]
    for term in terms[1:]:
        less = term is terms[-1] and total < 0
        result = ast.BinOp(result, ast.Sub() if less else ast.Add(), term)
    return result


class InFields(ast.NodeTransformer):
    """Fields in the place of indices of c."""

    def __init__(self, fields: Fields) -> None:
        self.fields = fields

    def visit_Subscript(self, node: ast.Subscript) -> ast.expr:
        self.generic_visit(node)
        if isinstance(node.value, ast.Name) and node.value.id == "c":
            return self.fields.place(node.slice, node.ctx)
        return node
