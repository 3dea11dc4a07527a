"""The identified model as C99: a header, a source, and a test with a vector of its own."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np

from pzt_ident.control.export.c_layout import headline, notes, parameter_name, wrapped
from pzt_ident.control.export.c_text import RESERVED, Text
from pzt_ident.control.export.inverse import ROOTS, Exportable
from pzt_ident.control.export.program import Exported, Given, Step, is_array
from pzt_ident.control.export.tile import Kernel
from pzt_ident.control.export.trees import reads
from pzt_ident.control.identified import Identified
from pzt_ident.engine import root
from pzt_ident.engine.lanes import template_of_text
from pzt_ident.errors import InputError
from pzt_ident.model.block import TILES

TEMPLATES = Path(__file__).parent / "templates"
TOLERANCE = {"double": 1e-9, "float": 1e-5}
HELPERS = {
    f"{word}_of{end}": f"static {kind} {word}_of{end}({kind} a, {kind} b)\n{{\n    return b {sign} a ? b : a;\n}}"
    for word, sign in (("min", "<"), ("max", ">"))
    for end, kind in (("", "real"), ("_exact", "double"), ("_long", "long"))
}
NOTHING = "(void)t;"  # the body of a function that no block is in


def files(identified: Identified, precision: str = "double", inverse: bool = True) -> dict[str, str]:
    """Text by name of file. inverse: with that of the model, where it has one."""
    model = CModel(identified, precision, inverse)
    word, facts = identified.word, model.facts()
    made = {f"{word}.{end}": model.render(f"model.{end}.jinja", **facts) for end in ("h", "c")}
    return made | {f"{word}_test.c": model.render("test.c.jinja", **model.test())}


class CModel:
    """The parts of header and source as lines of C."""

    def __init__(self, identified: Identified, precision: str, inverse: bool = False) -> None:
        self.identified, self.precision = identified, precision
        self.exported = Exported(identified, RESERVED)
        self.inverse = Exportable(identified, inverse)
        self.root_calls = {} if self.inverse.refused else self.roots()
        constants = self.exported.library.constants
        whole = [word for word, value in constants.items() if isinstance(value, int)]
        self.text = self.exact = Text(precision, whole)
        if precision == "float":
            self.refuse_cells()
            self.exact = Text("double", whole, exact={f.name for f in self.exported.functions(init=True)})
        self.results = {f.name: f.results for f in self.exported.library.functions.values()}

    def roots(self) -> dict[str, str]:
        return {word: self.exported.root(getattr(root, word), count) for word, count in ROOTS}

    def refuse_cells(self) -> None:
        """Raises InputError for relays: their rates span more than single precision holds."""
        for kernel in self.exported.kernels.values():
            if kernel.fields.cells:
                message = "single precision does not hold its rates, 1e-300/s and more"
                raise InputError(message, where=kernel.name, remedy="export it in double precision")

    def render(self, template: str, **facts: Any) -> str:
        made = template_of_text((TEMPLATES / template).read_text()).render(**facts, **self.common())
        return "\n".join(line for text in made.splitlines() for line in wrapped(text)).rstrip() + "\n"

    def common(self) -> dict[str, Any]:
        one, names = self.identified, self.identified.chain.axes
        drives = [f"{axis} [{unit}]" for axis, unit in zip(names, one.drive_units, strict=True)]
        responses = [f"{names[axis]} [{one.response_units[axis]}]" for axis in one.outputs]
        return {
            "word": one.word,
            "precision": self.precision,
            "title": f"{one.name}: an identified piezo stage, exported by pzt-ident",
            "drives": drives,
            "responses": responses,
        }

    def facts(self) -> dict[str, Any]:
        exported = self.exported
        kernels = [self.kernel(kernel) for kernel in exported.kernels.values()]
        functions = self.authors()
        constants = [self.constant(word, value) for word, value in exported.constants().items()]
        body = "\n".join(functions + kernels)
        tuples = sorted(
            set(re.findall(r"\b(?:tuple|exact)\d+\b", body)), key=lambda word: (word[:5] == "exact", int(word[5:]))
        )
        return {
            "notes": notes(self.identified),
            "dt": self.exact.number(self.identified.dt),
            "passes": exported.most_passes() if not self.has_cells() else "64 x 64",
            "substeps": exported.substeps,
            "substeps_note": f" ({exported.substeps} times a sample)" if exported.substeps > 1 else "",
            "history": exported.history,
            "axes": exported.axes,
            "signals": TILES * exported.axes,
            "parameters": [self.parameter(column) for column in exported.columns],
            "structs": [self.struct(kernel) for kernel in exported.kernels.values() if self.kept(kernel)],
            "members": [
                {"type": step.kernel.name, "name": step.member}
                for step in exported.steps if step.kernel and self.kept(step.kernel)
            ],
            "tuples": [(word, "double" if word.startswith("exact") else "real", word[5:]) for word in tuples],
            "helpers": [text for word, text in HELPERS.items() if f"{word}(" in body],
            "constants": constants,
            "functions": functions,
            "kernels": kernels,
            "init": [line for step in exported.steps for line in self.init(step)],
            "advance": [self.call(step) for step in exported.steps] or [NOTHING],
            "uses_dt": any(given.is_dt for step in exported.steps for given in exported.givens(step)),
            "delays": self.delays(),
            **self.signals(),
            **self.inverted(),
        }  # fmt: skip

    def inverted(self) -> dict[str, Any]:
        """What the templates ask about the inverse."""
        identified, inverse = self.identified, self.inverse
        if inverse.refused:
            return {"inverse": None, "no_inverse": inverse.refused}
        chosen = inverse.operations()
        facts = inverse.facts(self.number)
        material = [self.call(step) for step in self.exported.steps if step.operation in chosen]
        sizes = [identified.scale(axis) for axis in range(self.exported.axes)]
        return {
            "inverse": facts | {"material": material or [NOTHING]},
            "references": [
                f"asked[{a}] = reference[{i}] * {self.number(sizes[a][1])};" for i, a in enumerate(identified.outputs)
            ],
            "drives_out": [f"drive[{a}] = out[{a}] / {self.number(size)};" for a, (size, _) in enumerate(sizes)],
            "signals_each": TILES,
            "fabs": self.text.math("fabs"),
            "least": self.number(1e-9),
            "step": self.number(1e-12),
            **self.root_calls,
        }

    def has_cells(self) -> bool:
        return any(kernel.fields.cells for kernel in self.exported.kernels.values())

    def kept(self, kernel: Kernel) -> bool:
        return bool(kernel.fields.names or kernel.fields.cells)

    def number(self, value: float) -> str:
        return self.text.number(float(value))

    def parameter(self, column: int) -> dict[str, str]:
        one, entry = self.identified, self.identified.entry(column)
        error = one.errors[column]
        comment = f"{one.units[column]}"
        comment += f", standard error {error:.2g}" if error is not None else ""
        return {
            "name": parameter_name(entry.name),
            "value": self.exact.number(one.value(column)),
            "comment": f"{comment}. {entry.parameter.doc}",
        }

    def struct(self, kernel: Kernel) -> dict[str, Any]:
        fields = [word if copies == 1 else f"{word}[{copies}]" for word, copies in kernel.fields.names.items()]
        cells = [f"cells[{kernel.fields.cells}]"] if kernel.fields.cells else []
        return {"name": kernel.name, "comment": headline(kernel), "fields": fields + cells}

    def authors(self) -> list[str]:
        """The functions of authors: in double for the coefficients, in the precision of the signals for a step."""
        if self.text is self.exact:
            return [self.text.function(function, self.results) for function in self.exported.functions()]
        first = [self.exact.function(function, self.results) for function in self.exported.functions(init=True)]
        return first + [self.text.function(function, self.results) for function in self.exported.functions(init=False)]

    def constant(self, word: str, value: Any) -> str:
        if word == "EPSILON" and self.precision == "float":
            value = 2.4e-7  # two last digits
        if isinstance(value, tuple):
            numbers = ", ".join(self.number(item) for item in value)
            return f"static const real {word}[{len(value)}] = {{ {numbers} }};"
        return f"#define {word} {self.text.number(value)}"

    def kernel(self, kernel: Kernel) -> str:
        """Both functions of a block."""
        texts = []
        for function, inputs in ((kernel.init, self.init_inputs(kernel)), (kernel.step, self.step_inputs(kernel))):
            given = dict.fromkeys(("c", "t", "u"), "") | {"fresh": "long"} | dict.fromkeys(kernel.fields.given, "real")
            if function is kernel.init and not function.body:
                continue
            text = self.exact if function is kernel.init else self.text
            body = text.body(function, self.results, given)
            texts.append("\n".join([f"static void {function.name}({', '.join(inputs)})", "{", *body, "}"]))
        return f"/* {headline(kernel)} */\n" + "\n\n".join(texts)

    def init_inputs(self, kernel: Kernel) -> list[str]:
        inputs = [
            f"const double {word}[]" if is_array(kernel, word) else f"double {word}" for word in kernel.init.parameters
        ]
        return [f"{self.identified.word}_{kernel.name} *c", *inputs]

    def step_inputs(self, kernel: Kernel) -> list[str]:
        used = reads(kernel.step.body)
        kinds = {"c": f"{self.identified.word}_{kernel.name} *c", "fresh": "int fresh", "u": "const real u[]"}
        return [text for word, text in kinds.items() if word in used] + ["real t[]"]

    def init(self, step: Step) -> list[str]:
        """The call of the init of an operation, with the arguments in SI units."""
        if step.kernel is None or not step.kernel.init.body:
            return []
        arguments = [f"&s->{step.member}"]
        for word in step.kernel.init.parameters:
            values = [self.given(given) for given in step.given[word]]
            many = is_array(step.kernel, word)
            arguments.append(f"(const double[{len(values)}]){{ {', '.join(values)} }}" if many else values[0])
        many = step.kernel.fields.copies > 1
        places = [f"{word}[{copy}]" if many else word for word, copy, _ in step.weights]
        given = [self.given(given) for _, _, given in step.weights]
        lines = [f"s->{step.member}.{place} = {value};" for place, value in zip(places, given, strict=True)]
        return [*lines, f"{step.kernel.init.name}({', '.join(arguments)});"]

    def given(self, given: Given) -> str:
        if given.is_dt:
            return "dt"
        if given.column is None:
            return self.exact.number(given.number)
        size = self.exported.factor(given.column)
        name = f"p->{parameter_name(self.identified.entry(given.column).name)}"
        return name if size == 1 else f"{name} * {self.exact.number(size)}"

    def call(self, step: Step) -> str:
        tile = step.operation.tile
        if step.kernel is None:
            place = {"keep_prompt": 1, "keep_force": 2}[step.operation.action]
            return f"t[{tile + place}] = t[{tile}];"
        used = reads(step.kernel.step.body)
        inputs = {"c": f"&s->{step.member}", "fresh": "s->fresh", "u": f"s->drive[{step.axis}] + 1"}
        arguments = [text for word, text in inputs.items() if word in used] + [f"t + {tile}" if tile else "t"]
        return f"{step.kernel.step.name}({', '.join(arguments)});"

    def delays(self) -> list[str]:
        late = [step for step in self.exported.steps if step.kernel and step.kernel.block.kind == "shift"]
        return [f"!(s->{step.member}.late <= {self.exported.history - 2})" for step in late]

    def signals(self) -> dict[str, list[str]]:
        """Drives to SI units and into the state, responses to the user's units."""
        one, history, drive = self.identified, self.exported.history, "s->drive"
        into, between, out = [], [], []
        for axis in range(self.exported.axes):
            size = one.scale(axis)[0]
            given = f"drive[{axis}]" if size == 1 else f"drive[{axis}] * {self.number(size)}"
            share = f"(real)k / {self.exported.substeps}"
            between.append(f"t[{TILES * axis}] = before[{axis}] + ({given} - before[{axis}]) * ({share});")
            between.append(f"t[{TILES * axis}] = fresh ? {given} : t[{TILES * axis}];")
            into.append(f"t[{TILES * axis}] = {given};")
        for i, axis in enumerate(one.outputs):
            size = one.scale(axis)[1]
            shown = "" if size == 1 else f" / {self.number(size)}"
            out.append(f"displacement[{i}] = t[{TILES * axis}]{shown};")
        shift = [
            f"for (int axis = 0; axis < {self.exported.axes}; axis++) {{",
            f"    for (int i = 0; i < {history - 1}; i++) {{",
            f"        {drive}[axis][i] = fresh ? t[{TILES} * axis] : {drive}[axis][i + 1];",
            "    }",
            f"    {drive}[axis][{history - 1}] = t[{TILES} * axis];",
            "}",
        ]  # fmt: skip
        if history == 1:
            shift = [f"{drive}[{axis}][0] = t[{TILES * axis}];" for axis in range(self.exported.axes)]
        blank = [f"{drive}[{axis}][{history - 1}] = 0;" for axis in range(self.exported.axes)]
        return {
            "inputs": into, "inputs_between": between, "outputs": out, "shift": shift if history else [],
            "history_init": blank if history else [],
        }  # fmt: skip

    def test(self) -> dict[str, Any]:
        drive, response = self.identified.test_vector
        rows = [[", ".join(map(self.number, row)) for row in signal.T] for signal in (drive, response)]
        ranges = ", ".join(repr(float(np.abs(row).max()) or 1.0) for row in response)
        inverse: dict[str, Any] = {"inverse": None}
        if not self.inverse.refused:
            asked = self.inverse.drive()[:, : drive.shape[1] - self.inverse.latency]
            inverse = {
                "inverse": True,
                "asked": [", ".join(map(self.number, row)) for row in asked.T],
                "largest_drive": repr(float(np.abs(asked).max()) or 1.0),
                "inverse_tolerance": TOLERANCE[self.precision],
            }
        return {
            **inverse,
            "samples": drive.shape[1],
            "tolerance": TOLERANCE[self.precision],
            "drive": rows[0],
            "response": rows[1],
            "ranges": ranges,
        }
