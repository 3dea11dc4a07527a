"""SVG files as elements of an HTML page."""

from __future__ import annotations

import re
from collections.abc import Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING
from xml.etree import ElementTree

if TYPE_CHECKING:
    from markupsafe import Markup

_NUMBER = re.compile(r"-?\d+\.\d+")
_NO_ROTATION = re.compile(r"rotate\(-?0 ")
_LINK = re.compile(r"(?<=url\(#)|(?<=^#)")


_NO_PARTS: Mapping[str, Mapping[str, str]] = MappingProxyType({})


def inline(svg: bytes, name: str, parts: Mapping[str, Mapping[str, str]] = _NO_PARTS) -> Markup:
    """An `svg` element for the page: coordinates rounded to 0.1 point, without metadata and font. Its ids start with
    `name`, so that no two figures of a page share one; the element with the id `<name>-caption` labels it. parts:
    attributes by the ids of groups."""
    from markupsafe import Markup

    root = ElementTree.fromstring(svg)
    for parent in list(root.iter()):
        for child in [child for child in parent if _local(child.tag) in ("metadata", "style")]:
            parent.remove(child)
    for element in root.iter():
        element.tag = _local(element.tag)
        part = parts.get(element.attrib.get("id", ""), {})
        element.attrib = {
            _local(key): _attribute(_local(key), value, name)
            for key, value in element.attrib.items()
            if not ((key == "id" and element.tag == "g") or _NO_ROTATION.match(value))
        }
        element.attrib |= part
        element.text, element.tail = (text and (text.strip() or None) for text in (element.text, element.tail))
    _unwrap(root)
    role = "group" if parts else "img"  # nothing in an image can be reached
    root.attrib = {"viewBox": root.attrib["viewBox"], "role": role, "aria-labelledby": f"{name}-caption"}
    return Markup(ElementTree.tostring(root, encoding="unicode"))


def _unwrap(parent: ElementTree.Element) -> None:
    """Replace groups without attributes by their content."""
    for child in parent:
        _unwrap(child)
    parent[:] = [item for child in parent for item in (child if child.tag == "g" and not child.attrib else [child])]


def relative(path: str) -> str:
    """A path of straight lines in relative coordinates, rounded to 0.1: half as long as the absolute ones."""
    tokens = path.split()
    if not set(tokens) & {"C", "Q"}:
        tokens = _steps(tokens)
    return " ".join(tokens)


def _steps(tokens: list[str]) -> list[str]:
    steps: list[str] = []
    point, start, place = (0, 0), (0, 0), 0
    while place < len(tokens):
        letter = tokens[place]
        if letter == "z":
            steps, point, place = [*steps, "z"], start, place + 1
            continue
        x, y = (round(10 * float(value)) for value in tokens[place + 1 : place + 3])
        steps.append(f"{letter.lower()}{(x - point[0]) / 10:g} {(y - point[1]) / 10:g}")
        point, place = (x, y), place + 3
        start = point if letter == "M" else start
    return steps


def _local(qualified: str) -> str:
    return qualified.rpartition("}")[2]


def _attribute(key: str, value: str, name: str) -> str:
    if key == "d":
        return relative(value)
    if key == "id":
        return f"{name}-{value}"
    if key == "style":
        value = re.sub(r"font-family:[^;]*;\s*|(?<=[:;]) ", "", value)
    elif key in ("x", "y", "width", "height", "transform"):
        value = _NUMBER.sub(lambda match: f"{round(float(match[0]), 1):g}", value)
    return _LINK.sub(f"{name}-", value)
