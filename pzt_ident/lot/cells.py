"""What the cells of a column are: numbers, dates or words."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from typing import NamedTuple

from pzt_ident.data.formats._layout import GAPS
from pzt_ident.data.notation import listed
from pzt_ident.lot.dates import is_date

Value = float | int | str | None
MISSING = GAPS | {"\N{EN DASH}", "\N{EM DASH}", "?"}
WORDS = {"none"}  # missing among numbers and dates, and a word among words
NUMBER = re.compile(r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)(e[+-]?[0-9]+)?", re.IGNORECASE)
WHOLE = re.compile(r"[+-]?[0-9]+")
IDENTIFIER = re.compile(r"[+-]?(0[0-9]+|[0-9]{16,})")
MOST_CELLS = 3  # that a sentence names
REMEDIES = {
    "number": "Write numbers alone, as 23.5, or leave the cells empty",
    "date": "Write dates as 2026-03-02 or 02.03.2026, or leave the cells empty",
}


class Odd(NamedTuple):
    """The cells that make words of a column of which most are of a kind, a number or a date. places: of which cells."""

    kind: str
    places: list[int]
    cells: list[str]

    def sentence(self, heading: str, names: Sequence[str]) -> str:
        """Why the column with this heading is one of words. names: of the rows, all of them."""
        some = [f"{cell!r} ({names[place]})" for place, cell in zip(self.places, self.cells, strict=True)][:MOST_CELLS]
        more = [f"{len(self.cells) - MOST_CELLS} more"] * (len(self.cells) > MOST_CELLS)
        verb = f"is no {self.kind}" if len(self.cells) == 1 else f"are no {self.kind}s"
        return f"{listed([*some, *more])} under {heading!r} {verb}, as most others are: the column is taken as words"

    @property
    def remedy(self) -> str:
        return REMEDIES[self.kind]


def values_of(cells: Sequence[str], decimal: str = ".") -> list[Value]:
    """The cells of a column: numbers where all that are not missing are such, whole ones as such, else words, as they
    are written. decimal: the signs that part decimals. Numbers of 16 digits or with a leading zero are words: they
    count nothing."""
    texts = [cell.strip() for cell in cells]
    known = [text for text in texts if text.lower() not in MISSING]
    if known and all(_is_number(text, decimal) for text in known):
        kind = int if all(map(WHOLE.fullmatch, map(_plain, known))) else float
        return [None if text.lower() in MISSING else kind(_plain(text)) for text in texts]
    words = MISSING if known and all(map(is_date, known)) else MISSING - WORDS
    return [None if text.lower() in words else text for text in texts]


def odd_cells(cells: Sequence[str], decimal: str = ".") -> Odd | None:
    """The cells that keep a column from being one of numbers or of dates, where most are; None where there are none.
    Numbers that count nothing are none that were meant to."""
    known = {place: text for place, cell in enumerate(cells) if (text := cell.strip()).lower() not in MISSING}
    kinds: dict[str, Callable[[str], bool]] = {"number": lambda text: _is_number(text, decimal), "date": is_date}
    for kind, is_one in kinds.items():
        odd = [place for place, text in known.items() if not is_one(text)]
        if 0 < 2 * len(odd) < len(known) and not any(IDENTIFIER.fullmatch(known[place]) for place in odd):
            return Odd(kind, odd, [known[place] for place in odd])
    return None


def _is_number(text: str, decimal: str) -> bool:
    plain = _plain(text, decimal)
    return bool(NUMBER.fullmatch(plain)) and not IDENTIFIER.fullmatch(plain) and math.isfinite(float(plain))


def _plain(text: str, decimal: str = ".,") -> str:
    """A number as a program writes it."""
    text = text.replace("\N{MINUS SIGN}", "-")
    return text.replace(",", ".") if "," in decimal else text
