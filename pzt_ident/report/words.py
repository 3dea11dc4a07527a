"""The blocks and effects that a report names: links to what the page says of each, made of its declaration."""

from __future__ import annotations

import os
import re
from collections.abc import Collection, Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import quote

from pzt_ident.atlas.href import PAGE, anchor
from pzt_ident.atlas.words import Word
from pzt_ident.model.registry import blocks
from pzt_ident.report.tables import Table

if TYPE_CHECKING:
    from markupsafe import Markup

COLUMNS = ("effect", "indistinguishable from", "parameter", "step", "supported by the data", "effects added")
"""Headings of the columns of tables whose words are linked."""
CODE = re.compile("`([^`]+)`")
NAME = re.compile(r"[A-Za-z]\w*(?:\.\w+)*")  # a word, or one with its form, its parameter or its axis


def named(sentences: Iterable[str], tables: Mapping[str, Table]) -> list[Word]:
    """The blocks and effects in sentences and in columns of tables, in alphabetical order; those that are registered
    here."""
    cells = [
        cell for table in tables.values() for column in COLUMNS if column in table.text for cell in table.text[column]
    ]
    names = [name for text in [*sentences, *cells] for name in NAME.findall(text)]
    return [Word(word) for word in blocks.usable({part for name in names for part in name.split(".")})]


def linked(text: str, words: Collection[Word]) -> Markup:
    """A text in which what belongs to one of these words is the link to it."""
    from markupsafe import Markup, escape

    names = {word.word for word in words}

    def link(match: re.Match[str]) -> str:
        word = next((part for part in match[0].split(".") if part in names), None)
        return f'<a href="#{anchor(word)}">{match[0]}</a>' if word else match[0]

    parts = re.split(f"({NAME.pattern})", text)
    return coded(
        Markup("".join(NAME.sub(link, part) if place % 2 else escape(part) for place, part in enumerate(parts)))
    )


def coded(text: str) -> Markup:
    """A text, or one with markup, in which what stands between backticks is code."""
    from markupsafe import Markup, escape

    return Markup(CODE.sub(r"<code>\1</code>", str(escape(text))))


def place_of(text: str, words: Collection[Word]) -> str:
    """The link to the section of the first word in a text; empty where there is none."""
    names = {word.word for word in words}
    parts = (part for name in NAME.findall(text) for part in name.split("."))
    return next((f"#{anchor(part)}" for part in parts if part in names), "")


def atlas_beside(folder: Path) -> str:
    """The atlas that lies in the folder of a page or, up to the working folder, above it, as a link; empty where there
    is none."""
    folder, here = folder.resolve(), Path.cwd()
    within = [place for place in (folder, *folder.parents) if place == folder or place.is_relative_to(here)]
    found = next((place / PAGE for place in within if (place / PAGE).is_file()), None)
    return quote(os.path.relpath(found, folder)) if found else ""


def without_links(html: str) -> Markup:
    """Of the atlas, whose other sections are not on the page."""
    from markupsafe import Markup

    return Markup(re.sub(r"</?a\b[^>]*>", "", html))
