"""Author's functions in restricted Python, reduced to what every language of controllers has.

Tuples become their members, calls that return several numbers become statements, and each function that is called
becomes one of its own for the shapes of its arguments. What is left are numbers, arrays, assignments, `if`, `while` and
`for` over a range, as syntax trees of Python again.
"""

from __future__ import annotations

import ast
import inspect
import textwrap
from collections.abc import Sequence
from types import FunctionType
from typing import Any

from pzt_ident.control.export.expressions import Expressions, elementary_name, prefix_of
from pzt_ident.control.export.trees import Function, Value, assign, flat, indexed, name, number, shape, stored, walk


class Names:
    """Names of functions and constants, each given once: its own, or with that of its module where that is taken."""

    def __init__(self, reserved: set[str]) -> None:
        self._taken, self._names = set(reserved), {}  # type: ignore[var-annotated]

    def give(self, key: Any, wish: str, prefix: str) -> str:
        if key not in self._names:
            options = [wish, f"{prefix}_{wish}", *(f"{prefix}_{wish}_{n}" for n in range(2, 1000))]
            self._names[key] = next(name for name in options if name not in self._taken)
            self._taken.add(self._names[key])
        return self._names[key]


class Library:
    """The functions and constants that have been asked for, callees first."""

    def __init__(self, reserved: set[str]) -> None:
        self.names = Names(reserved)
        self.functions: dict[Any, Function] = {}
        self.constants: dict[str, Any] = {}

    def function(self, source: Any, wish: str, prefix: str, arguments: Sequence[Value]) -> Function:
        """The function for arguments of these shapes."""
        shapes = tuple(map(shape, arguments))
        key = (source, wish, shapes)
        if key not in self.functions:
            name = self.names.give(key, wish, prefix)
            self.functions[key] = Lowering(self, source, name).function(shapes)
        return self.functions[key]

    def constant(self, module: str, word: str, value: Any) -> str:
        wish = word if len(word) > 2 else f"{prefix_of(module).upper()}_{word}"
        name = self.names.give((module, word), wish, prefix_of(module))
        self.constants[name] = value
        return name


class Lowering(Expressions):
    """The statements of one function."""

    def function(self, shapes: tuple[Any, ...]) -> Function:
        lines, first = inspect.getsourcelines(self.source)
        tree = ast.parse(textwrap.dedent("".join(lines))).body[0]
        ast.increment_lineno(tree, first - 1)
        assert isinstance(tree, ast.FunctionDef)
        words = [argument.arg for argument in tree.args.args]
        self.taken = {node.id for node in walk(tree) if isinstance(node, ast.Name)}
        if tree.args.vararg or tree.args.kwarg or len(words) != len(shapes):
            raise self.refused(tree, "its arguments")
        for word, members in zip(words, shapes, strict=True):
            self.scope[word] = self.named(word, members)
        parameters = [one.id for word in words for one in flat(self.scope[word])]  # type: ignore[attr-defined]
        body = self.block(tree.body)
        doc = (ast.get_docstring(tree) or "").strip()
        written = {word for word in parameters if indexed(word, body)}
        value = () if self.value is None else self.value
        return Function(self.name, doc, parameters, len(flat(value)), body, value, written)

    def block(self, statements: Sequence[ast.stmt]) -> list[ast.stmt]:
        outer, self.out = self.out, []
        for statement in statements:
            method = getattr(self, f"_{type(statement).__name__.lower()}", None)
            if method is None:
                raise self.refused(statement)
            method(statement)
        inner, self.out = self.out, outer
        return inner

    def _pass(self, statement: ast.Pass) -> None:
        pass

    def _expr(self, statement: ast.Expr) -> None:
        if not isinstance(statement.value, ast.Constant):
            self.expression(statement.value)

    def _return(self, statement: ast.Return) -> None:
        value = statement.value
        if isinstance(value, ast.IfExp) and self.calls_function(value):
            arms = [self.block([ast.Return(arm)]) for arm in (value.body, value.orelse)]
            self.out.append(ast.If(self.scalar(value.test), arms[0], []))
            self.out += arms[1]
            return
        source = self.look_up(value.func) if isinstance(value, ast.Call) else None
        if isinstance(value, ast.Call) and isinstance(source, FunctionType) and not elementary_name(source):
            call, result = self.called(value, source)
        else:
            call, result = None, self.expression(value) if value else ()
        if self.value is not None and shape(self.value) != shape(result):
            raise self.refused(statement, "results of different lengths")
        self.value = result
        self.out.append(ast.Return(call or ast.Tuple(flat(result), ast.Load())))

    def _assign(self, statement: ast.Assign) -> None:
        value, targets = statement.value, statement.targets
        if isinstance(targets[0], ast.Tuple) and isinstance(value, ast.IfExp) and self.calls_function(value):
            arms = [self.block([ast.Assign(targets, arm)]) for arm in (value.body, value.orelse)]
            self.out.append(ast.If(self.scalar(value.test), *arms))
            return
        source = self.look_up(value.func) if isinstance(value, ast.Call) else None
        if isinstance(value, ast.Call) and isinstance(source, FunctionType) and not elementary_name(source):
            call, result = self.called(value, source)
            places = self.places(targets[0], result) if len(flat(result)) > 1 and len(targets) == 1 else None
            if places is not None:
                self.out.append(assign(places, call))
                return
            result = self.kept(call, result)
        else:
            result = self.expression(value)
        for target in reversed(targets):
            self.store(target, result)

    def places(self, target: ast.expr, value: Value) -> list[ast.expr] | None:
        """Where the members of a value go; None unless each has one."""
        if isinstance(target, ast.Tuple) and isinstance(value, tuple) and len(target.elts) == len(value):
            parts = [self.places(member, part) for member, part in zip(target.elts, value, strict=True)]
            return None if None in parts else [one for part in parts for one in part or ()]
        if isinstance(target, ast.Tuple) and len(target.elts) != len(flat(value)):
            raise self.refused(target)
        if isinstance(target, ast.Name):
            self.scope[target.id] = self.named(target.id, shape(value))
            return [*flat(self.scope[target.id])]
        return [self.place(target)] if not isinstance(value, tuple) else None

    def place(self, target: ast.expr) -> ast.expr:
        if isinstance(target, ast.Subscript):
            return ast.Subscript(self.scalar(target.value), self.scalar(target.slice), ast.Store())
        if isinstance(target, ast.Attribute):
            return target
        raise self.refused(target)

    def store(self, target: ast.expr, value: Value) -> None:
        """Assign at once, by words in between where a target is read again."""
        places = self.places(target, value)
        values = flat(value)
        if places is None or len(places) != len(values):
            raise self.refused(target)
        pairs = [(p, v) for p, v in zip(places, values, strict=True) if ast.dump(p) != ast.dump(v)]
        written = [ast.unparse(p) for p, _ in pairs]
        for i, (to, one) in enumerate(pairs):
            later = {ast.unparse(node) for _, other in pairs[i + 1 :] for node in walk(other)}
            if written[i] in later:
                kept = name(self.new("kept"))
                self.out.append(assign(kept, one))
                pairs[i] = (to, kept)
            else:
                self.out.append(assign(to, one))
                pairs[i] = (to, to)
        self.out += [assign(to, one) for to, one in pairs if to is not one]

    def _augassign(self, statement: ast.AugAssign) -> None:
        target = statement.target
        place = self.scope.get(target.id, target) if isinstance(target, ast.Name) else self.place(target)
        self.out.append(ast.AugAssign(stored(place), statement.op, self.scalar(statement.value)))

    def _if(self, statement: ast.If) -> None:
        test = self.scalar(statement.test)
        body, orelse = self.block(statement.body), self.block(statement.orelse)
        if body or orelse:
            self.out.append(ast.If(test, body, orelse))

    def _while(self, statement: ast.While) -> None:
        ahead = len(self.out)
        test = self.scalar(statement.test)
        if len(self.out) > ahead or statement.orelse:
            raise self.refused(statement)
        self.out.append(ast.While(test, self.block(statement.body), []))

    def _for(self, statement: ast.For) -> None:
        call, target = statement.iter, statement.target
        ranged = isinstance(call, ast.Call) and isinstance(call.func, ast.Name) and call.func.id == "range"
        if not ranged or not isinstance(target, ast.Name) or statement.orelse:
            raise self.refused(statement)
        limits = [self.scalar(argument) for argument in call.args]  # type: ignore[attr-defined]
        first, last, step = [number(0), *limits, number(1)] if len(limits) == 1 else [*limits, number(1)][:3]
        self.scope[target.id] = name(target.id)
        loop = ast.Call(name("range"), [first, last, step], [])
        self.out.append(ast.For(target, loop, self.block(statement.body), []))
