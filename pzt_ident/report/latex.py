"""Tables in LaTeX (booktabs)."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Mapping, Sequence

SENTENCE = 45  # letters; a column with longer cells is broken into lines


def tabular(text: Mapping[str, Sequence[str]], words: Collection[str]) -> str:
    r"""A `tabular` of the columns `text`, those in `words` flush left, for `\input`; needs `\usepackage{booktabs}`."""
    align = "".join(_alignment(text[column]) if column in words else "r" for column in text)
    body = map(_row, zip(*text.values(), strict=True))
    lines = [rf"\begin{{tabular}}{{{align}}}", r"\toprule", _row(text), r"\midrule", *body]
    return "\n".join([*lines, r"\bottomrule", r"\end{tabular}", ""])


def _alignment(column: Sequence[str]) -> str:
    """A paragraph column for sentences, else flush left."""
    return "p{60mm}" if max(map(len, column), default=0) > SENTENCE else "l"


def escaped(text: str) -> str:
    """`text` with LaTeX's special characters escaped, and superscripts and mathematical signs in math mode."""
    text = re.sub(r"[\\{}&%$#_~^<>|]", lambda match: _SPECIAL[match[0]], text)
    text = re.sub(r"[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+", lambda match: f"$^{{{match[0].translate(_DIGITS)}}}$", text)
    return re.sub("|".join(_SIGNS), lambda match: _SIGNS[match[0]], text)


_SPECIAL = {character: f"\\{character}" for character in "{}&%$#_"} | {
    "\\": r"\textbackslash{}",
    "~": r"\textasciitilde{}",
    "^": r"\textasciicircum{}",
    "<": r"\textless{}",
    ">": r"\textgreater{}",
    "|": r"\textbar{}",
}
_SIGNS = {
    " × ": r" $\times$ ",
    "±": r"$\pm$",
    "−": "$-$",
    "∞": r"$\infty$",
    "·": r"$\cdot$",
    "–": "--",
    "µ": r"\textmu{}",
    "\u03bc": r"\textmu{}",
    "\u202f": r"\,",
    "\u00a0": "~",
}
_DIGITS = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")


def _row(cells: Iterable[str]) -> str:
    return " & ".join(map(escaped, cells)) + r" \\"
