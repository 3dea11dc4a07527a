"""What pydantic says of a job, in plain words, and the job without what is wrong."""

from __future__ import annotations

import copy
from difflib import get_close_matches
from typing import Any

from pydantic import ValidationError

from pzt_ident.errors import InputError, nearest
from pzt_ident.job.document import Document, Loc

Schema = dict[str, Any]

_EXPECTED = {
    "int_type": ("a whole number", "write a whole number, such as 5"),
    "int_from_float": ("a whole number", "write a whole number, such as 5"),
    "float_type": ("a number", "write a plain number, such as 0.5"),
    "finite_number": ("a finite number", "write a plain number, such as 0.5"),
    "string_type": ("a text", "put it in quotes"),
    "string_pattern_mismatch": ("a name for a folder", "use letters, digits, blanks and . + - inside"),
    "bool_type": ("true or false", "write true or false"),
    "literal_error": ("{expected}", "write {expected}"),
    "tuple_type": ("a list", "write it as [first, second]"),
    "dict_type": ("a mapping", "write it as {{key: value}}"),
    "dataclass_type": ("a mapping", ""),
    "greater_than": ("above {gt:g}", "give a value above {gt:g}"),
    "greater_than_equal": ("at least {ge:g}", "give at least {ge:g}"),
    "less_than_equal": ("at most {le:g}", "give at most {le:g}"),
    "too_long": ("a list of {max_length}", "give {max_length} values"),
    "missing": ("[first, second]", "write both"),
}
"""By pydantic's kinds of error: what the value is not, and what to write."""


def add_faults(document: Document, error: ValidationError, schema: Schema) -> None:
    """Add pydantic's errors to the document in plain words; those of the members of a union become one fault. schema:
    that of the job."""
    wrong: dict[Loc, list[tuple[str, str]]] = {}
    for item in error.errors(include_url=False):
        loc, kind, raised = item["loc"], item["type"], item.get("ctx", {}).get("error")
        if isinstance(raised, InputError):
            message = ": ".join(part for part in (raised.where, raised.message) if part)
            document.fault(loc, message, raised.remedy)
        elif kind in ("extra_forbidden", "unexpected_keyword_argument"):
            remedy = (
                _of_noise(loc) or _name_on_axis(document, loc) or nearest(str(loc[-1]), _known_keys(schema, loc[:-1]))
            )
            document.fault(loc, f"unknown key {loc[-1]!r}", remedy, at_key=True)
        elif kind == "missing" and isinstance(loc[-1], str):
            close = get_close_matches(loc[-1], document.keys(loc[:-1]), 1)
            remedy = f"add `{loc[-1]}: ...`" + "".join(f", or write it for {key!r}" for key in close)
            document.fault(loc[:-1], f"missing key {loc[-1]!r}", remedy)
        else:
            expected, remedy = _EXPECTED.get(kind, (item["msg"], "see `pzt-ident init` for an example"))
            facts = item.get("ctx", {})
            remedy = _as_it_is_meant(document, loc, kind, schema) or remedy.format(**facts)
            wrong.setdefault(document.reach(loc), []).append((expected.format(**facts), remedy))
    for loc, alternatives in wrong.items():
        expected, remedy = (" or ".join(dict.fromkeys(column)) for column in zip(*alternatives, strict=True))
        document.fault(loc, f"{document.source(loc)} is not {expected}", remedy)


_SEPARATE = {"records": 3, "parameters": 2, "stop": 2}
"""How deep a part can be removed from a section without false faults in the rest of it."""


def without(data: dict[str, Any], locs: list[Loc]) -> dict[str, Any]:
    """The data without the keys that lead to these places; without the section where no such key can be removed."""
    remaining = copy.deepcopy(data)
    for place in {loc[: _SEPARATE.get(str(loc[0]), 1)] for loc in locs}:
        owner: Any = remaining
        for part in place[:-1]:
            owner = owner[part] if not isinstance(owner, dict) or part in owner else {}
        if isinstance(owner, dict) and place[-1] in owner:
            del owner[place[-1]]
        else:
            remaining.pop(str(place[0]), None)
    return remaining


def _of_noise(loc: Loc) -> str:
    """Where the noise is told; empty for a key that does not ask for it."""
    return "the noise floor is taken from the data, `pzt-ident check` tells it" if "noise" in str(loc[-1]) else ""


def _name_on_axis(document: Document, loc: Loc) -> str:
    """What to write for an axis below the name of a parameter; empty where the place is none."""
    if loc[0] != "parameters" or loc[-1] not in document.keys(("channels", "axes")):
        return ""
    return f"the name of one axis is `{loc[-1]}.{loc[1]}`"


def _known_keys(schema: Schema, loc: Loc) -> list[str]:
    """The keys that the mapping at a place may have, from the schema of the job."""
    definitions, node = schema["$defs"], schema
    for part in loc:
        node = node["properties"][part] if part in node.get("properties", {}) else _item_schema(node)
        node = next((option for option in node.get("anyOf", ()) if "$ref" in option), node)
        if "$ref" in node:
            node = definitions[node["$ref"].rpartition("/")[2]]
    return list(node["properties"])


def _as_it_is_meant(document: Document, loc: Loc, kind: str, schema: Schema) -> str:
    """What to write for a number that is a parameter's, a mapping in the place of a list, or anything in that of a
    mapping; empty for other kinds of error."""
    number = loc[0] == "parameters" and len(loc) == 2 and document.kind(loc) in ("int", "float")
    if kind == "dataclass_type":
        some = f"{{value: {document.source(loc)}}}" if number else "{key: value}"
        return f"write it as {some}{_choice_of_keys(schema, loc)}"
    return "put it in brackets, [{...}]" if kind == "tuple_type" and document.kind(loc) == "map" else ""


def _choice_of_keys(schema: Schema, loc: Loc) -> str:
    """The keys that a mapping at a place may have, in words; the settings of a block or an optimizer are beside its
    name."""
    words = ["its settings" if key == "settings" else key for key in _known_keys(schema, loc)]
    return f" with some of {', '.join(words)}"


def _item_schema(schema: Schema) -> Schema:
    """The schema of the items of a list or mapping."""
    return schema["items"] if "items" in schema else schema["additionalProperties"]
