"""Syntax trees of reduced functions, and small questions about them."""

from __future__ import annotations

import ast
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

Value = Any  # an expression of one number, or a tuple of values


@dataclass
class Function:
    """A function of numbers and arrays with `results` numbers as its value; 0: it changes the arrays."""

    name: str
    doc: str
    parameters: list[str]
    results: int
    body: list[ast.stmt]
    value: Value = ()
    arrays: set[str] = field(default_factory=set)


def shape(value: Value) -> Any:
    """() for a number, else the shapes of the members; the name of an array stays."""
    return tuple(map(shape, value)) if isinstance(value, tuple) else "number"


def nested(value: Value, one: ast.expr) -> Value:
    """An expression in the shape of a value of one number."""
    return tuple(nested(member, one) for member in value if flat(member)) if isinstance(value, tuple) else one


def flat(value: Value) -> list[ast.expr]:
    return [one for member in value for one in flat(member)] if isinstance(value, tuple) else [value]


def name(word: str) -> ast.expr:
    return ast.Name(word, ast.Load())


def number(value: float) -> ast.expr:
    return ast.Constant(value)


def assign(target: ast.expr | list[ast.expr], value: ast.expr) -> ast.stmt:
    """One number, or several from a call."""
    if isinstance(target, list):
        return ast.Assign([ast.Tuple([*map(stored, target)], ast.Store())], value)
    return ast.Assign([stored(target)], value)


def stored(place: ast.expr) -> Any:
    """A place that is assigned."""
    return ast.Name(place.id, ast.Store()) if isinstance(place, ast.Name) else place


def walk(tree: ast.AST) -> list[ast.AST]:
    """A node and all below it, level by level, but for the contexts of names: `ast.walk` was half of an export."""
    nodes = [tree]
    for node in nodes:
        content = vars(node)
        for word in node._fields:
            value = content.get(word) if word != "ctx" else None
            if isinstance(value, ast.AST):
                nodes.append(value)
            elif isinstance(value, list):
                nodes += [item for item in value if isinstance(item, ast.AST)]
    return nodes


def reads(tree: ast.AST | Sequence[ast.AST]) -> set[str]:
    """The names of which something reads the value."""
    trees = [tree] if isinstance(tree, ast.AST) else tree
    nodes = [node for tree in trees for node in walk(tree)]
    words = {node.id for node in nodes if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load)}
    return words | {
        node.target.id for node in nodes if isinstance(node, ast.AugAssign) and isinstance(node.target, ast.Name)
    }


def assigned(body: Sequence[ast.stmt]) -> dict[str, int]:
    """How often each word is assigned."""
    counts: dict[str, int] = {}
    for statement in body:
        for node in walk(statement):
            if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
                counts[node.id] = counts.get(node.id, 0) + 1
    return counts


def copied(node: Any) -> Any:
    if isinstance(node, list):
        return [copied(item) for item in node]
    if not isinstance(node, ast.AST):
        return node
    made = type(node).__new__(type(node))
    vars(made).update({word: copied(value) for word, value in vars(node).items()})
    return made


def in_context(node: ast.expr, ctx: ast.expr_context) -> Any:
    """A copy that is read, or one that is assigned."""
    node = copied(node)
    if hasattr(node, "ctx"):
        node.ctx = ctx
    return node


def loaded(node: ast.expr) -> Any:
    return in_context(node, ast.Load())


def indexed(word: str, body: Sequence[ast.stmt]) -> bool:
    """Whether a word is that of an array."""
    return any(
        isinstance(node, ast.Subscript) and isinstance(node.value, ast.Name) and node.value.id == word
        for statement in body
        for node in walk(statement)
    )


def words_in(body: Sequence[ast.stmt]) -> set[str]:
    return {node.id for statement in body for node in walk(statement) if isinstance(node, ast.Name)}


def counts(body: Sequence[ast.stmt]) -> dict[str, int]:
    """How often each word occurs."""
    counts: dict[str, int] = {}
    for statement in body:
        for node in walk(statement):
            if isinstance(node, ast.Name):
                counts[node.id] = counts.get(node.id, 0) + 1
    return counts


def direct(statement: ast.stmt) -> list[str]:
    """The words that a statement itself assigns."""
    if not isinstance(statement, ast.Assign):
        return []
    target = statement.targets[0]
    members = target.elts if isinstance(target, ast.Tuple) else [target]
    return [member.id for member in members if isinstance(member, ast.Name)]


def value_of(statement: ast.stmt) -> ast.AST:
    return statement.value if isinstance(statement, ast.Assign) else ast.Tuple([], ast.Load())
