"""The whole model as functions: kernels by operation, and where the arguments of each `init` come from."""

from __future__ import annotations

import ast
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from pzt_ident.control.export.lower import Library
from pzt_ident.control.export.tile import Kernel, kernel_of
from pzt_ident.control.export.trees import Function, indexed, walk
from pzt_ident.control.identified import Identified
from pzt_ident.control.stage import EVERYTHING
from pzt_ident.data.units import factor
from pzt_ident.engine.program import Operation
from pzt_ident.model.block import TILES, Modes, Shift, argument_names


@dataclass(frozen=True)
class Given:
    """One argument of an init: a number, or a parameter (its column) times the size of its unit, or the sample time."""

    number: float = 0.0
    column: int | None = None
    is_dt: bool = False


@dataclass(frozen=True)
class Step:
    """An operation with its kernel and the member of the state that it acts on."""

    operation: Operation
    kernel: Kernel | None
    member: str
    given: dict[str, list[Given]]
    weights: list[tuple[str, int, Given]]

    @property
    def axis(self) -> int:
        return self.operation.tile // TILES


class Exported:
    """`steps` in signal order, `kernels` by name."""

    def __init__(self, identified: Identified, reserved: set[str]) -> None:
        self.identified, self.stage = identified, identified.stage()
        self.library = Library(reserved)
        self.kernels: dict[tuple[object, ...], Kernel] = {}
        self.members: list[str] = []
        self.roots: list[str] = []  # functions that are called from a template
        self.steps = [self._step(operation) for operation in self.stage.operations(EVERYTHING)]

    @property
    def axes(self) -> int:
        return len(self.identified.chain.axes)

    @property
    def substeps(self) -> int:
        return self.stage.program.substeps

    @property
    def history(self) -> int:
        """Number of drives that are kept; 0 where the last one does not matter."""
        delayed = any(o.block and issubclass(o.block, Shift) for o in self.stage.program.operations)
        return self.stage.history if delayed else 1 if self.substeps > 1 else 0

    @cached_property
    def columns(self) -> list[int]:
        """The parameters that an init takes."""
        every = [given for step in self.steps for given in self.givens(step)]
        return sorted({given.column for given in every if given.column is not None})

    @staticmethod
    def givens(step: Step) -> Iterable[Given]:
        for word in step.kernel.init.parameters if step.kernel else ():
            yield from step.given[word]
        yield from (given for _, _, given in step.weights)

    def _step(self, operation: Operation) -> Step:
        if operation.block is None:
            return Step(operation, None, "", {}, [])
        form, variant = self.stage.form(operation), operation.variant
        key = (form, variant)
        if key not in self.kernels:
            taken = [kernel.name for kernel in self.kernels.values()]
            word = operation.block.name if operation.block.name not in taken else f"{operation.block.name}_{len(taken)}"
            self.kernels[key] = kernel_of(self.library, form, variant, word, self.stage.history - 2)
        axis = self.identified.chain.axes[operation.axis]
        shared = self.axes == 1 or variant.axes > 1
        member = operation.block.name if shared else f"{axis}_{operation.block.name}"
        member = member if member not in self.members else f"{member}_{len(self.members)}"
        self.members.append(member)
        return Step(operation, self.kernels[key], member, *self._sources(operation))

    def _sources(self, operation: Operation) -> tuple[dict[str, list[Given]], list[tuple[str, int, Given]]]:
        """Of each argument of `prepare` and `terms` by copy, and of the weights of modes."""
        form, layout = self.stage.form(operation), self.stage.layout(operation)
        words = [*form.arguments(), *(argument_names(form.terms) if operation.variant.terms else ())]  # type: ignore[attr-defined]
        fields = self.kernels[form, operation.variant].fields
        given: dict[str, list[Given]] = {word: [] for word in words}
        weights: list[tuple[str, int, Given]] = []
        row = operation.row + layout.first_given
        for copy in range(layout.copies):
            for word in [*words, *(fields.weights if issubclass(form, Modes) else ())]:
                if word in given:
                    given[word].append(self._source(row, word))
                else:
                    weights.append((word, copy, self._source(row, word)))
                row += 1
        return given, weights

    def _source(self, row: int, word: str) -> Given:
        columns = dict(self.stage.program.given)
        if row in columns:
            return Given(column=columns[row])
        return Given(number=float(self.stage.scratch[row]), is_dt=word == "dt")

    def root(self, source: Any, arguments: int) -> str:
        """The name of a function of so many numbers that a template calls."""
        made = self.library.function(source.py_func, source.__name__, "root", [ast.Name("x")] * arguments)
        self.roots.append(made.name)
        return made.name

    def factor(self, column: int) -> float:
        return factor(self.identified.units[column])

    def functions(self, init: bool | None = None) -> list[Function]:
        """Those that the kernels call, directly or through others, callees first; those of init or of a step alone."""
        known = {function.name: function for function in self.library.functions.values()}
        wanted: set[str] = set() if init else set(self.roots)
        stack: list[str] = []
        for kernel in self.kernels.values():
            stack += called(kernel.init) if init is not False else ()
            stack += called(kernel.step) if init is not True else ()
        stack += [word for root in wanted for word in called(known[root])]
        while stack:
            word = stack.pop()
            if word in known and word not in wanted:
                wanted.add(word)
                stack += called(known[word])
        return [function for function in known.values() if function.name in wanted]

    def constants(self) -> dict[str, object]:
        """Those that these functions name."""
        used = {node.id for f in self.functions() for s in f.body for node in walk(s) if isinstance(node, ast.Name)}
        return {word: value for word, value in self.library.constants.items() if word in used}

    def most_passes(self) -> int:
        """The largest number of branches of a block."""
        return max((kernel.fields.copies for kernel in self.kernels.values()), default=1)


def called(function: Function) -> set[str]:
    return {node.id for statement in function.body for node in walk(statement) if isinstance(node, ast.Name)}


def is_array(kernel: Kernel, word: str) -> bool:
    """Whether an init takes an array for the word, a number a copy."""
    return indexed(word, kernel.init.body)
