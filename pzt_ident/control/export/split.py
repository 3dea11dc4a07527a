"""What a kernel does once, with the parameters alone, and what it does in each sample."""

from __future__ import annotations

import ast
from collections.abc import Sequence

from pzt_ident.control.export.trees import assigned, loaded, reads, walk

SIGNALS = {"t", "u"}


class Split:
    """What a kernel does in its first sample, `if fresh`: `init` with the parameters alone, the rest with the input."""

    def __init__(self, body: Sequence[ast.stmt]) -> None:
        self.signals, before = set(SIGNALS), set()  # type: ignore[var-annotated]
        while self.signals != before:
            before = set(self.signals)
            for statement in body:
                self.follow(statement)

    def follow(self, statement: ast.stmt) -> None:
        """Words that depend on a signal; in the first sample no coefficient does."""
        for node in walk(statement):
            if isinstance(node, ast.Assign) and reads(node.value) & self.signals:
                written = {word for target in node.targets for word in assigned([ast.Expr(target)])}
                self.signals |= {word for word in written if not is_coefficient(word)}

    def init(self, body: Sequence[ast.stmt]) -> list[ast.stmt]:
        kept: list[ast.stmt] = []
        for statement in body:
            if isinstance(statement, ast.For) and (inner := self.init(statement.body)):
                kept.append(ast.For(statement.target, statement.iter, inner, []))
            elif isinstance(statement, ast.If):
                kept += self.parts(statement.body)[0] if is_fresh(statement) else self.init(statement.body)
        return kept

    def step(self, body: Sequence[ast.stmt]) -> list[ast.stmt]:
        kept: list[ast.stmt] = []
        for statement in body:
            if isinstance(statement, ast.For):
                kept.append(ast.For(statement.target, statement.iter, self.step(statement.body), []))
            elif isinstance(statement, ast.If) and is_fresh(statement):
                late = self.parts(statement.body)[1]
                kept += [ast.If(statement.test, late, [])] if late else []
            else:
                kept.append(statement)
        return kept

    def parts(self, body: Sequence[ast.stmt]) -> tuple[list[ast.stmt], list[ast.stmt]]:
        early: list[ast.stmt] = []
        late: list[ast.stmt] = []
        for statement in body:
            if isinstance(statement, ast.For):
                for part, inner in zip((early, late), self.parts(statement.body), strict=True):
                    part += [ast.For(statement.target, statement.iter, inner, [])] if inner else []
            else:
                (late if reads(statement) & self.signals else early).append(statement)
        return early, needed(early, late) + late


def is_fresh(statement: ast.If) -> bool:
    return isinstance(statement.test, ast.Name) and statement.test.id == "fresh"


def needed(early: Sequence[ast.stmt], late: Sequence[ast.stmt]) -> list[ast.stmt]:
    """The statements of `early` again that `late` needs; what has been stored is read from there."""
    wanted = reads(late)
    again: list[ast.stmt] = []
    places = {
        s.value.id: s.targets[0] for s in early if isinstance(s, ast.Assign) and isinstance(s.value, ast.Name)
        if not isinstance(s.targets[0], ast.Name)
    }  # fmt: skip
    for word in [word for word in places if word in wanted]:
        again.append(ast.Assign([ast.Name(word, ast.Store())], loaded(places[word])))
    wanted -= set(places)
    for statement in reversed(early):
        if isinstance(statement, ast.Assign) and set(assigned([statement])) & wanted:
            wanted |= reads(statement)
            again = [*needed(early, [statement]), statement, *again]
    return again


def is_coefficient(word: str) -> bool:
    """Whether a kernel calls a coefficient by this word."""
    return word[0] in "ke" and word[1:].isdigit()
