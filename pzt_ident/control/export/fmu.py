"""The identified model as an FMU for co-simulation (FMI 2.0): its C, with a binary where a C compiler is installed."""

from __future__ import annotations

import hashlib
import io
import shutil
import subprocess
import sys
import warnings
import zipfile
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any
from xml.sax.saxutils import quoteattr

from pzt_ident.control.export.c import CModel
from pzt_ident.control.identified import Identified
from pzt_ident.data.units import dimension, factor
from pzt_ident.errors import RunError

PLATFORM = {"linux": ("linux64", ".so"), "darwin": ("darwin64", ".dylib"), "win32": ("win64", ".dll")}
BASE = ("m", "kg", "s", "A", "K")


def files(identified: Identified, precision: str = "double") -> dict[str, bytes]:
    """The FMU by its name."""
    model, word = CModel(identified, precision), identified.word
    facts = model.facts()
    sources = {f"{word}.{end}": model.render(f"model.{end}.jinja", **facts) for end in ("h", "c")}
    guid = hashlib.sha256("".join(sources.values()).encode()).hexdigest()[:32]
    sources[f"{word}_fmu.c"] = model.render("fmu.c.jinja", guid=guid, parameters=facts["parameters"])
    packed = {f"sources/{name}": text.encode() for name, text in sources.items()}
    packed["modelDescription.xml"] = model.render("modelDescription.xml.jinja", **description(model, guid)).encode()
    return {f"{word}.fmu": zipped(packed | binary(word, sources))}


def description(model: CModel, guid: str) -> dict[str, Any]:
    one, exported = model.identified, model.exported
    names = one.chain.axes
    drives = [
        variable(f"u_{axis}", "input", unit, "Drive.", 0.0) for axis, unit in zip(names, one.drive_units, strict=True)
    ]
    responses = [variable(names[a], "output", str(one.response_units[a]), "Displacement.") for a in one.outputs]
    parameters = [
        variable(one.entry(c).name, "parameter", one.units[c], one.entry(c).parameter.doc, one.value(c))
        for c in exported.columns
    ]
    variables = [*drives, *responses, *parameters]
    units = dict.fromkeys(item["unit"] for item in variables)
    return {
        "name": escaped(one.name),
        "description": escaped(one.origin),
        "guid": guid,
        "dt": repr(one.dt),
        "units": [{"name": escaped(unit), "base": base(unit)} for unit in units],
        "variables": [{**item, "unit": escaped(item["unit"])} for item in variables],
        "outputs": [len(drives) + 1 + i for i in range(len(responses))],
    }


def variable(name: str, causality: str, unit: str, comment: str, start: float | None = None) -> dict[str, str]:
    fixed = causality == "parameter"
    return {
        "name": name,
        "causality": causality,
        "variability": "fixed" if fixed else "discrete",
        "initial": {"parameter": ' initial="exact"', "output": ' initial="calculated"'}.get(causality, ""),
        "unit": unit,
        "comment": escaped(comment),
        "start": "" if start is None else f' start="{start!r}"',
    }


def escaped(text: str) -> str:
    return quoteattr(text, {'"': "&quot;"})[1:-1]


def base(unit: str) -> str:
    """A unit by its exponents of SI base units and its size."""
    powers = [f' {word}="{power}"' for word, power in zip(BASE, dimension(unit), strict=True) if power]
    return "".join(powers) + ("" if factor(unit) == 1 else f' factor="{factor(unit)!r}"')


def binary(word: str, sources: dict[str, str]) -> dict[str, bytes]:
    """The shared library for this machine; none where no compiler is installed. Raises RunError where it fails."""
    compiler, platform = shutil.which("cc") or shutil.which("gcc"), PLATFORM.get(sys.platform)
    if not compiler or not platform:
        warnings.warn("no C compiler is installed: the FMU holds sources alone", stacklevel=2)
        return {}
    with TemporaryDirectory() as scratch:
        folder, library = Path(scratch), f"{word}{platform[1]}"
        for name, text in sources.items():
            (folder / name).write_text(text)
        command = [compiler, "-std=c99", "-O2", "-shared", "-fPIC", "-fvisibility=hidden", "-o", library]
        made = [name for name in sources if name.endswith(".c")]
        done = subprocess.run([*command, *made, "-lm"], cwd=folder, capture_output=True, text=True)
        if done.returncode:
            raise RunError(f"{compiler} does not compile the exported model: {done.stderr[:500]}")
        return {f"binaries/{platform[0]}/{library}": (folder / library).read_bytes()}


def zipped(files: dict[str, bytes]) -> bytes:
    """The same bytes for the same files."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            archive.writestr(zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0)), content, zipfile.ZIP_DEFLATED)
    return buffer.getvalue()
