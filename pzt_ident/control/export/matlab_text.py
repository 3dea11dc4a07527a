"""Reduced functions (`lower`) as MATLAB, which Octave runs as well."""

from __future__ import annotations

import ast
import math
from collections.abc import Mapping
from typing import Any

from pzt_ident.control.export.c_text import ATOM, BINARY, UNARY, Text
from pzt_ident.control.export.trees import Function, reads, words_in

TAKEN = "break case catch continue else elseif end for function global if otherwise parfor persistent return switch "
TAKEN += "try while pick"
FUNCTIONS = "abs exp expm1 log log1p log10 sqrt sin cos tan atan tanh erf erfc min max fix mod floor zeros size"
RESERVED = {*TAKEN.split(), *FUNCTIONS.split()}


class MatlabText(Text):
    """constants: values by name; a function that needs one has it at its top."""

    def __init__(self, constants: Mapping[str, Any]) -> None:
        super().__init__("double", [word for word, value in constants.items() if isinstance(value, int)])
        self.constants = constants

    def define(
        self, function: Function, inputs: list[str], outputs: list[str], results: dict[str, int], head: str
    ) -> list[str]:
        """A definition; head: its comment. The parameters of an author's function are its inputs."""
        self.results, self.where, self.read = results, function.name, reads(function.body)
        self.kinds = dict.fromkeys(function.parameters, "real") | {"fresh": "long"}
        self.infer(function.body)
        self.inline, self.members, self.tuples, self.taken = {}, {}, 0, {*self.kinds}
        returned = f"[{', '.join(outputs)}] = " if outputs else ""
        used = words_in(function.body)
        known = [f"    {word} = {self.value(value)};" for word, value in self.constants.items() if word in used]
        comments = [f"    % {line.strip()}".rstrip() for line in head.splitlines()]
        first = f"function {returned}{function.name}({', '.join(map(word_of, inputs))})"
        return [first, *comments, *known, *self.block(function.body, 1), "end", ""]

    def author(self, function: Function, results: dict[str, int]) -> list[str]:
        outputs = [f"out{i + 1}" for i in range(function.results)]
        return self.define(function, function.parameters, outputs, results, function.doc)

    def value(self, value: Any) -> str:
        return f"[{', '.join(map(self.number, value))}]" if isinstance(value, tuple) else self.number(value)

    def statement(self, statement: ast.stmt, depth: int) -> list[str]:
        pad = "    " * depth
        if isinstance(statement, ast.AugAssign):
            target = self.text(statement.target)
            sign, level = BINARY[type(statement.op)]
            return [f"{pad}{target} = {target} {sign} {self.text(statement.value, level + 1)};"]
        if isinstance(statement, ast.While):
            return [f"{pad}while {self.text(statement.test)}", *self.block(statement.body, depth + 1), f"{pad}end"]
        if isinstance(statement, ast.Return):
            return [pad + line for line in self.returns(statement)]
        return super().statement(statement, depth)

    def branches(self, statement: ast.If, depth: int) -> list[str]:
        pad = "    " * depth
        lines = [f"{pad}if {self.text(statement.test)}", *self.block(statement.body, depth + 1)]
        if statement.orelse:
            lines += [f"{pad}else", *self.block(statement.orelse, depth + 1)]
        return [*lines, f"{pad}end"]

    def loop(self, statement: ast.For, depth: int) -> list[str]:
        pad = "    " * depth
        first, last, step = statement.iter.args  # type: ignore[attr-defined]
        stop = self.text(ast.BinOp(last, ast.Sub(), ast.Constant(1)))
        stop = str(int(last.value) - 1) if isinstance(last, ast.Constant) else stop  # type: ignore[arg-type]
        middle = "" if self.text(step) == "1" else f"{self.text(step)}:"
        head = f"{pad}for {self.text(statement.target)} = {self.text(first)}:{middle}{stop}"
        return [head, *self.block(statement.body, depth + 1), f"{pad}end"]

    def assign(self, statement: ast.Assign) -> list[str]:
        target = statement.targets[0]
        members = target.elts if isinstance(target, ast.Tuple) else [target]
        unread = [isinstance(member, ast.Name) and member.id not in self.read for member in members]
        if all(unread):
            return []
        value = self.text(statement.value)
        places = ["~" if skip else self.text(member) for member, skip in zip(members, unread, strict=True)]
        return [f"{places[0]} = {value};" if len(places) == 1 else f"[{', '.join(places)}] = {value};"]

    def returns(self, statement: ast.Return) -> list[str]:
        value = statement.value
        if isinstance(value, ast.Call):
            assert isinstance(value.func, ast.Name)
            outs = [f"out{i + 1}" for i in range(self.results[value.func.id])]
            return [f"[{', '.join(outs)}] = {self.text(value)};", "return"]
        values = value.elts if isinstance(value, ast.Tuple) else []
        return [*(f"out{i + 1} = {self.text(one)};" for i, one in enumerate(values)), "return"]

    def parts(self, node: ast.expr) -> tuple[int, str]:
        if isinstance(node, ast.Name):
            return ATOM, word_of(node.id)
        if isinstance(node, ast.Attribute):
            return ATOM, f"{self.text(node.value, ATOM)}.{word_of(node.attr)}"
        if isinstance(node, ast.Subscript):
            return ATOM, f"{self.text(node.value, ATOM)}({self.index(node.slice)})"
        if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not):
            return UNARY, f"~{self.text(node.operand, ATOM)}"
        if isinstance(node, ast.Compare) and isinstance(node.ops[0], ast.NotEq):
            return 4, f"{self.text(node.left, 5)} ~= {self.text(node.comparators[0], 5)}"
        if isinstance(node, ast.IfExp):
            return ATOM, f"pick({self.text(node.test)}, {self.text(node.body)}, {self.text(node.orelse)})"
        return super().parts(node)

    def index(self, node: ast.expr) -> str:
        """Counted from 1."""
        if isinstance(node, ast.Constant):
            return str(node.value + 1)  # type: ignore[operator]
        return f"{self.text(node, 5)} + 1"

    def binary(self, node: ast.BinOp) -> tuple[int, str]:
        left, right = self.text(node.left), self.text(node.right)
        if isinstance(node.op, ast.FloorDiv):
            return ATOM, f"floor({self.text(node.left, 6)} / {self.text(node.right, 7)})"
        if isinstance(node.op, ast.Mod):
            return ATOM, f"mod({left}, {right})"
        if isinstance(node.op, ast.Pow):
            return ATOM, f"({self.text(node.left, ATOM)}^{self.text(node.right, ATOM)})"
        sign, level = BINARY[type(node.op)]
        return level, f"{self.text(node.left, max(level, 3))} {sign} {self.text(node.right, max(level + 1, 3))}"

    def call(self, node: ast.Call) -> tuple[int, str]:
        assert isinstance(node.func, ast.Name)
        word, arguments = node.func.id, [self.text(argument) for argument in node.args]
        if word in ("min", "max") and len(arguments) > 2:
            text = arguments[0]
            for argument in arguments[1:]:
                text = f"{word}({text}, {argument})"
            return ATOM, text
        if word == "pow":
            return ATOM, f"({arguments[0]})^({arguments[1]})"
        return ATOM, f"{ {'int': 'fix', 'float': 'double', 'bool': 'double'}.get(word, word) }({', '.join(arguments)})"

    def number(self, value: float) -> str:
        if isinstance(value, float) and not math.isfinite(value):
            return "NaN" if math.isnan(value) else "Inf" if value > 0 else "-Inf"
        return super().number(value)


def word_of(word: str) -> str:
    """A word that MATLAB takes."""
    word = f"{word.lstrip('_')}_" if word.startswith("_") else word
    return "unused" if word == "_" else f"{word}_" if word in RESERVED else word
