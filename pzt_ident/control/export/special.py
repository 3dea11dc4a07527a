"""A kernel for one sample of one candidate: what is known is put in, loops of one pass are unrolled."""

from __future__ import annotations

import ast
from collections.abc import Callable, Sequence
from typing import Any

from pzt_ident.control.export.fields import InFields
from pzt_ident.control.export.trees import assigned, copied, in_context, name, number, reads, walk


class Statements:
    """Rebuilds a block of statements."""

    def block(self, body: Sequence[ast.stmt]) -> list[ast.stmt]:
        return [new for statement in body for new in self.statement(statement)]

    def statement(self, statement: ast.stmt) -> list[ast.stmt]:
        if isinstance(statement, ast.For):
            body = self.block(statement.body)
            return [ast.For(statement.target, self.expression(statement.iter), body, [])] if body else []
        if isinstance(statement, ast.If):
            test, body = self.expression(statement.test), self.block(statement.body)
            orelse = self.block(statement.orelse)
            return [ast.If(test, body, orelse)] if body or orelse else []
        if isinstance(statement, ast.While):
            return [ast.While(self.expression(statement.test), self.block(statement.body), [])]
        if isinstance(statement, ast.Assign):
            targets = [self.expression(target) for target in statement.targets]
            return [ast.Assign(targets, self.expression(statement.value))]
        if isinstance(statement, ast.AugAssign):
            target: Any = self.expression(statement.target)
            return [ast.AugAssign(target, statement.op, self.expression(statement.value))]
        return []

    def expression(self, node: Any) -> Any:
        return node


class Special(Statements, ast.NodeTransformer):
    """Words that are known and indices are put in, loops of one pass are unrolled, arithmetic of integers is done."""

    def __init__(self, known: dict[str, ast.expr], tile: ast.FunctionDef, fields: InFields) -> None:
        self.counts, self.fields = assigned(tile.body), fields
        self.known = {word: value for word, value in known.items() if word not in self.counts}
        self.loops: set[str] = set()

    def expression(self, node: Any) -> Any:
        return self.fields.visit(folded(Put(self.known).visit(copied(node))))

    def statement(self, statement: ast.stmt) -> list[ast.stmt]:
        if isinstance(statement, ast.For) and isinstance(statement.target, ast.Name):
            return self.loop(statement, statement.target.id)
        if isinstance(statement, ast.If):
            test = self.expression(statement.test)
            if isinstance(test, ast.Constant):
                return self.block(statement.body if test.value else statement.orelse)
        if isinstance(statement, ast.Assign) and isinstance(statement.targets[0], ast.Name):
            word, value = statement.targets[0].id, self.expression(statement.value)
            if self.counts.get(word) == 1 and self.is_index(value):
                self.known[word] = value
                return []
        return super().statement(statement)

    def is_index(self, value: ast.expr) -> bool:
        arithmetic = (ast.BinOp, ast.Constant, ast.Name, ast.operator, ast.Load)
        plain = all(isinstance(node, arithmetic) for node in walk(value))
        whole = all(isinstance(node.value, int) for node in walk(value) if isinstance(node, ast.Constant))
        return plain and whole and reads(value) <= self.loops

    def loop(self, statement: ast.For, word: str) -> list[ast.stmt]:
        limits = [self.expression(limit) for limit in statement.iter.args]  # type: ignore[attr-defined]
        first, last, step = [number(0), *limits, number(1)] if len(limits) == 1 else [*limits, number(1)][:3]
        if (
            isinstance(last, ast.IfExp)
            and ast.unparse(last).startswith("1 if")
            and ast.unparse(last).endswith("else 0")
        ):
            return [ast.If(last.test, self.pass_of(statement, word, first), [])]
        if all(isinstance(limit, ast.Constant) for limit in (first, last, step)):
            passes = range(first.value, last.value, step.value)
            if len(passes) < 2:
                return [new for i in passes for new in self.pass_of(statement, word, number(i))]
        self.loops.add(word)
        self.known.pop(word, None)
        body = self.block(statement.body)
        return [ast.For(statement.target, ast.Call(name("range"), [first, last, step], []), body, [])]

    def pass_of(self, statement: ast.For, word: str, at: ast.expr) -> list[ast.stmt]:
        self.known[word] = at
        return self.block(statement.body)


class Put(ast.NodeTransformer):
    """Expressions in the place of words."""

    def __init__(self, known: dict[str, ast.expr], stores: bool = False) -> None:
        self.known, self.stores = known, stores

    def visit_Name(self, node: ast.Name) -> ast.expr:
        if node.id not in self.known or not (self.stores or isinstance(node.ctx, ast.Load)):
            return node
        return in_context(self.known[node.id], node.ctx)


def folded(node: Any) -> Any:
    return Fold().visit(node)


class Fold(ast.NodeTransformer):
    """Arithmetic of integers that are known, and neutral elements."""

    def visit_BinOp(self, node: ast.BinOp) -> ast.expr:
        self.generic_visit(node)
        left, right = whole(node.left), whole(node.right)
        if left is not None and right is not None and isinstance(node.op, INTEGER):
            return number(INTEGER_RULES[type(node.op)](left, right))
        if (left, type(node.op)) in ((0, ast.Add), (1, ast.Mult)):
            return node.right
        if (right, type(node.op)) in ((0, ast.Add), (0, ast.Sub), (1, ast.Mult)):
            return node.left
        return node

    def visit_Compare(self, node: ast.Compare) -> ast.expr:
        self.generic_visit(node)
        left, right = whole(node.left), whole(node.comparators[0])
        if left is None or right is None:
            return node
        return number(bool(eval(ast.unparse(node), {})))

    def visit_BoolOp(self, node: ast.BoolOp) -> ast.expr:
        self.generic_visit(node)
        stops = isinstance(node.op, ast.Or)
        left = [value for value in node.values if not (isinstance(value, ast.Constant) and bool(value.value) != stops)]
        if any(isinstance(value, ast.Constant) for value in left):
            return number(stops)
        return ast.BoolOp(node.op, left) if len(left) > 1 else left[0] if left else number(not stops)

    def visit_IfExp(self, node: ast.IfExp) -> ast.expr:
        self.generic_visit(node)
        if isinstance(node.test, ast.Constant):
            return node.body if node.test.value else node.orelse
        return node

    def visit_UnaryOp(self, node: ast.UnaryOp) -> ast.expr:
        self.generic_visit(node)
        if isinstance(node.op, ast.Not) and isinstance(node.operand, ast.Constant):
            return number(not node.operand.value)
        return node


INTEGER = (ast.Add, ast.Sub, ast.Mult, ast.FloorDiv, ast.Mod)
INTEGER_RULES: dict[type[ast.operator], Callable[[int, int], int]] = {
    ast.Add: lambda a, b: a + b,
    ast.Sub: lambda a, b: a - b,
    ast.Mult: lambda a, b: a * b,
    ast.FloorDiv: lambda a, b: a // b,
    ast.Mod: lambda a, b: a % b,
}


def whole(node: ast.expr) -> int | None:
    """The integer that a node is, if it is one."""
    return node.value if isinstance(node, ast.Constant) and type(node.value) is int else None
