"""The page: what you see, the index of words, a section for each word, and the manual."""

from __future__ import annotations

from collections.abc import Iterator
from importlib.resources import files
from itertools import groupby
from pathlib import Path
from typing import Any

from pzt_ident.atlas.drawing import thumbnail
from pzt_ident.atlas.href import anchor, href
from pzt_ident.atlas.kept import keep, kept
from pzt_ident.atlas.manual import chapters
from pzt_ident.atlas.pictures import MAIN, STRIP
from pzt_ident.atlas.symptoms import table
from pzt_ident.atlas.words import SEARCH, Word, every_word
from pzt_ident.files import write_text
from pzt_ident.run.computing import computing

FOLDER = files("pzt_ident.atlas")


def write_atlas(path: Path) -> Path:
    """Write the atlas of all words that are registered, and the manual, as one page that needs no network."""
    place = kept()
    if place and place.exists():
        page = place.read_text(encoding="utf-8")
    else:
        with computing():
            page = atlas()
        if place:
            keep(page, place)
    write_text(path, page)
    return path


def drawn() -> Iterator[str]:
    """Each word, as its pictures are drawn for the page; none where the page is kept."""
    place = kept()
    for word in () if place and place.exists() else every_word():
        assert word.pictures
        yield word.word


def atlas() -> str:
    """The page as HTML."""
    words = every_word()
    groups = [(title, list(group)) for title, group in groupby(sorted(words, key=_by_group(words)), lambda w: w.group)]
    return _template("atlas.html").render(
        css=_text("atlas.css"),
        script=_text("atlas.js"),
        groups=groups,
        symptoms=[row for row in table() if row[1]],
        chapters=chapters(),
        anchor=anchor,
        href=lambda item: href(item, ""),
        thumbnail=_thumbnail,
    )


def _by_group(words: list[Word]) -> Any:
    """As the signal flows."""
    titles = list(dict.fromkeys(word.group for word in words))
    return lambda word: titles.index(word.group)


def _thumbnail(word: Word) -> str:
    name, styles = word.clearest
    return thumbnail(name, styles, MAIN + STRIP if word.group == SEARCH else MAIN)


def _text(name: str) -> str:
    return FOLDER.joinpath(name).read_text(encoding="utf-8")


def _template(name: str) -> Any:
    from jinja2 import Environment, FunctionLoader, StrictUndefined

    return Environment(
        loader=FunctionLoader(_text), trim_blocks=True, lstrip_blocks=True, undefined=StrictUndefined
    ).from_string(_text(name))
