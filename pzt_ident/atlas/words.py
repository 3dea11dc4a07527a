"""The section of each word, from its declaration: equation, sources, forms, parameters, look-alikes, remedy."""

from __future__ import annotations

import inspect
import re
import sys
from collections.abc import Collection, Iterable
from functools import cached_property
from html import escape
from itertools import groupby
from typing import Any, NamedTuple

from pzt_ident.atlas.href import href
from pzt_ident.atlas.look_alikes import LookAlike, look_alikes
from pzt_ident.atlas.mathml import GREEK, lead_and_equation, marked_up, symbol
from pzt_ident.atlas.pictures import STYLES, Picture, pictures, small_pictures
from pzt_ident.atlas.search_pictures import search_pictures
from pzt_ident.atlas.shown import shown
from pzt_ident.data.notation import ranges, short, unit
from pzt_ident.model.block import Place, Term
from pzt_ident.model.description import description_of, headline, same_equation
from pzt_ident.model.registry import blocks, optimizers, word_of

FROM_PLACE = {
    Place.DELAY: "Amplifier: from the command to the voltage",
    Place.READOUT: "Actuator: what the voltage does beside its hysteresis",
    Place.OPERATOR: "Hysteresis: the operator and what acts in its equation",
    Place.STATIC: "Actuator: what comes behind the hysteresis",
    Place.COUPLING: "Mechanics: from force to displacement",
    Place.OUTPUT: "Sensor: from the displacement to the reading",
}
"""Groups of words, each from a place in the signal chain on."""
SEEN = 0.02  # least change that a small picture shows
SEARCH = "Optimizers: how the parameters are found"


class Form(NamedTuple):
    """An effect in one of its forms: as a job has it, what it is, which parameters at which value are nothing, and the
    form at work at the values that are shown."""

    item: str
    lead: str
    equation: str
    more: list[str]
    null: str
    pictures: list[Picture]
    values: str


class Word:
    """What the atlas says of a word."""

    def __init__(self, word: str) -> None:
        self.word = word
        self.facts = description_of(word)
        self.effect = self.facts["kind"] == "effects"
        self.kind = {"effects": "effect", "hysteresis": "hysteresis operator"}.get(
            self.facts["kind"], self.facts["kind"]
        )

    @cached_property
    def group(self) -> str:
        if self.word not in blocks:
            return SEARCH
        return [title for place, title in FROM_PLACE.items() if place <= self.place][-1]

    @cached_property
    def place(self) -> Place:
        """In the signal chain; of a term, that of the block in whose equation it acts."""
        block = blocks[self.word]
        holders = [holder for holder in blocks if holder.holds(block)] if issubclass(block, Term) else [block]
        return min(holder.place for holder in holders)

    @property
    def headline(self) -> str:
        """What it is, in a few words: the docstring of its file, or else the beginning of its own."""
        subject = blocks[self.word] if self.word in blocks else optimizers[self.word]
        file = inspect.getdoc(sys.modules[subject.__module__]) or ""
        return escape(file.partition("\n\n")[0], quote=False) or lead_and_equation(headline(subject), self.symbols)[0]

    @cached_property
    def symbols(self) -> set[str]:
        names = {row["name"].partition(".")[2] or row["name"] for row in self.facts.get("parameters", ())}
        names |= {row["name"] for row in self.facts.get("settings", ())}
        return names | {re.sub(r"_\d+$", "", name) for name in names}

    @cached_property
    def texts(self) -> tuple[str, str, list[str]]:
        return texts_of(self.facts["doc"], self.symbols)

    @property
    def source(self) -> str:
        return cited(escape(self.facts.get("source", ""), quote=False))

    @cached_property
    def forms(self) -> list[Form]:
        items = blocks.forms(self.word) if self.effect else []
        return [self._form(item) for item in items] if len(items) > 1 else []

    def _form(self, item: str) -> Form:
        paragraphs = [inspect.getdoc(blocks[item]) or "", *same_equation(item)]
        lead, equation, more = texts_of("\n\n".join(paragraphs), self.symbols)
        return Form(item, lead, equation, more, ", ".join(nulls(item)), small_pictures(item), values(item))

    @property
    def null(self) -> str:
        return ", ".join(nulls(self.word)) if self.effect else ""

    @property
    def parameters(self) -> list[dict[str, Any]]:
        rows = grouped(self.facts.get("parameters", ()))
        return [
            row
            | {"symbol": self.symbol_of(row), "unit": unit(row["unit"]) or "1"}
            | {"bounds": "{} to {}".format(*map(short, row["bounds"]))}
            for row in rows
        ]

    def symbol_of(self, row: dict[str, Any]) -> str:
        """As the equation has it: the name itself, or what the description ends with, as in `..., d.`."""
        name = re.sub(r"_\d+( .*)?$", "", row["name"].partition(".")[2] or row["name"])
        doc = self.facts["doc"]
        last = re.search(r", ([A-Za-z][\w ]{0,9}(?: / [\w ]+)?)\.$", row["doc"])
        if last and all(re.search(rf"\b{part}", doc) for part in re.findall(r"\w+", last[1])):
            return " ".join(symbol(part) if part.isidentifier() else part for part in last[1].split())
        return symbol(name) if name in GREEK and re.search(rf"\b{name}(?:\b|_)", doc) else ""

    @property
    def settings(self) -> list[dict[str, Any]]:
        rows = self.facts.get("settings", ())
        return [
            row
            | {
                "allowed": " or ".join(row["words"])
                if "words" in row
                else "{} to {}".format(*map(short, row["bounds"]))
            }
            for row in rows
        ]

    @cached_property
    def pictures(self) -> list[Picture]:
        return pictures(self.word) if self.word in blocks else search_pictures(self.word)

    @property
    def clearest(self) -> tuple[str, tuple[str, ...]]:
        """Name and curves of the picture for the index: the first one in which the word shows."""
        seen = [picture for picture in self.pictures if picture.change >= SEEN]
        return (seen or self.pictures)[0].name, STYLES if self.word in blocks else ("bare", "dots")

    @property
    def values(self) -> str:
        return values(self.word)

    @property
    def look_alikes(self) -> list[LookAlike]:
        return look_alikes(self.word) if self.effect else []


def every_word() -> list[Word]:
    """In the order in which the signal flows, then the optimizers."""
    in_chain = sorted((Word(word) for word in blocks.usable()), key=lambda word: (word.place, word.effect, word.word))
    return in_chain + [Word(word) for word in optimizers.usable()]


def texts_of(doc: str, symbols: Collection[str]) -> tuple[str, str, list[str]]:
    """Lead, equation and the other paragraphs of a docstring, as HTML."""
    first, *others = doc.split("\n\n")
    lead, equation = lead_and_equation(first, symbols)
    paragraphs = [linked(cited(marked_up(text, symbols))) for text in others]
    return linked(lead), linked(equation), paragraphs


def linked(html: str) -> str:
    """Words in backticks as code, those of the registry as links to their sections."""

    def code(match: re.Match[str]) -> str:
        text = f"<code>{match[1]}</code>"
        registered = word_of(match[1]) in blocks or match[1] in optimizers
        return f'<a href="{href(match[1], "")}">{text}</a>' if registered else text

    return re.sub(r"`([^`<]+)`", code, html)


def cited(html: str) -> str:
    """Authors with their year marked as what is cited."""
    particle = r"(?:(?:de|del|der|van|von) )?"
    name = rf"{particle}[A-Z][\w'’-]+(?: {particle}[A-Z][\w-]+)*"
    authors = rf"{name}(?:, {name})*(?: &amp; {name}| et al\.)?"
    return re.sub(rf"({authors}(?:, Model Development[^,.]*| \(\d{{4}}\)))", r"<cite>\1</cite>", html)


def values(item: str) -> str:
    """At which an item is shown."""
    parameters: dict[tuple[str, str], list[str]] = {}
    for shown_value in shown(item).values:
        name, value = shown_value.name.partition(".")[2], f"{short(shown_value.value, 3)} {unit(shown_value.unit)}"
        parameters.setdefault((re.sub(r"_\d+$", "", name), value.rstrip()), []).append(name)
    return ", ".join(f"{name} = {value}" for (_, value), names in parameters.items() for name in ranges(names))


def nulls(item: str) -> list[str]:
    """The parameters of an effect, in a form, and the value of each at which the effect is not there."""
    block = blocks[item]
    of_host = [
        (word, declared)
        for host in blocks
        for word, declared in host.parameters().items()
        if {block.name, block.item()} & {*declared.effects} and declared.null is not None and declared.scale != "log"
    ]
    of_block = [(word, declared) for word, declared in block.parameters().items() if declared.null is not None]
    values = {re.sub(r"_\d+$", "", word) if d.count else word: d.null for word, d in of_block or of_host}
    return [f"{word} = {null:g}" for word, null in values.items() if null is not None]


def grouped(rows: Iterable[dict[str, Any]]) -> list[dict[str, Any]]:
    """Rows of parameters, those that differ by their number alone as one."""
    groups = groupby(rows, lambda row: {key: value for key, value in row.items() if key != "name"})
    return [facts | {"name": name} for facts, group in groups for name in ranges(row["name"] for row in group)]
