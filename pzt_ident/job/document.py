"""A YAML text as plain data, with line and column of every key and value.

Only YAML's core types are built (mapping, list, text, number, true/false, null); any other tag is a fault.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NoReturn

from pzt_ident.errors import InputError
from pzt_ident.job.chain import CachedChain

Loc = tuple[str | int, ...]

LARGEST_TEXT = 1 << 20
MOST_VALUES = 100_000
_TAG = "tag:yaml.org,2002:"
_PLAIN_TEXT = ("str", "timestamp", "merge")


@dataclass(frozen=True, order=True)
class Fault:
    """One thing wrong with a document; line and column count from 1."""

    line: int
    column: int
    key: str
    message: str
    remedy: str = field(compare=False)

    def error(self, file: str) -> InputError:
        """With its place in the file; of a text that is in no file, with its key alone."""
        place = f"{file}:{self.line}:{self.column}" if file else ""
        where = ": ".join(part for part in (place, self.key) if part)
        return InputError(self.message, where=where, remedy=self.remedy)


def reject(file: str, faults: Sequence[Fault]) -> NoReturn:
    """Raise one InputError that lists every fault in the order of the file."""
    errors = [fault.error(file) for fault in sorted(set(faults))]
    if len(errors) == 1:
        raise errors[0]
    raise InputError("\n".join([f"{file or 'the job'} has {len(errors)} faults", *map(str, errors)]))


class Document:
    """data: mappings, lists and values. faults: all that is wrong, at first duplicate keys, tags and the like.
    folder: the one that paths are relative to. plugins: whether files of code that the job lists may be loaded.

    Raises InputError where the text is not YAML.
    """

    def __init__(self, text: str, file: str, folder: Path = Path(), plugins: bool = False) -> None:
        self.file, self.folder, self.plugins = file, folder, plugins
        self.faults: list[Fault] = []
        self.chain = CachedChain()
        self._values = 0
        self._open: list[int] = []
        if len(text) > LARGEST_TEXT:
            reject(
                file, [Fault(1, 1, "", f"{len(text)} characters", "is this a data file? A job file is a short YAML")]
            )
        try:
            self._root = _compose(text, file)
            self.data: Any = None if self._root is None else self._build(self._root, ())
        except RecursionError:
            reject(file, [Fault(1, 1, "", "nested too deeply", "a job file is a few levels deep")])

    def fault(self, loc: Loc, message: str, remedy: str, *, at_key: bool = False) -> None:
        """Add a fault at a place, or at the nearest place above it that the text has."""
        path = self._path(loc)
        name, node = path[-1] if path else (None, self._root)
        if name is not None and (node.value == "" or (at_key and len(path) == len(loc))):
            node = name
        key = "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in loc[: len(path)])
        self.faults.append(_at(node, message, remedy, key.removeprefix(".")))

    def reach(self, loc: Loc) -> Loc:
        """The part of a place that the text has."""
        return loc[: len(self._path(loc))]

    def keys(self, loc: Loc) -> list[str]:
        """Those of the mapping at a place, as written."""
        node = self._node(loc)
        return [key.value for key, _ in node.value if key.id == "scalar"] if node.id == "mapping" else []

    def source(self, loc: Loc) -> str:
        """The text at a place, as written, shortened."""
        node = self._node(loc)
        text = (
            node.value
            if isinstance(node.value, str)
            else f"a list of {len(node.value)}"
            if node.id == "sequence"
            else "a mapping"
        )
        text = "nothing" if _kind(node) == "null" else repr(text) if _kind(node) == "str" else text
        return text if len(text) <= 60 else text[:57] + "..."

    def kind(self, loc: Loc) -> str:
        """What is at a place: map, seq, str, int, float, bool or null."""
        return _kind(self._node(loc))

    def _node(self, loc: Loc) -> Any:
        """The value node at a place, or at the nearest place above it."""
        return [self._root, *(value for _, value in self._path(loc))][-1]

    def _path(self, loc: Loc) -> list[tuple[Any, Any]]:
        """Key node (None in a list) and value node of every step down, as far as it goes."""
        steps: list[tuple[Any, Any]] = []
        for part in loc:
            step = _child(steps[-1][1] if steps else self._root, part)
            if step is None:
                break
            steps.append(step)
        return steps

    def _build(self, node: Any, loc: Loc) -> Any:
        self._values += 1
        if self._values > MOST_VALUES or id(node) in self._open:
            reject(self.file, [_at(node, "too many values", "write the job without nested anchors")])
        kind = _kind(node)
        if node.id == "scalar":
            return self._scalar(node, kind)
        if kind not in ("map", "seq"):
            self._unknown_tag(node)
        self._open.append(id(node))
        built = self._mapping(node, loc) if node.id == "mapping" else self._sequence(node, loc)
        self._open.pop()
        return built

    def _sequence(self, node: Any, loc: Loc) -> list[Any]:
        return [self._build(item, (*loc, i)) for i, item in enumerate(node.value)]

    def _mapping(self, node: Any, loc: Loc) -> dict[str, Any]:
        mapping: dict[str, Any] = {}
        for key, value in node.value:
            if key.id != "scalar":
                self.faults.append(_at(key, "a key must be a word", "write `key: value`"))
            elif key.value in mapping:
                self.faults.append(_at(key, f"duplicate key {key.value!r}", "keep one of the two"))
            else:
                self._scalar(key, _kind(key))
                mapping[key.value] = self._build(value, (*loc, key.value))
        return mapping

    def _scalar(self, node: Any, kind: str) -> Any:
        text = node.value
        if any(character == "\0" or "\ud800" <= character <= "\udfff" for character in text):
            self.faults.append(_at(node, f"{text!r} has a character that is not allowed", "remove it"))
            return "?"
        try:
            if kind == "null":
                return None
            if kind == "bool" and text.lower() in ("true", "false"):
                return text.lower() == "true"
            if kind == "int":
                return int(text.replace("_", ""), 0 if text.lstrip("+-")[:2].lower() in ("0x", "0o", "0b") else 10)
            if kind == "float":
                return float(text.replace("_", "").lower().replace(".inf", "inf").replace(".nan", "nan"))
        except ValueError:
            return text
        if kind not in (*_PLAIN_TEXT, "bool"):
            self._unknown_tag(node)
        return text

    def _unknown_tag(self, node: Any) -> None:
        remedy = "write the plain value; a job file can name no code"
        self.faults.append(_at(node, f"the tag {node.tag.replace(_TAG, '!!')!r} is not allowed", remedy))


def _compose(text: str, file: str) -> Any:
    """The tree of YAML nodes; None for an empty text."""
    from ruamel.yaml import YAML
    from ruamel.yaml.error import MarkedYAMLError, YAMLError

    yaml = YAML(typ="safe", pure=True)
    yaml.composer.warn_double_anchors = False
    try:
        return yaml.compose(text)
    except MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        problem = str(error.problem or error.context)
        reject(file, [Fault(mark.line + 1, mark.column + 1, "", f"not YAML: {problem}", _advice(problem))])
    except (YAMLError, ValueError, OverflowError) as error:
        reject(file, [Fault(1, 1, "", f"not YAML: {str(error).splitlines()[0]}", _advice(""))])


def _advice(problem: str) -> str:
    if "\\t" in problem:
        return "indent with spaces, not tabs"
    if "but got" in problem or "mapping values" in problem or "token" in problem:
        return 'put text with brackets, braces or a colon in quotes, such as "u_x [V]"'
    if "another document" in problem:
        return "one job a file: remove the line ---"
    return "see `pzt-ident init` for a job file to start from"


def _at(node: Any, message: str, remedy: str, key: str = "") -> Fault:
    mark = node.start_mark
    return Fault(mark.line + 1, mark.column + 1, key, message, remedy)


def _kind(node: Any) -> str:
    return str(node.tag or "").removeprefix(_TAG)


def _child(node: Any, part: str | int) -> tuple[Any, Any] | None:
    """Key node (None in a list) and value node of one step down."""
    if node.id == "mapping":
        return next(((key, value) for key, value in node.value if key.value == part), None)
    if node.id == "sequence" and isinstance(part, int) and part < len(node.value):
        return None, node.value[part]
    return None
