"""The errors whose message is all that a user needs."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable


class InputError(ValueError):
    """Something the user gave is wrong; the message says what and where, the remedy what to do about it.

    The command line prints both and ends with exit code 2, without a traceback.
    """

    def __init__(self, message: str, *, where: str = "", remedy: str = "") -> None:
        self.message, self.where, self.remedy = message, where, remedy
        super().__init__(": ".join(part for part in (where, message) if part) + (f"\n  {remedy}" if remedy else ""))


class RunError(RuntimeError):
    """A run came to nothing though its input is in order. The command line prints the message and ends with exit code
    1, without a traceback."""


class DamagedError(InputError):
    """A file of results that is not as it was written."""


class LostError(RunError):
    """The place where a run's tasks ran is gone; what was done is on the disk, and the run can be resumed."""


def nearest(word: str, words: Iterable[str]) -> str:
    """A remedy for an unknown word: the nearest known ones, else all of them."""
    known = sorted(set(words))
    close = difflib.get_close_matches(word, known, n=3, cutoff=0.5)
    if close:
        return "did you mean " + " or ".join(repr(item) for item in close) + "?"
    return "known: " + ", ".join(known)


UNPRINTABLE = re.compile(r"[\x00-\x1f\x7f-\x9f\u2028-\u202e\u2066-\u2069\ud800-\udfff]")


def printable(text: str) -> str:
    """The text with what no terminal, table or page should get as an escape: control characters, ends of lines, changes
    of the direction of writing, and bytes that are no UTF-8."""
    return UNPRINTABLE.sub(lambda match: match[0].encode("unicode_escape").decode(), text)


FOR_PROGRAMMERS = re.compile(r"\b[A-Z]\w*(Error|Exception)\b|\b0x[0-9a-f]+|[<>]|::|\bdtype\b|\bNoneType\b")


def in_words(error: Exception) -> str:
    """The first line of what another library said of a file, unless it is for programmers."""
    said = str(error).strip().partition("\n")[0]
    return said if said.isprintable() and said and not FOR_PROGRAMMERS.search(said) else "it is damaged"
