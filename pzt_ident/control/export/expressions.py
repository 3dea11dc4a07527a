"""Expressions of author's functions: numbers, and tuples of them, which become their members."""

from __future__ import annotations

import ast
import builtins
import inspect
import math
from types import BuiltinFunctionType, FunctionType
from typing import Any

from pzt_ident.control.export.trees import Value, assign, flat, name, nested, number, shape, walk
from pzt_ident.errors import InputError
from pzt_ident.model import elementary

ELEMENTARY = {
    "exp",
    "expm1",
    "log",
    "log1p",
    "log10",
    "sqrt",
    "sin",
    "cos",
    "tan",
    "atan",
    "tanh",
    "erf",
    "erfc",
    "pow",
}
PLAIN = ("min", "max", "abs", "int", "float", "range", "bool")
REMEDY = "write it with numbers, tuples, conditional expressions, functions of `math`, and loops over a range"


class Expressions:
    """Of one function. `scope` holds the values of its local words, `out` the statements of the block at hand."""

    def __init__(self, library: Any, source: Any, name: str, known: dict[str, Any] | None = None) -> None:
        self.library, self.source, self.name = library, source, name
        self.globals = known if known is not None else source.__globals__
        self.module = "" if known is not None else source.__module__
        self.scope: dict[str, Value] = {}
        self.out: list[ast.stmt] = []
        self.value: Value = None
        self.calls = 0
        self.taken: set[str] = set()

    def refused(self, node: ast.AST, what: str = "") -> InputError:
        line = getattr(node, "lineno", 0)
        construct = what or f"`{ast.unparse(node)}`"
        return InputError(f"line {line}: {construct} cannot be exported", where=self.name, remedy=REMEDY)

    def look_up(self, node: ast.expr) -> Any:
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            return getattr(self.globals.get(node.value.id), node.attr, None)
        value = self.globals.get(node.id, getattr(builtins, node.id, None)) if isinstance(node, ast.Name) else None
        return getattr(value, "py_func", value)

    def calls_function(self, node: ast.AST) -> bool:
        """Whether a function of an author is called in it."""
        called = [part.func for part in walk(node) if isinstance(part, ast.Call)]
        return any(isinstance(self.look_up(func), FunctionType) and not elementary_name(self.look_up(func))
                   for func in called)  # fmt: skip

    def scalar(self, node: ast.expr) -> ast.expr:
        value = self.expression(node)
        if isinstance(value, tuple):
            raise self.refused(node)
        return value

    def expression(self, node: ast.expr) -> Value:
        method = getattr(self, f"_{type(node).__name__.lower()}_value", None)
        if method is None:
            raise self.refused(node)
        return method(node)

    def _constant_value(self, node: ast.Constant) -> Value:
        if not isinstance(node.value, bool | int | float):
            raise self.refused(node)
        return node

    def _name_value(self, node: ast.Name) -> Value:
        if node.id in self.scope:
            return self.scope[node.id]
        if node.id not in self.globals:
            return name(node.id)
        return self.constant(node, node.id, self.globals[node.id])

    def constant(self, node: ast.expr, word: str, value: Any) -> Value:
        """A constant of a module: a number, or a tuple of them."""
        if isinstance(value, tuple):
            return tuple(self.constant(node, f"{word}_{i}", member) for i, member in enumerate(value))
        if not isinstance(value, int | float):
            raise self.refused(node)
        known = value != value or value in (math.inf, math.pi, math.e)
        return number(value) if known or not word.isupper() else name(self.library.constant(self.module, word, value))

    def _attribute_value(self, node: ast.Attribute) -> Value:
        value = self.look_up(node)
        if value is None:
            return ast.Attribute(node.value, node.attr, ast.Load())
        return self.constant(node, node.attr, value)

    def _tuple_value(self, node: ast.Tuple) -> Value:
        members: list[Value] = []
        for member in node.elts:
            if isinstance(member, ast.Starred):
                members += self.expression(member.value)
            else:
                members.append(self.expression(member))
        return tuple(members)

    def _unaryop_value(self, node: ast.UnaryOp) -> Value:
        return ast.UnaryOp(node.op, self.scalar(node.operand))

    def _binop_value(self, node: ast.BinOp) -> Value:
        return ast.BinOp(self.scalar(node.left), node.op, self.scalar(node.right))

    def _boolop_value(self, node: ast.BoolOp) -> Value:
        return ast.BoolOp(node.op, [self.scalar(value) for value in node.values])

    def _compare_value(self, node: ast.Compare) -> Value:
        terms = [self.scalar(term) for term in (node.left, *node.comparators)]
        pairs: list[ast.expr] = [
            ast.Compare(a, [op], [b]) for a, op, b in zip(terms, node.ops, terms[1:], strict=False)
        ]
        return pairs[0] if len(pairs) == 1 else ast.BoolOp(ast.And(), pairs)

    def _ifexp_value(self, node: ast.IfExp) -> Value:
        test = self.scalar(node.test)
        return self.choice(node, test, self.expression(node.body), self.expression(node.orelse))

    def choice(self, node: ast.expr, test: ast.expr, this: Value, other: Value) -> Value:
        if isinstance(this, tuple) and isinstance(other, tuple) and len(this) == len(other):
            return tuple(self.choice(node, test, a, b) for a, b in zip(this, other, strict=True))
        if isinstance(this, tuple) or isinstance(other, tuple):
            raise self.refused(node)
        return this if ast.dump(this) == ast.dump(other) else ast.IfExp(test, this, other)

    def _subscript_value(self, node: ast.Subscript) -> Value:
        index = self.scalar(node.slice)
        table = self.globals.get(node.value.id) if isinstance(node.value, ast.Name) else None
        if isinstance(node.value, ast.Name) and node.value.id not in self.scope and isinstance(table, tuple):
            array = self.library.constant(self.module, node.value.id, table)
            return ast.Subscript(name(array), index, ast.Load())
        value = self.expression(node.value)
        if not isinstance(value, tuple):
            return ast.Subscript(value, index, ast.Load())
        if not isinstance(index, ast.Constant):
            raise self.refused(node)
        return value[int(index.value)]  # type: ignore[arg-type]

    def _call_value(self, node: ast.Call) -> Value:
        source = self.look_up(node.func)
        word = elementary_name(source) or (node.func.id if isinstance(node.func, ast.Name) else "")
        if elementary_name(source) or (word in PLAIN and source is getattr(builtins, word)):
            return ast.Call(name(word), [self.scalar(argument) for argument in node.args], [])
        if not isinstance(source, FunctionType):
            raise self.refused(node)
        return self.kept(*self.called(node, source))

    def called(self, node: ast.Call, source: Any) -> tuple[ast.Call, Value]:
        """The call of a function of an author, and the shape of its value."""
        values = self.arguments(node, source)
        lowered = self.library.function(source, *self.wish(node, source), values)
        return ast.Call(name(lowered.name), [one for value in values for one in flat(value)], []), lowered.value

    def kept(self, call: ast.Call, value: Value) -> Value:
        """The value of a call: itself where it is one number, else words that keep its members."""
        if len(flat(value)) == 1:
            return nested(value, call)
        if not flat(value):
            self.out.append(ast.Expr(call))
            return ()
        word = self.new("r")
        kept = self.named(word, shape(value))
        self.out.append(assign([*flat(kept)], call))
        self.out[-1].together = word  # type: ignore[attr-defined]
        return kept

    def named(self, word: str, shape: Any) -> Value:
        """Local words for a value of some shape."""
        if shape == "number":
            return name(word)
        return tuple(self.named(f"{word}_{i}", member) for i, member in enumerate(shape))

    def new(self, word: str) -> str:
        """A word that is not taken."""
        self.calls += 1
        return f"{word}{self.calls}" if f"{word}{self.calls}" not in self.taken else self.new(word)

    def wish(self, node: ast.Call, source: Any) -> tuple[str, str]:
        """The name that a function would like to have, and what is put ahead of it where that is taken."""
        return source.__name__, prefix_of(source.__module__)

    def arguments(self, node: ast.Call, source: Any) -> list[Value]:
        values: list[Value] = []
        for argument in node.args:
            if isinstance(argument, ast.Starred):
                values += self.expression(argument.value)
            else:
                values.append(self.expression(argument))
        named = {word.arg: self.expression(word.value) for word in node.keywords if word.arg}
        try:
            bound = inspect.signature(source).bind(*values, **named)
        except TypeError:
            raise self.refused(node) from None
        bound.apply_defaults()
        return [number(value) if isinstance(value, int | float) else value for value in bound.args]


def prefix_of(module: str) -> str:
    return module.rpartition(".")[2].strip("_")


def elementary_name(source: Any) -> str:
    """The name of an elementary function; empty for any other."""
    module = getattr(source, "__module__", None)
    plain = isinstance(source, BuiltinFunctionType) and module == "math"
    word = getattr(source, "__name__", "")
    return word if word in ELEMENTARY and (plain or module in (elementary.__name__, "numpy")) else ""
