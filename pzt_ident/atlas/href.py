"""Where in the atlas a word is."""

from __future__ import annotations

from pzt_ident.model.registry import word_of

PAGE = "atlas.html"


def href(item: str, page: str = PAGE) -> str:
    """The link to the section of a word, or of an effect in a form (`creep.voltage`): `atlas.html#creep`."""
    return f"{page}#{anchor(item)}"


def anchor(item: str) -> str:
    """The id of a word's section; a form is in the section of its word."""
    return f"word-{word_of(item)}"
