"""The keys of a job file, from its schema."""

from __future__ import annotations

import json
from typing import Any, NamedTuple


class Key(NamedTuple):
    key: str
    value: str
    default: str
    doc: str


class Section(NamedTuple):
    """A mapping in a job file: where it stands, what it is, and its keys."""

    title: str
    doc: str
    rows: list[Key]


WORDS = {
    "integer": "whole number",
    "number": "number",
    "string": "text",
    "boolean": "true or false",
    "object": "mapping",
}
PLACES = {
    "Source": "each item of records",
    "Level": "a drive, as of rest_at",
    "Channels": "channels",
    "Axis": "each axis of channels.axes",
    "Channel": "a channel: time, drive or response",
    "Setting": "each item of parameters",
    "Choice": "a block or optimizer with settings",
    "Stopping": "stop",
    "Quantity": "a quantity, such as the target of stop",
    "Limits": "limits",
}


def key_tables() -> list[Section]:
    """The job itself, then each kind of mapping that it may hold."""
    from pzt_ident.job.schema import Job

    schema = Job.model_json_schema()
    kinds = sorted(schema["$defs"], key=lambda kind: list(PLACES).index(kind) if kind in PLACES else len(PLACES))
    first = Section("The file", "What to identify from which records, and how.", _rows(schema))
    return [first, *(_section(kind, schema["$defs"][kind]) for kind in kinds)]


def _section(kind: str, schema: dict[str, Any]) -> Section:
    return Section(PLACES.get(kind, kind), " ".join(schema.get("description", "").split()), _rows(schema))


def _rows(schema: dict[str, Any]) -> list[Key]:
    required = schema.get("required", ())
    return [
        Key(key, _value(item), "required" if key in required else _default(item), item.get("description", ""))
        for key, item in schema["properties"].items()
    ]


def _default(item: dict[str, Any]) -> str:
    value = item.get("default")
    return "" if value in (None, [], {}) or isinstance(value, dict) else json.dumps(value)


def _value(item: dict[str, Any]) -> str:
    """What a value may be, in words."""
    if "$ref" in item:
        return "mapping"
    if "enum" in item:
        return " or ".join(item["enum"])
    if "anyOf" in item or "oneOf" in item:
        options = [
            _value(option) for option in item.get("anyOf", item.get("oneOf", ())) if option.get("type") != "null"
        ]
        return " or ".join(dict.fromkeys(options))
    if item.get("type") == "array":
        parts = item.get("prefixItems")
        return f"[{', '.join(map(_value, parts))}]" if parts else f"list: {_value(item['items'])}"
    return WORDS.get(item.get("type", ""), "any")
