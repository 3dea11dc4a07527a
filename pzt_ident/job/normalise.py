"""The short ways to write a job, written out: a header for a channel, `1 s` for a time, a word for an optimizer."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

from pzt_ident.data import units
from pzt_ident.errors import InputError
from pzt_ident.job.document import Document, Loc

Change = Callable[[Document, Loc, Any], Any]

QUANTITY = re.compile(r"^([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*([^\s\d].*)$")


def written_out(document: Document) -> dict[str, Any]:
    """The data of a mapping in the long form; a quantity that cannot be read is noted as a fault."""
    data: Any = document.data
    for pattern, change in _SHORT:
        data = _everywhere(document, data, pattern.split("."), change, ())
    return data


def _everywhere(document: Document, data: Any, pattern: list[str], change: Change, loc: Loc) -> Any:
    """The data with `change` made at every place of the pattern, in which `*` is any key or index."""
    if not pattern:
        return change(document, loc, data)
    head, rest = pattern[0], pattern[1:]
    if isinstance(data, dict):
        chosen = {key: value for key, value in data.items() if head in ("*", key)}
        return data | {key: _everywhere(document, value, rest, change, (*loc, key)) for key, value in chosen.items()}
    if isinstance(data, list) and head == "*":
        return [_everywhere(document, value, rest, change, (*loc, i)) for i, value in enumerate(data)]
    return data


def _channel(document: Document, loc: Loc, value: Any) -> Any:
    return {"name": value} if isinstance(value, str) else value


def _block(document: Document, loc: Loc, value: Any) -> Any:
    return value if isinstance(value, str) else _chosen(document, loc, value)


def _chosen(document: Document, loc: Loc, value: Any) -> Any:
    if isinstance(value, str):
        return {"name": value}
    if not isinstance(value, dict):
        return value
    named = {"name": value["name"]} if "name" in value else {}
    return named | {"settings": {word: setting for word, setting in value.items() if word != "name"}}


def _in(unit: str) -> Change:
    def convert(document: Document, loc: Loc, value: Any) -> Any:
        if not isinstance(value, str):
            return value
        number, given = _split(document, loc, value, f"1 {unit}")
        try:
            if units.same_kind(given or unit, unit):
                return number * units.factor(given or unit) / units.factor(unit)
            document.fault(loc, f"{value!r} is not in {unit}", f"write it with a unit such as {unit}")
        except InputError as error:
            document.fault(loc, f"{value!r}: {error.message}", error.remedy)
        return number

    return convert


def _target(document: Document, loc: Loc, value: Any) -> Any:
    if isinstance(value, str):
        return dict(zip(("value", "unit"), _split(document, loc, value, "0.1 um"), strict=True))
    return {"value": value} if isinstance(value, (int, float)) else value


def _split(document: Document, loc: Loc, text: str, example: str) -> tuple[float, str | None]:
    """Number and unit; a harmless number where the text is no quantity, which is noted."""
    if found := QUANTITY.match(text.strip()):
        return float(found[1]), found[2]
    document.fault(loc, f"{text!r} is not a number with a unit", f"write a number with its unit, such as `{example}`")
    return 1.0, None


_SHORT: tuple[tuple[str, Change], ...] = (
    ("records.*.sample_rate", _in("Hz")),
    ("records.*.settle", _in("s")),
    ("records.*.time.*", _in("s")),
    ("records.*.channels.*", _channel),
    ("channels.time", _channel),
    ("channels.axes.*.drive", _channel),
    ("channels.axes.*.response", _channel),
    ("model.*", _block),
    ("optimizers.*", _chosen),
    ("stop.seconds", _in("s")),
    ("stop.target", _target),
)
