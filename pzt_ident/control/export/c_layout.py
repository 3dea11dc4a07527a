"""Names, comments and lines of the exported C."""

from __future__ import annotations

import textwrap

from pzt_ident.control.export.tile import Kernel
from pzt_ident.control.identified import Identified

WIDTH = 118


def parameter_name(name: str) -> str:
    return name.replace(".", "_")


def headline(kernel: Kernel) -> str:
    """The equation of a block, and its name in a job."""
    first = (kernel.block.__doc__ or "").strip().partition("\n\n")[0]
    return " ".join(f"{kernel.block.item()}: {first}".split()).replace("*/", "* /")


def notes(identified: Identified) -> list[str]:
    """What is in the model and what is not."""
    chain = identified.chain
    left_out = [block.name for block in (*chain.blocks, *chain.additions) if block.amounts()]
    text = [identified.origin] if identified.origin else []
    axes = zip(identified.chain.axes, identified.drive_units, identified.ends, strict=True)
    ranges = [f"{axis} {low:.6g} to {high:.6g} {unit}" for axis, unit, (low, high) in axes]
    text.append(f"Identified with drives of {', '.join(ranges)}.")
    if left_out:
        text.append(f"Not in it, since they do not follow from the drive: {', '.join(left_out)}, and the offset.")
    return [line for paragraph in text for line in textwrap.wrap(paragraph, 110)]


def wrapped(line: str) -> list[str]:
    """A line of C in lines that fit."""
    if len(line) <= WIDTH or line.startswith("#") or '"' in line:
        return [line]
    indent = line[: len(line) - len(line.lstrip())]
    deeper = indent + ("   " if line.lstrip().startswith("/*") else "        ")
    return textwrap.wrap(line, WIDTH, initial_indent="", subsequent_indent=deeper, break_long_words=False,
                         break_on_hyphens=False, drop_whitespace=True, replace_whitespace=False)  # fmt: skip
