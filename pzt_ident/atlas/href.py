"""Where in the atlas a word is."""

from __future__ import annotations

from pzt_ident.model.registry import blocks, word_of

PAGE = "atlas.html"


def href(item: str, page: str = PAGE) -> str:
    """The link to a word, or to an effect in a form (`creep.voltage`): `atlas.html#word-creep`."""
    return f"{page}#{anchor(item)}"


def anchor(item: str) -> str:
    """The id of the section of a word, or of what that says of a form; a parameter is in the section of its block."""
    word = word_of(item)
    forms = blocks.forms(word) if word in blocks else [word]
    return f"word-{item if item in forms else word}"
