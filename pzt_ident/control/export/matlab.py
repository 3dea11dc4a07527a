"""The identified model as a MATLAB function, which Octave runs as well."""

from __future__ import annotations

import textwrap

from pzt_ident.control.export.c_layout import headline, notes, parameter_name
from pzt_ident.control.export.matlab_text import RESERVED, MatlabText, word_of
from pzt_ident.control.export.program import Exported, Given, Step, is_array
from pzt_ident.control.export.tile import Kernel
from pzt_ident.control.export.trees import reads
from pzt_ident.control.identified import Identified
from pzt_ident.model.block import TILES

PICK = ["function value = pick(test, this, other)", "    if test", "        value = this;", "    else",
        "        value = other;", "    end", "end", ""]  # fmt: skip


def files(identified: Identified) -> dict[str, str]:
    """Text by name of file."""
    lines = MatlabModel(identified).lines()
    return {f"{identified.word}.m": "\n".join(line for text in lines for line in wrapped(text)).rstrip() + "\n"}


class MatlabModel:
    """The parts of the file as lines."""

    def __init__(self, identified: Identified) -> None:
        self.identified = identified
        self.exported = Exported(identified, RESERVED | {identified.word})
        self.text = MatlabText(self.exported.library.constants)
        self.results = {f.name: f.results for f in self.exported.library.functions.values()}

    def lines(self) -> list[str]:
        made = [*self.main(), *self.parameters(), *self.init(), *self.step()]
        for kernel in self.exported.kernels.values():
            made += self.kernel(kernel)
        for function in self.exported.functions():
            made += self.text.author(function, self.results)
        return made + PICK

    def main(self) -> list[str]:
        one, word = self.identified, self.identified.word
        names = one.chain.axes
        drives = ", ".join(f"{axis} [{unit}]" for axis, unit in zip(names, one.drive_units, strict=True))
        responses = ", ".join(f"{names[axis]} [{one.response_units[axis]}]" for axis in one.outputs)
        return [
            f"function [displacement, s] = {word}(drive, s)",
            f"    % {one.name}: an identified piezo stage, exported by pzt-ident.",
            *(f"    % {line}" for line in notes(one)),
            "    %",
            f"    % displacement = {word}(drive): response to a drive (samples by axes), from rest under its first",
            f"    % sample, at the sample time {one.dt!r} s. {word}(drive, dt): at another one.",
            f"    % [displacement, s] = {word}(drive, s): goes on from the state s. drive: {drives};",
            f"    % displacement: {responses}.",
            "    if nargin < 2",
            f"        s = {one.dt!r};",
            "    end",
            "    if isnumeric(s)",
            "        s = initial(s, identified());",
            "    end",
            f"    displacement = zeros(size(drive, 1), {len(one.outputs)});",
            "    for i = 1:size(drive, 1)",
            "        [s, displacement(i, :)] = sample(s, drive(i, :));",
            "    end",
            "end",
            "",
        ]

    def parameters(self) -> list[str]:
        lines = [
            "function p = identified()",
            "    % The identified values, in the units of the data.",
            "    p = struct();",
        ]
        for column in self.exported.columns:
            one, entry = self.identified, self.identified.entry(column)
            error = "" if one.errors[column] is None else f", standard error {one.errors[column]:.2g}"
            value = self.text.number(one.value(column))
            lines.append(f"    p.{parameter_name(entry.name)} = {value}; % {one.units[column]}{error}")
        return [*lines, "end", ""]

    def given(self, given: Given) -> str:
        if given.is_dt:
            return "dt"
        if given.column is None:
            return self.text.number(given.number)
        size = self.exported.factor(given.column)
        name = f"p.{parameter_name(self.identified.entry(given.column).name)}"
        return name if size == 1 else f"{name} * {self.text.number(size)}"

    def init(self) -> list[str]:
        exported = self.exported
        lines = [
            "function s = initial(dt, p)",
            "    % Coefficients for a sample time dt in s, and rest.",
            "    s.fresh = 1;",
        ]
        lines += [f"    s.drive = zeros({exported.axes}, {exported.history});"] if exported.history else []
        lines += [f"    dt = dt / {exported.substeps};"] if exported.substeps > 1 else []
        for step in exported.steps:
            lines += [f"    {line}" for line in self.member(step)]
        return [*lines, "end", ""]

    def member(self, step: Step) -> list[str]:
        if step.kernel is None:
            return []
        fields = step.kernel.fields
        blank = [f"'{word_of(word)}', {f'zeros(1, {n})' if n > 1 else 0}" for word, n in fields.names.items()]
        blank += [f"'cells', zeros(1, {fields.cells})"] if fields.cells else []
        lines = [f"s.{step.member} = struct({', '.join(blank)});"]
        many = fields.copies > 1
        lines += [
            f"s.{step.member}.{word}{f'({copy + 1})' if many else ''} = {self.given(given)};"
            for word, copy, given in step.weights
        ]
        if step.kernel.init.body:
            arguments = [f"s.{step.member}", *(self.argument(step, word) for word in step.kernel.init.parameters)]
            lines.append(f"s.{step.member} = {step.kernel.init.name}({', '.join(arguments)});")
        return lines

    def argument(self, step: Step, word: str) -> str:
        assert step.kernel
        values = [self.given(given) for given in step.given[word]]
        return f"[{', '.join(values)}]" if is_array(step.kernel, word) else values[0]

    def step(self) -> list[str]:
        one, exported = self.identified, self.exported
        sizes = [self.text.number(one.scale(axis)[0]) for axis in range(exported.axes)]
        lines = [
            "function [s, displacement] = sample(s, drive)",
            "    % One sample.",
            f"    t = zeros(1, {TILES * exported.axes});",
            f"    drive = drive .* [{', '.join(sizes)}];",
        ]
        chain = self.chain()
        if exported.substeps > 1:
            lines += [
                "    before = s.drive(:, end)';",
                f"    for k = pick(s.fresh, {exported.substeps}, 1):{exported.substeps}",
                f"        at = pick(s.fresh, drive, before + (drive - before) * (k / {exported.substeps}));",
                *(f"        {line}" for line in chain),
                "    end",
            ]
        else:
            lines += ["    at = drive;", *(f"    {line}" for line in chain)]
        for i, axis in enumerate(one.outputs):
            size = self.text.number(one.scale(axis)[1])
            lines.append(f"    displacement({i + 1}) = t({TILES * axis + 1}) / {size};")
        return [*lines, "end", ""]

    def chain(self) -> list[str]:
        """The signal chain under the drive `at`."""
        exported = self.exported
        lines = []
        if exported.history:
            lines += ["if s.fresh", f"    s.drive = repmat(at', 1, {exported.history});", "end"]
            lines.append("s.drive = [s.drive(:, 2:end), at'];")
        lines += [f"t({TILES * axis + 1}) = at({axis + 1});" for axis in range(exported.axes)]
        return [*lines, *(self.call(step) for step in exported.steps), "s.fresh = 0;"]

    def call(self, step: Step) -> str:
        tile = step.operation.tile
        if step.kernel is None:
            place = {"keep_prompt": 1, "keep_force": 2}[step.operation.action]
            return f"t({tile + place + 1}) = t({tile + 1});"
        used = reads(step.kernel.step.body)
        inputs = {"fresh": "s.fresh", "u": f"s.drive({step.axis + 1}, 2:end)"}
        more = [text for word, text in inputs.items() if word in used]
        signals = f"t({tile + 1}:end)" if tile else "t"
        arguments = ", ".join([f"s.{step.member}", *more, signals])
        return f"[s.{step.member}, {signals}] = {step.kernel.step.name}({arguments});"

    def kernel(self, kernel: Kernel) -> list[str]:
        made: list[str] = []
        if kernel.init.body:
            made += self.text.define(kernel.init, ["c", *kernel.init.parameters], ["c"], self.results, "")
        used = reads(kernel.step.body)
        inputs = ["c", *(word for word in ("fresh", "u") if word in used), "t"]
        return made + self.text.define(kernel.step, inputs, ["c", "t"], self.results, headline(kernel))


def wrapped(line: str) -> list[str]:
    """A line in lines that fit."""
    if len(line) <= 118:
        return [line]
    pad = line[: len(line) - len(line.lstrip())]
    if line.lstrip().startswith("%"):
        return textwrap.wrap(line, 118, subsequent_indent=pad + "% ", break_long_words=False)
    parts = textwrap.wrap(line, 114, subsequent_indent=pad + "        ", break_long_words=False, break_on_hyphens=False)
    return [*(f"{part} ..." for part in parts[:-1]), parts[-1]]
