"""Whether the words of a function are real or whole numbers, and where they are declared."""

from __future__ import annotations

import ast
from collections.abc import Collection, Sequence

from pzt_ident.control.export.trees import counts, direct, reads, value_of, walk


class Kinds:
    """Of one function at a time. whole: constants that are integers."""

    def __init__(self, whole: Collection[str] = ()) -> None:
        self.whole = set(whole)
        self.kinds: dict[str, str] = {}
        self.local: set[str] = set()

    def infer(self, body: Sequence[ast.stmt]) -> None:
        """The kind of each word, real or long, from what is assigned to it."""
        before = None
        while before != self.kinds:
            before = dict(self.kinds)
            for statement in body:
                for node in walk(statement):
                    self.infer_one(node)

    def infer_one(self, node: ast.AST) -> None:
        if isinstance(node, ast.For) and isinstance(node.target, ast.Name):
            self.kinds.setdefault(node.target.id, "long")
        targets: list[ast.expr] = []
        kind = "real"
        if isinstance(node, ast.Assign):
            target = node.targets[0]
            targets = target.elts if isinstance(target, ast.Tuple) else [target]
            kind = "real" if isinstance(target, ast.Tuple) else self.kind(node.value)
        elif isinstance(node, ast.AugAssign):
            targets, kind = [node.target], self.kind(node.value)
        for target in targets:
            if isinstance(target, ast.Name):
                known = self.kinds.get(target.id, "long")
                self.kinds[target.id] = "real" if "real" in (known, kind) else "long"

    def kind(self, node: ast.expr) -> str:
        if isinstance(node, ast.Constant):
            return "real" if isinstance(node.value, float) else "long"
        if isinstance(node, ast.Name):
            return "long" if node.id in self.whole else self.kinds.get(node.id, "long")
        if isinstance(node, ast.Compare | ast.BoolOp) or (
            isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not)
        ):
            return "long"
        if isinstance(node, ast.UnaryOp):
            return self.kind(node.operand)
        if isinstance(node, ast.BinOp):
            kinds = {self.kind(node.left), self.kind(node.right)}
            return "real" if "real" in kinds or isinstance(node.op, ast.Div | ast.Pow) else "long"
        if isinstance(node, ast.IfExp):
            return "real" if "real" in (self.kind(node.body), self.kind(node.orelse)) else "long"
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
            if node.func.id == "int":
                return "long"
            if node.func.id in ("min", "max", "abs"):
                return "real" if "real" in map(self.kind, node.args) else "long"
        return "real"

    def scopes(self, body: Sequence[ast.stmt]) -> dict[str, int]:
        """Words that are declared where they are first assigned, by the number of that statement."""
        places: dict[str, int] = {}
        every = counts(body)

        def visit(block: Sequence[ast.stmt]) -> None:
            inside = counts(block)
            for statement in block:
                for word in direct(statement):
                    whole = inside.get(word) == every.get(word)
                    first = all(word not in counts([earlier]) for earlier in block[: block.index(statement)])
                    if word in self.local and whole and first and word not in reads(value_of(statement)):
                        places.setdefault(word, id(statement))
                for part in ("body", "orelse"):
                    visit(getattr(statement, part, []))

        visit(body)
        return places
