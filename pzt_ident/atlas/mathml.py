"""Equations as docstrings write them (`tau dx/dt + x = ratio (u - u(0))`) set as MathML."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator
from html import escape
from typing import NamedTuple

LETTERS = (
    """alpha beta gamma delta epsilon zeta eta theta kappa lambda mu nu xi pi rho sigma tau phi chi psi omega Phi"""
)
GREEK = dict(zip(re.findall(r"\w+", LETTERS), "αβγδεζηθκλμνξπρστφχψωΦ", strict=True))
FUNCTIONS = {
    "exp",
    "erfcx",
    "log",
    "log10",
    "ln",
    "sin",
    "cos",
    "tanh",
    "sinh",
    "sgn",
    "sign",
    "min",
    "max",
    "erf",
    "round",
}
RELATIONS = {"=": "=", "<-": "←", "<=": "≤", ">=": "≥", "<": "<", ">": ">", "~": "∼", "->": "→"}
LARGE = {"sum": "∑", "int": "∫"}
ENGLISH = set(re.findall(r"\w+", "an as at be by do if in is it no of on or so to up we"))
BREAK, LONG = "\u200b", 4  # a mark, and from how many terms a bracket has it between them
SIGNS = {"+": "+", "-": "−"}
CLOSING = {"(": ")", "[": "]"}
TOKEN = re.compile(
    r"(?P<space>\s*)(?:(?P<number>\d+(?:\.\d+)?(?:e-?\d+)?)|(?P<name>[A-Za-z][A-Za-z0-9]*(?:_[A-Za-z0-9]+)*(?:,[a-z]\b)?)"
    r"|(?P<sign>\.\.\.|<-|->|<=|>=|[-+*/^=<>~()\[\]|,']|_(?=[a-z])))"
)


class Token(NamedTuple):
    kind: str
    text: str
    spaced: bool
    end: int


class NoEquation(Exception):
    """The text at this place is no equation."""


def marked_up(text: str, symbols: Collection[str] = ()) -> str:
    """HTML of a text, its equations as MathML. symbols: words that are symbols, such as names of parameters."""
    return "".join(escape(part, quote=False) if plain else part for part, plain in _parts(text, symbols))


def lead_and_equation(text: str, symbols: Collection[str] = ()) -> tuple[str, str]:
    """HTML of a headline up to its first equation, and of the rest from there on; "" where there is none."""
    parts = list(_parts(text, symbols))
    first = next((place for place, (_, plain) in enumerate(parts) if not plain), len(parts))
    halves = parts[:first], parts[first:]
    lead, rest = ("".join(escape(part, quote=False) if plain else part for part, plain in half) for half in halves)
    return lead.rstrip(" :,"), rest.strip()


def _parts(text: str, symbols: Collection[str]) -> Iterator[tuple[str, bool]]:
    """The text in pieces: (text, True) and (MathML, False)."""
    text, written, place = " ".join(text.split()), 0, 0
    starts = [match.start() for match in re.finditer(r"(?<![\w.,'`/-])(?=[A-Za-z(|0-9\[])", text)]
    for place in starts:
        if place < written:
            continue
        try:
            pieces, end = _Parser(text, place, symbols).equation()
        except NoEquation:
            continue
        if written < place:
            yield text[written:place], True
        yield "<wbr>".join(f"<math>{part}</math>" for piece in pieces for part in _broken(piece)), False
        written = end
    if written < len(text):
        yield text[written:], True


def _broken(piece: str) -> list[str]:
    """At the marks where a line may break too, if they are inside of nothing."""
    parts = piece.split(BREAK)
    closed = all(part.count("</") + part.count("/>") == part.count("<") - part.count("</") for part in parts)
    return parts if closed else ["".join(parts)]


def symbol(name: str) -> str:
    """MathML of one name: `U_a`, `k12`, `tau`, `dEc`."""
    return f"<math>{_name(name)}</math>"


def _name(name: str) -> str:
    base, _, below = name.partition("_")
    if not below and (match := re.fullmatch(r"([A-Za-z]|" + "|".join(GREEK) + r")(\d+)", name)):
        base, below = match.groups()
    differential = re.fullmatch(r"d([a-zA-Z]|[A-Z]\w|" + "|".join(GREEK) + ")", base)
    markup = f'<mi mathvariant="normal">d</mi>{_letter(differential[1])}' if differential else _letter(base)
    markup = f"<mrow>{markup}</mrow>" if differential else markup
    index = _letter(below) if len(below) == 1 and below.isalpha() else f"<mtext>{escape(below)}</mtext>"
    return f"<msub>{markup}{index}</msub>" if below else markup


def _letter(base: str) -> str:
    return f"<mi>{GREEK.get(base, base)}</mi>"


class _Parser:
    """Recursive descent from one place of a text; `equation` takes what it can and says where it ended."""

    def __init__(self, text: str, place: int, symbols: Collection[str]) -> None:
        self.text, self.place, self.symbols = text, place, symbols
        self.first, self.bars = place, 0

    def equation(self) -> tuple[list[str], int]:
        """In pieces between which a line may break, each with the sign before it; and where it ended."""
        pieces, relations = self.terms(), 0
        end = self.place
        while (token := self.peek()) and token.text in RELATIONS:
            try:
                self.take()
                first, *others = self.terms()
            except NoEquation:
                break
            pieces += [f'<mo form="infix">{escape(RELATIONS[token.text])}</mo>{first}', *others]
            relations, end = relations + 1, self.place
        if not relations:
            raise NoEquation
        return pieces, end

    def peek(self) -> Token | None:
        match = TOKEN.match(self.text, self.place)
        if not match:
            return None
        kind = str(match.lastgroup)
        return Token(kind, match[kind], bool(match["space"]), match.end())

    def take(self, text: str = "") -> Token:
        token = self.peek()
        if token is None or (text and token.text != text):
            raise NoEquation
        self.place = token.end
        return token

    def sum(self) -> str:
        return "".join(self.terms())

    def terms(self) -> list[str]:
        token, sign = self.peek(), ""
        if token and token.text in SIGNS:
            sign = f"<mo>{SIGNS[self.take().text]}</mo>"
        terms = [sign + self.product()]
        while (token := self.peek()) and token.text in SIGNS:
            before = self.place
            try:
                self.take()
                terms.append(f'<mo form="infix">{SIGNS[token.text]}</mo>{self.product()}')
            except NoEquation:
                self.place = before
                break
        return terms

    def product(self) -> str:
        factors = [self.factor()]
        while token := self.peek():
            before = self.place
            try:
                if token.text in ("/", "*"):
                    self.take()
                    other = self.factor()
                    factors[-1] = (
                        f"<mfrac>{_bare(factors[-1])}{_bare(other)}</mfrac>"
                        if token.text == "/"
                        else f"{factors[-1]}<mo>⋅</mo>{other}"
                    )
                elif token.spaced and (token.kind != "sign" or token.text in ("(", "[", "|")):
                    factors.append(self.factor())
                else:
                    break
            except NoEquation:
                self.place = before
                break
        return '<mspace width="0.17em"/>'.join(factors)

    def factor(self) -> str:
        base = self.base()
        primes = ""
        while (token := self.peek()) and token.text == "'" and not token.spaced:
            self.take()
            primes += "′"
        if primes:
            base = f"<msup>{base}<mo>{primes}</mo></msup>"
        if (token := self.peek()) and token.text == "_" and not token.spaced:
            self.take()
            base = f"<msub>{base}{_letter(self.take().text)}</msub>"
        if (token := self.peek()) and token.text == "^" and not token.spaced:
            self.take()
            base = f"<msup>{base}{_bare(self.signed())}</msup>"
        return base

    def signed(self) -> str:
        if (token := self.peek()) and token.text == "-":
            self.take()
            return f"<mrow><mo>−</mo>{self.base()}</mrow>"
        return self.base()

    def base(self) -> str:
        token = self.take()
        if token.kind == "number":
            return f"<mn>{token.text}</mn>"
        if token.text == "...":
            return "<mo>…</mo>"
        if token.text in CLOSING and token.kind == "sign":
            return self.group(token.text)
        if token.text == "|" and not self.bars:
            self.bars += 1
            inside = self.sum()
            self.take("|")
            self.bars -= 1
            return f"<mrow><mo>|</mo>{inside}<mo>|</mo></mrow>"
        if token.kind != "name" or not self.is_symbol(token.text):
            raise NoEquation
        return self.applied(token.text)

    def applied(self, name: str) -> str:
        """A name, with the arguments that follow it without a space: `exp(-t / tau)`, `F_i[u]`."""
        head, _, below = name.partition("_")
        if head in LARGE:
            return self.large(LARGE[head], below)
        token = self.peek()
        follows = bool(token and token.text in CLOSING and not token.spaced)
        if name == "sqrt":
            return f"<msqrt>{_bare(self.factor())}</msqrt>"
        markup = f'<mi mathvariant="normal">{name}</mi>' if name in FUNCTIONS else _name(name)
        if name in self.symbols and "_" in name and not re.fullmatch(r".*_\d+", name):
            markup = f"<mi>{name.replace('_', ' ')}</mi>"
        return f"<mrow>{markup}<mo>&#x2061;</mo>{self.group(self.take().text)}</mrow>" if follows else markup

    def large(self, sign: str, below: str) -> str:
        above = ""
        if (token := self.peek()) and token.text == "^" and not token.spaced:
            self.take()
            above = _letter(self.take().text)
        index = (f"<mn>{below}</mn>" if below.isdigit() else _letter(below)) if below else ""
        if above:
            return f"<munderover><mo>{sign}</mo>{index or '<mrow/>'}{above}</munderover>"
        return f"<munder><mo>{sign}</mo>{index}</munder>" if index else f"<mo>{sign}</mo>"

    def group(self, opening: str) -> str:
        bars, self.bars = self.bars, 0
        first = self.terms()
        parts = [BREAK.join(first) if len(first) >= LONG else "".join(first) + self.relations()]
        while (token := self.peek()) and token.text == ",":
            self.take()
            parts.append(self.sum() + self.relations())
        self.take(CLOSING[opening])
        self.bars = bars
        inside = "<mo>,</mo>".join(parts)
        still = "" if "<mfrac" in inside else ' stretchy="false"'
        left, right = (f"<mo{still}>{sign}</mo>" for sign in (opening, CLOSING[opening]))
        return f"{left}{inside}{right}" if BREAK in inside else f'<mrow class="group">{left}{inside}{right}</mrow>'

    def relations(self) -> str:
        markup = ""
        while (token := self.peek()) and token.text in RELATIONS:
            self.take()
            markup += f"<mo>{escape(RELATIONS[token.text])}</mo>{self.sum()}"
        return markup

    def is_symbol(self, name: str) -> bool:
        head = name.partition("_")[0]
        if name.lower() in ENGLISH or (name.lower() == "a" and self.place - 1 == self.first):
            return False
        known = name in self.symbols or head in self.symbols or head in GREEK or name in FUNCTIONS or name == "sqrt"
        return (
            known or head in LARGE or len(head) <= 2 or bool(re.fullmatch(r"[A-Za-z]{1,3}\d+|d[A-Z]\w|[A-Z]{3,}", head))
        )


def _bare(markup: str) -> str:
    """Without the parentheses of a group, for what a fraction bar, root or exponent already holds together."""
    group = re.fullmatch(r'<mrow class="group"><mo[^>]*>\(</mo>(.*)<mo[^>]*>\)</mo></mrow>', markup)
    return f"<mrow>{group[1] if group and _balanced(group[1]) else markup}</mrow>"


def _balanced(inner: str) -> bool:
    depth = 0
    for tag in re.findall(r"<mrow[^>/]*>|</mrow>", inner):
        depth += 1 if tag != "</mrow>" else -1
        if depth < 0:
            return False
    return depth == 0
