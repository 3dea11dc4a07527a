"""The keys of a job file, from its schema."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Mapping
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
ANY = "items", "additionalProperties"  # of a list, of a mapping whose keys are names
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

    schema = with_short_forms(Job.model_json_schema())
    kinds = sorted(schema["$defs"], key=lambda kind: list(PLACES).index(kind) if kind in PLACES else len(PLACES))
    about = {key: item["description"] for key, item in schema["properties"].items()}
    first = Section("The file", "What to identify from which records, and how.", _rows(schema, about))
    return [first, *(_section(kind, schema["$defs"][kind]) for kind in kinds)]


def with_short_forms(schema: dict[str, Any]) -> dict[str, Any]:
    """The schema of a job in which each value that has a short form says how that is written, as `short`."""
    from pzt_ident.job.normalise import SHORT_FORMS

    for pattern, _, written in SHORT_FORMS:
        items = [schema]
        for word in pattern.split("."):
            items = [below for item in items for below in _below(schema["$defs"], item, word)]
        for item in items:
            item |= {"short": written} if written else {}
    return schema


def _below(kinds: Mapping[str, Any], item: Mapping[str, Any], word: str) -> list[dict[str, Any]]:
    """What the schema says of a key of a mapping, or, of `*`, of any of its keys or of each item of a list."""
    options = [item, *item.get("anyOf", ())]
    options += [kinds[option["$ref"].rpartition("/")[2]] for option in options if "$ref" in option]
    if word != "*":
        return [option["properties"][word] for option in options if "properties" in option]
    parts = [part for option in options for part in option.get("prefixItems", ())]
    return parts + [option[any_of] for option in options for any_of in ANY if any_of in option]


def sections_of(key: str) -> list[Section]:
    """The sections that have a key, each with that alone, and those of what it may hold; empty where there is no such
    key."""
    every = key_tables()
    alone = [section._replace(rows=[row for row in section.rows if row.key == key]) for section in every]
    held = _held_by(key) if any(section.rows for section in alone) else set()
    return [one for one in alone if one.rows] + [section for section in every if section.title in held]


def _held_by(key: str) -> set[str]:
    """The titles of the sections of mappings that the value of a key may hold, at any depth."""
    from pzt_ident.job.schema import Job

    schema = Job.model_json_schema()
    items = [part["properties"][key] for part in (schema, *schema["$defs"].values()) if key in part["properties"]]
    held: set[str] = set()
    while items:
        new = {*re.findall(r'"#/\$defs/(\w+)"', json.dumps(items))} - held
        items, held = [schema["$defs"][kind] for kind in new], held | new
    return {PLACES.get(kind, kind) for kind in held}


def _section(kind: str, schema: dict[str, Any]) -> Section:
    doc, about = documented(schema["description"], schema["properties"])
    return Section(PLACES.get(kind, kind), doc, _rows(schema, about))


def documented(text: str, keys: Iterable[str]) -> tuple[str, dict[str, str]]:
    """What a docstring says of the whole, and of each key: `key: what it is.`, the first one behind an empty line."""
    doc, _, rest = text.partition("\n\n")
    parts = re.split(rf"(?:^|(?<=\. ))({'|'.join(keys)}): ", " ".join(rest.split()))
    about = {key: part.strip() for key, part in zip(parts[1::2], parts[2::2], strict=True)}
    return " ".join(doc.split()), {key: part[:1].upper() + part[1:] for key, part in about.items()}


def _rows(schema: dict[str, Any], about: Mapping[str, str]) -> list[Key]:
    required = schema.get("required", ())
    return [
        Key(key, _value(item), "required" if key in required else _default(item), about.get(key, ""))
        for key, item in schema["properties"].items()
    ]


def _default(item: dict[str, Any]) -> str:
    value = item.get("default")
    return "" if value in (None, "", [], {}) or isinstance(value, dict) else json.dumps(value)


def _value(item: dict[str, Any]) -> str:
    """What a value may be, in words, and how its short form is written."""
    return f"{_long(item)} or {item['short']}" if "short" in item else _long(item)


def _long(item: dict[str, Any]) -> str:
    """What a value may be in its long form, in words."""
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
    below = item.get("additionalProperties")
    if isinstance(below, dict) and "short" in below:
        return f"mapping: {_value(below)}"
    return WORDS.get(item.get("type", ""), "any")
