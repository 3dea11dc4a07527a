"""The short forms of a job, expanded: a header for a channel, `1 s` for a time, a word for an optimizer."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

from pzt_ident.data import units
from pzt_ident.errors import InputError
from pzt_ident.job.document import Document, Loc

Expand = Callable[[Document, Loc, Any], Any]

QUANTITY = re.compile(r"^([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*([^\s\d].*)$")


def long_form(document: Document) -> dict[str, Any]:
    """The data of a job in its long form; a quantity that cannot be read is added as a fault."""
    data: Any = document.data
    for pattern, expand, _ in SHORT_FORMS:
        data = _expanded(document, data, pattern.split("."), expand, ())
    return data


def _expanded(document: Document, data: Any, pattern: list[str], expand: Expand, loc: Loc) -> Any:
    """The data with `expand` applied at every place of the pattern, in which `*` is any key or index."""
    if not pattern:
        return expand(document, loc, data)
    head, below = pattern[0], pattern[1:]
    if isinstance(data, dict):
        matching = {key: value for key, value in data.items() if head in ("*", key)}
        return data | {key: _expanded(document, value, below, expand, (*loc, key)) for key, value in matching.items()}
    if isinstance(data, list) and head == "*":
        return [_expanded(document, value, below, expand, (*loc, i)) for i, value in enumerate(data)]
    return data


def _channel(document: Document, loc: Loc, value: Any) -> Any:
    return {"name": value} if isinstance(value, str) else value


def _block(document: Document, loc: Loc, value: Any) -> Any:
    return value if isinstance(value, str) else _choice(document, loc, value)


def _choice(document: Document, loc: Loc, value: Any) -> Any:
    if isinstance(value, str):
        return {"name": value}
    if not isinstance(value, dict):
        return value
    name = {"name": value["name"]} if "name" in value else {}
    return name | {"settings": {word: setting for word, setting in value.items() if word != "name"}}


def _in(unit: str) -> Expand:
    def convert(document: Document, loc: Loc, value: Any) -> Any:
        if not isinstance(value, str):
            return value
        number, given = _number_and_unit(document, loc, value, f"1 {unit}")
        try:
            if units.same_kind(given or unit, unit):
                return number * units.factor(given or unit) / units.factor(unit)
            document.fault(loc, f"{value!r} is not in {unit}", f"write it with a unit such as {unit}")
        except InputError as error:
            document.fault(loc, f"{value!r}: {error.message}", error.remedy)
        return number

    return convert


def _quantity(example: str) -> Expand:
    def convert(document: Document, loc: Loc, value: Any) -> Any:
        if isinstance(value, str):
            return dict(zip(("value", "unit"), _number_and_unit(document, loc, value, example), strict=True))
        return {"value": value} if isinstance(value, (int, float)) else value

    return convert


def _levels(document: Document, loc: Loc, value: Any) -> Any:
    """A drive for each axis; one alone is that of all."""
    if value is None:
        return None
    if isinstance(value, list):
        document.fault(loc, "is a list", "write a drive such as `0 V`, or one by axis such as `{x: 0 V}`")
        return None
    level_of = _quantity("0 V")
    if isinstance(value, dict):
        return {axis: level_of(document, (*loc, axis), level) for axis, level in value.items()}
    channels = document.data.get("channels")
    axes = channels.get("axes") if isinstance(channels, dict) else None
    return dict.fromkeys(axes, level_of(document, loc, value)) if isinstance(axes, dict) else None


def _number_and_unit(document: Document, loc: Loc, text: str, example: str) -> tuple[float, str | None]:
    """Number and unit; 1 and a fault where the text is not a quantity."""
    if match := QUANTITY.match(text.strip()):
        return float(match[1]), match[2]
    document.fault(loc, f"{text!r} is not a number with a unit", f"write a number with its unit, such as `{example}`")
    return 1.0, None


SHORT_FORMS: tuple[tuple[str, Expand, str], ...] = (
    ("records.*.sample_rate", _in("Hz"), "`1 kHz`"),
    ("records.*.settle", _in("s"), "`20 ms`"),
    ("records.*.time.*", _in("s"), "`20 ms`"),
    ("records.*.rest_at", _levels, "`0 V`"),
    ("records.*.channels.*", _channel, "a header"),
    ("channels.time", _channel, "a header"),
    ("channels.axes.*.drive", _channel, "a header"),
    ("channels.axes.*.response", _channel, "a header"),
    ("model.*", _block, ""),
    ("optimizers.*", _choice, "a name"),
    ("stop.seconds", _in("s"), "`5 min`"),
    ("stop.target", _quantity("0.1 um"), "`0.1 um`"),
)
"""The place of each short form, with `*` for any key or index, how it is expanded, and how it is written; empty where
its long form is written so, too."""
