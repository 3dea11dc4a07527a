"""From an SVG file to an element of an HTML page."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING
from xml.etree import ElementTree

if TYPE_CHECKING:
    from markupsafe import Markup

_NUMBER = re.compile(r"-?\d+\.\d+")
_UNTURNED = re.compile(r"rotate\(-?0 ")
_LINK = re.compile(r"(?<=url\(#)|(?<=^#)")


def inline(svg: bytes, name: str) -> Markup:
    """The drawing alone, a tenth of a point fine, in the page's type; its ids start with `name`, so that no two
    figures of a page share one. It is labelled by the element with the id `<name>-caption`."""
    from markupsafe import Markup

    root = ElementTree.fromstring(svg)
    for parent in list(root.iter()):
        for child in [child for child in parent if _local(child.tag) in ("metadata", "style")]:
            parent.remove(child)
    for element in root.iter():
        element.tag = _local(element.tag)
        element.attrib = {
            _local(key): _attribute(_local(key), value, name)
            for key, value in element.attrib.items()
            if not ((key == "id" and element.tag == "g") or _UNTURNED.match(value))
        }
        element.text, element.tail = (text and (text.strip() or None) for text in (element.text, element.tail))
    _unwrap(root)
    root.attrib = {"viewBox": root.attrib["viewBox"], "role": "img", "aria-labelledby": f"{name}-caption"}
    return Markup(ElementTree.tostring(root, encoding="unicode"))


def _unwrap(parent: ElementTree.Element) -> None:
    """Put the content of groups that say nothing in their place."""
    for child in parent:
        _unwrap(child)
    parent[:] = [item for child in parent for item in (child if child.tag == "g" and not child.attrib else [child])]


def relative(path: str) -> str:
    """A path of straight lines as steps from point to point, in tenths: half as long as its coordinates."""
    points = path.split()
    if not set(points) & {"C", "Q"}:
        points = _steps(points)
    return " ".join(points)


def _steps(points: list[str]) -> list[str]:
    said: list[str] = []
    at, start, place = (0, 0), (0, 0), 0
    while place < len(points):
        letter = points[place]
        if letter == "z":
            said, at, place = [*said, "z"], start, place + 1
            continue
        x, y = (round(10 * float(value)) for value in points[place + 1 : place + 3])
        said.append(f"{letter.lower()}{(x - at[0]) / 10:g} {(y - at[1]) / 10:g}")
        at, place = (x, y), place + 3
        start = at if letter == "M" else start
    return said


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
