"""Reduced functions (`lower`) as C99."""

from __future__ import annotations

import ast
import math
from collections.abc import Collection, Sequence

from pzt_ident.control.export.expressions import REMEDY
from pzt_ident.control.export.kinds import Kinds
from pzt_ident.control.export.trees import Function, direct, reads, walk, words_in
from pzt_ident.errors import InputError

KEYWORDS_TEXT = (
    "auto break case char const continue default do double else enum extern float for goto if inline int long "
    "register restrict return short signed sizeof static struct switch typedef union unsigned void volatile while "
    "real "
)
LIBRARY_TEXT = (
    "abs labs fabs exp expm1 log log1p log10 sqrt sin cos tan asin acos atan atan2 sinh cosh tanh erf erfc pow "
    "floor ceil fmod fmin fmax gamma lgamma tgamma hypot cbrt round trunc j0 j1 jn y0 y1 yn main min_of max_of "
)
KEYWORDS, LIBRARY = set(KEYWORDS_TEXT.split()), set(LIBRARY_TEXT.split())
RESERVED = KEYWORDS | LIBRARY
FLOAT_LEAST, FLOAT_MOST = 1.1754944e-38, 3.4028235e38
COMPARE = {ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">=", ast.Eq: "==", ast.NotEq: "!="}
BINARY = {
    ast.Add: ("+", 5), ast.Sub: ("-", 5), ast.Mult: ("*", 6), ast.Div: ("/", 6), ast.FloorDiv: ("/", 6),
    ast.Mod: ("%", 6), ast.BitAnd: ("&&", 2), ast.BitOr: ("||", 2),
}  # fmt: skip
UNARY, ATOM = 7, 8


class Text(Kinds):
    """Functions for one precision, "double" or "float". whole: constants that are integers. exact: functions that are
    written in double beside those of the same name in the precision of the signals, `real`."""

    def __init__(self, precision: str, whole: Collection[str] = (), exact: Collection[str] = ()) -> None:
        super().__init__(whole)
        self.single, self.exact = precision == "float", set(exact)
        self.real, self.tuple, self.end = ("double", "exact", "_exact") if exact else ("real", "tuple", "")
        self.where = ""

    def function(self, function: Function, results: dict[str, int]) -> str:
        """The definition of an author's function. results: number of results of each function."""
        inputs = [
            f"{self.real} *{word}" if word in function.arrays else f"{self.real} {word_of(word)}"
            for word in function.parameters
        ]
        value = {0: "void", 1: self.real}.get(function.results, f"{self.tuple}{function.results}")
        head = f"static {value} {self.called(function.name)}({', '.join(inputs) or 'void'})"
        unused = [word for word in function.parameters if word not in words_in(function.body)]
        silenced = [f"    (void){word_of(word)};" for word in unused]
        return "\n".join([*comment(function.doc), head, "{", *silenced, *self.body(function, results), "}"])

    def body(self, function: Function, results: dict[str, int], given: dict[str, str] | None = None) -> list[str]:
        self.results, self.where = results, function.name
        self.read = reads(function.body)
        self.kinds = dict.fromkeys(function.parameters, "real") | (given or {})
        self.infer(function.body)
        self.local = {word for word in self.kinds if word not in function.parameters and word not in (given or {})}
        self.tuples = 0
        self.members: dict[str, str] = {}
        inline = self.scopes(function.body)
        nodes = [node for statement in function.body for node in walk(statement)]
        together = [node for node in nodes if isinstance(node, ast.Assign) and hasattr(node, "together")]
        self.taken = {*self.kinds, *(node.together for node in together)}
        elsewhere = {word for node in together for word in direct(node)}
        elsewhere |= {
            node.target.id for node in nodes if isinstance(node, ast.For) and isinstance(node.target, ast.Name)
        }
        top = [word for word in sorted(self.local & self.read - elsewhere) if word not in inline]
        declared = [
            f"    {self.type(kind)} {', '.join(map(word_of, words))};"
            for kind in ("real", "long")
            if (words := [word for word in top if self.kinds[word] == kind])
        ]
        self.inline = inline
        return declared + self.block(function.body, 1)

    def called(self, word: str) -> str:
        return f"{word}_exact" if word in self.exact else word

    def type(self, kind: str) -> str:
        return self.real if kind == "real" else kind

    def block(self, body: Sequence[ast.stmt], depth: int) -> list[str]:
        return [line for statement in body for line in self.statement(statement, depth)]

    def statement(self, statement: ast.stmt, depth: int) -> list[str]:
        pad = "    " * depth
        if isinstance(statement, ast.Assign):
            return [pad + line for line in self.assign(statement)]
        if isinstance(statement, ast.AugAssign):
            target = self.text(statement.target)
            operator = BINARY[type(statement.op)][0]
            return [f"{pad}{target} {operator}= {self.text(statement.value)};"]
        if isinstance(statement, ast.Return):
            return [pad + self.returned(statement)]
        if isinstance(statement, ast.Expr):
            return [f"{pad}{self.text(statement.value)};"]
        if isinstance(statement, ast.If):
            return self.branches(statement, depth)
        if isinstance(statement, ast.While):
            return [f"{pad}while ({self.text(statement.test)}) {{", *self.block(statement.body, depth + 1), f"{pad}}}"]
        assert isinstance(statement, ast.For)
        return self.loop(statement, depth)

    def branches(self, statement: ast.If, depth: int) -> list[str]:
        pad = "    " * depth
        lines = [f"{pad}if ({self.text(statement.test)}) {{", *self.block(statement.body, depth + 1)]
        if statement.orelse:
            lines += [f"{pad}}} else {{", *self.block(statement.orelse, depth + 1)]
        return [*lines, f"{pad}}}"]

    def loop(self, statement: ast.For, depth: int) -> list[str]:
        pad = "    " * depth
        word = self.text(statement.target)
        first, last, step = (self.text(limit, 5) for limit in statement.iter.args)  # type: ignore[attr-defined]
        forward = f"{word}++" if step == "1" else f"{word} += {step}"
        head = f"{pad}for (long {word} = {first}; {word} < {last}; {forward}) {{"
        self.local.discard(statement.target.id)  # type: ignore[attr-defined]
        return [head, *self.block(statement.body, depth + 1), f"{pad}}}"]

    def declaration(self, word: str, statement: ast.stmt) -> str:
        return f"{self.type(self.kinds[word])} " if self.inline.get(word) == id(statement) else ""

    def assign(self, statement: ast.Assign) -> list[str]:
        target = statement.targets[0]
        if not isinstance(target, ast.Tuple):
            if isinstance(target, ast.Name) and target.id not in self.read:
                return []
            ahead = self.declaration(target.id, statement) if isinstance(target, ast.Name) else ""
            return [f"{ahead}{self.text(target)} = {self.text(statement.value)};"]
        kept = getattr(statement, "together", None) or self.new_word()
        lines = [f"{self.tuple}{len(target.elts)} {kept} = {self.text(statement.value)};"]
        if hasattr(statement, "together"):
            self.members |= {member.id: f"{kept}.v[{i}]" for i, member in enumerate(target.elts)}  # type: ignore[attr-defined]
            return lines
        for i, member in enumerate(target.elts):
            if isinstance(member, ast.Name) and member.id not in self.read:
                continue
            ahead = self.declaration(member.id, statement) if isinstance(member, ast.Name) else ""
            lines.append(f"{ahead}{self.text(member)} = {kept}.v[{i}];")
        return lines

    def new_word(self) -> str:
        self.tuples += 1
        return f"r{self.tuples}" if f"r{self.tuples}" not in self.taken else self.new_word()

    def returned(self, statement: ast.Return) -> str:
        if isinstance(statement.value, ast.Call):
            return f"return {self.text(statement.value)};"
        values = statement.value.elts if isinstance(statement.value, ast.Tuple) else []
        if not values:
            return "return;"
        if len(values) == 1:
            return f"return {self.text(values[0])};"
        return f"return ({self.tuple}{len(values)}){{{{{', '.join(map(self.text, values))}}}}};"

    def text(self, node: ast.expr, level: int = 0) -> str:
        """An expression, in brackets where its operator binds less than `level`."""
        precedence, text = self.parts(node)
        return f"({text})" if precedence < level else text

    def parts(self, node: ast.expr) -> tuple[int, str]:
        if isinstance(node, ast.Constant):
            text = self.number(node.value)  # type: ignore[arg-type]
            return (UNARY if text.startswith("-") else ATOM), text
        if isinstance(node, ast.Name):
            return ATOM, self.members.get(node.id) or word_of(node.id)
        if isinstance(node, ast.Attribute):
            return ATOM, f"{self.text(node.value, ATOM)}->{word_of(node.attr)}"
        if isinstance(node, ast.Subscript):
            return ATOM, f"{self.text(node.value, ATOM)}[{self.text(node.slice)}]"
        if isinstance(node, ast.UnaryOp):
            sign = {ast.USub: "-", ast.UAdd: "+", ast.Not: "!"}[type(node.op)]
            return UNARY, sign + self.text(node.operand, ATOM if sign == "-" else UNARY)
        if isinstance(node, ast.BinOp):
            return self.binary(node)
        if isinstance(node, ast.BoolOp):
            sign = " && " if isinstance(node.op, ast.And) else " || "
            return 2, sign.join(self.text(value, 3) for value in node.values)
        if isinstance(node, ast.Compare):
            sign = COMPARE[type(node.ops[0])]
            return 4, f"{self.text(node.left, 5)} {sign} {self.text(node.comparators[0], 5)}"
        if isinstance(node, ast.IfExp):
            return 1, f"{self.text(node.test, 2)} ? {self.text(node.body, 2)} : {self.text(node.orelse, 1)}"
        if isinstance(node, ast.Call):
            return self.call(node)
        raise self.refused(node)

    def refused(self, node: ast.AST) -> InputError:
        return InputError(f"`{ast.unparse(node)}` cannot be exported", where=self.where, remedy=REMEDY)

    def binary(self, node: ast.BinOp) -> tuple[int, str]:
        if isinstance(node.op, ast.Pow):
            return self.power(node)
        if type(node.op) not in BINARY:
            raise self.refused(node)
        sign, level = BINARY[type(node.op)]
        kinds = {self.kind(node.left), self.kind(node.right)}
        left, right = self.text(node.left, max(level, 3)), self.text(node.right, max(level + 1, 3))
        if isinstance(node.op, ast.FloorDiv | ast.Mod) and "real" in kinds:
            raise self.refused(node)
        if isinstance(node.op, ast.Div) and "real" not in kinds:
            constant = isinstance(node.left, ast.Constant)
            left = self.number(float(node.left.value)) if constant else f"({self.real}){self.text(node.left, UNARY)}"  # type: ignore[attr-defined]
        return level, f"{left} {sign} {right}"

    def power(self, node: ast.BinOp) -> tuple[int, str]:
        if isinstance(node.left, ast.Name) and isinstance(node.right, ast.Constant) and node.right.value == 2:
            return BINARY[ast.Mult][1], f"{word_of(node.left.id)} * {word_of(node.left.id)}"
        return ATOM, f"{self.math('pow')}({self.text(node.left)}, {self.text(node.right)})"

    def math(self, word: str) -> str:
        return f"{word}f" if self.single else word

    def call(self, node: ast.Call) -> tuple[int, str]:
        assert isinstance(node.func, ast.Name)
        word, arguments = node.func.id, node.args
        kind = self.kind(node)
        if word in self.results:
            return ATOM, f"{self.called(word)}({', '.join(map(self.text, arguments))})"
        if word == "int":
            return UNARY, f"(long){self.text(arguments[0], UNARY)}"
        if word in ("float", "bool"):
            return UNARY, f"({self.real}){self.text(arguments[0], UNARY)}"
        if word == "abs":
            called = self.math("fabs") if kind == "real" else "labs"
            return ATOM, f"{called}({self.text(arguments[0])})"
        if word in ("min", "max"):
            called = f"{word}_of" + (self.end if kind == "real" else "_long")
            text = self.text(arguments[0])
            for argument in arguments[1:]:
                text = f"{called}({text}, {self.text(argument)})"
            return ATOM, text
        return ATOM, f"{self.math(word)}({', '.join(map(self.text, arguments))})"

    def number(self, value: float) -> str:
        if not isinstance(value, float):
            return str(int(value))
        if math.isnan(value):
            return "NAN"
        if math.isinf(value):
            return "INFINITY" if value > 0 else "-INFINITY"
        if self.single and value:
            value = math.copysign(min(max(abs(value), FLOAT_LEAST), FLOAT_MOST), value)
            return f"{value:.9g}".replace("e-0", "e-").replace("e+", "e") + (
                "f" if "." in f"{value:.9g}" or "e" in f"{value:.9g}" else ".0f"
            )
        return repr(value) + ("f" if self.single else "")


def word_of(word: str) -> str:
    """A local word that is none of the language."""
    return f"{word}_" if word in KEYWORDS else word


def comment(text: str) -> list[str]:
    lines = text.replace("*/", "* /").splitlines()
    return ["/* " + "\n   ".join(line.strip() for line in lines) + " */"] if lines else []
