"""Descriptions of the words that a job may use, from the declarations of blocks, effects and optimizers."""

from __future__ import annotations

import inspect
import re
import sys
from collections.abc import Iterable
from dataclasses import asdict, fields
from typing import Any

from pzt_ident.data.notation import either, listed
from pzt_ident.errors import InputError, nearest
from pzt_ident.model.block import Term
from pzt_ident.model.parameter import Form, Setting
from pzt_ident.model.registry import blocks, optimizers, word_of

Facts = dict[str, Any]

FEW = 4  # descriptions that speak of a word: where more do, it is a common one


def words(kind: str) -> dict[str, str]:
    """The words of a kind (`blocks`, `effects` or `optimizers`) with the headlines of their docstrings, effects in the
    order of the alphabet."""
    if kind == "optimizers":
        return {item.name: headline(item) for item in optimizers}
    headlines = {item.name: _listed(item) for item in blocks if blocks.is_effect(item.name) == (kind == "effects")}
    return dict(sorted((_terms() | headlines).items())) if kind == "effects" else headlines


def _terms() -> dict[str, str]:
    """Effects that are terms in the equations of other blocks, with the names of those blocks."""
    owners: dict[str, list[str]] = {}
    for block in blocks:
        for effect in block.effects():
            if effect not in blocks or blocks.is_effect(effect):
                owners.setdefault(effect, []).append(block.name)
    return {effect: "a term of " + ", ".join(names) for effect, names in sorted(owners.items())}


def headline(item: type) -> str:
    """The beginning of a docstring in one line: down to the first line that ends with a full stop."""
    paragraph = (inspect.getdoc(item) or "").partition("\n\n")[0].splitlines()
    end = next((place for place, line in enumerate(paragraph, start=1) if line.endswith(".")), len(paragraph))
    return " ".join(line.strip() for line in paragraph[:end])


def _listed(block: type[Any]) -> str:
    """The headline of a block, and that it is a fault of the set-up."""
    return f"{headline(block)} A fault of the set-up: told, never added." if block.in_setup else headline(block)


def form_headline(effect: str) -> str:
    """The headline of an effect in one of its forms, and that of which it is the equation."""
    return " ".join([headline(blocks[effect]), *same_equation(effect)])


def same_equation(effect: str) -> list[str]:
    """The sentence that says of which form of another effect this one is the equation; none where it is of none."""
    other = blocks[effect].equation_of
    return [f"It is the equation of `{other}`, which is named where both fit."] if other else []


def summary(item: type) -> str:
    """What a block or optimizer is, in a few words: the first paragraph of its file, else its own headline."""
    file = inspect.getdoc(sys.modules[item.__module__]) or ""
    return " ".join(file.partition("\n\n")[0].split()) or headline(item)


def is_word(name: str) -> bool:
    """Whether a name is that of a block, effect, optimizer or parameter."""
    return word_of(name) in blocks or name in optimizers or name in _terms()


def meant(name: str, known: Iterable[str]) -> str:
    """A remedy for an unknown word: the few parameters of this name, the few blocks that speak of it, or the nearest
    known words."""
    whole = re.compile(rf"\b{re.escape(name)}\b", re.IGNORECASE)
    declared = {block.name: _variants(block).values() for block in blocks}
    owners = [word for word, forms in declared.items() if any(name in parameters for parameters in forms)]
    spoken = [word for word in blocks.words() if whole.search(inspect.getdoc(blocks[word]) or "")]
    if 0 < len(owners) <= FEW:
        return f"did you mean {' or '.join(f'{word}.{name}' for word in owners)}?"
    if 0 < len(spoken) <= FEW:
        return f"{listed(spoken)} {'speaks' if len(spoken) == 1 else 'speak'} of it"
    return nearest(name, known)


def description_of(name: str) -> Facts:
    """What a block, effect, optimizer or parameter declares. Raises InputError for an unknown one, with what may be
    meant."""
    word, _, last = name.rpartition(".")
    is_form = word in blocks and blocks.is_effect(word) and name in blocks.forms(word)
    if word in blocks and not is_form and last in {row["name"] for row in _parameters(blocks[word])}:
        rows = [row for row in _parameters(blocks[word]) if row["name"] == last]
        return {"name": name, "kind": "parameter", "doc": headline(blocks[word]), "parameters": rows}
    if word_of(name) in blocks:
        return _block(name)
    if name in optimizers:
        return _optimizer(name)
    terms = _terms()
    if name in terms:
        return {"name": name, "kind": "effect", "doc": terms[name], "parameters": _parameters_of_effect(name)}
    raise InputError(f"unknown word {name!r}", remedy=meant(name, [*blocks.words(), *optimizers.words(), *terms]))


def _parameters_of_effect(effect: str) -> list[Facts]:
    """The parameters of all blocks that belong to an effect."""
    rows = [row | {"name": f"{block.name}.{row['name']}"} for block in blocks for row in _parameters(block)]
    return [row for row in rows if effect in map(word_of, row["effects"])]


def _block(name: str) -> Facts:
    block, kind = blocks[name], blocks.kind_of(word_of(name))
    facts: Facts = {"name": name, "kind": kind, "doc": inspect.getdoc(block)}
    if kind == "effects":
        facts |= {"look_alikes": _look_alikes(block)} | {key: getattr(block, key) for key in ("separate_by", "remedy")}
        facts["forms"] = [
            {"item": item, "place": place_of(item), "doc": form_headline(item)} for item in blocks.forms(name)
        ]
    rows = _parameters(block) + (_parameters_of_effect(word_of(name)) if kind == "effects" else [])
    if issubclass(block, Term):
        return facts | {"parameters": rows}
    choices = _settings(block)
    own = ", ".join(f"{word}: {block.setting(word)}" for word in block.settings() if word != "form")
    chosen: Facts = {"settings": choices} if choices else {}
    written = f"{{name: {name}, {own}}}" if own else f"model: [{name}, bouc_wen]" if block.lead else ""
    chosen |= {"in_a_job": written} if written else {}
    return facts | {"place": place_of(name), "parameters": rows} | chosen


def place_of(name: str) -> str | None:
    """The place of a block in the chain; None of what belongs to a parameter of others."""
    place = getattr(blocks[name], "place", None)
    return None if place is None else place.name.lower()


def _look_alikes(block: type[Any]) -> list[str]:
    """The look-alikes that an effect declares, and the effects that declare it as one of theirs."""
    others = [item.name for item in blocks if block.name in item.look_alikes and item.name not in block.look_alikes]
    return [*block.look_alikes, *others]


def _settings(block: type[Any]) -> list[Facts]:
    """What a job may set of a block but its form, with the forms that have it where not all do."""
    forms, rows = _labelled(block), dict[str, Facts]()
    for word, item in [pair for form in forms.values() for pair in form.settings().items() if pair[0] != "form"]:
        owners = [label for label, form in forms.items() if word in form.settings()]
        some = "" if len(owners) == len(forms) else _one_of(owners)
        rows[word] = {"name": word, "default": item.value, "unit": "1", "form": some} | _choices(item)
    return [*rows.values()]


def _labelled(block: type[Any]) -> dict[str, type[Any]]:
    """The block in each form that a job may choose, by what the job writes for it, as it is first."""
    choices = _forms(block)
    first = {_choice(block, word, block.setting(word)): block for word, _ in choices[:1]}
    others = {_choice(block, word, value): block.make(**{word: value}) for word, value in choices}
    return (first | others) or {"": block}


def _one_of(labels: list[str]) -> str:
    """Forms as `a`, `b` or `c`, without the first and the last mark."""
    return either(f"`{label}`" for label in labels)[1:-1]


def _forms(block: type[Any]) -> list[tuple[str, str]]:
    """The settings and their values that choose another form of a block."""
    values = [(word, value) for word, item in block.settings().items() for value in getattr(item, "words", ())]
    return [(word, value) for word, value in values if value in block.forms]


def _choices(item: Setting | Form) -> Facts:
    return {key: value for key, value in asdict(item).items() if key != "value"}


def _choice(block: type[Any], word: str, value: str) -> str:
    """A setting and its value, or the item of an effect in that form, as a job has it."""
    usual = word == "form" and value == block.settings()["form"].value
    return block.name if usual else f"{block.name}.{value}" if word == "form" else f"{word}: {value}"


def _parameters(block: type[Any]) -> list[Facts]:
    """The parameters of a block in all its forms, or in the form that was chosen; one that forms declare differently
    has a row for each declaration."""
    keys = ("unit", "bounds", "null", "value", "scale", "effects", "per_later_axis", "per_record", "adds_to", "doc")
    variants = _variants(block)
    owners: dict[tuple[Any, ...], list[str]] = {}
    for label, found in variants.items():
        for name, item in found.items():
            owners.setdefault((name, *(getattr(item, key) for key in keys)), []).append(label)
    rows: list[Facts] = []
    for (name, *declared), labels in owners.items():
        form = "" if len(labels) == len(variants) else _one_of(labels)
        rows.append({"name": name, "form": form} | dict(zip(keys, declared, strict=True)))
    return rows


def _variants(block: type[Any]) -> dict[str, dict[str, Any]]:
    """The parameters of each form that a block may have, by what a job writes for it."""
    if "form" in block.chosen_settings:
        return {"": block.parameters()}
    return {label: form.parameters() for label, form in _labelled(block).items()}


def _optimizer(name: str) -> Facts:
    item = optimizers[name]
    settings = [{"name": setting.name, "default": setting.default, **setting.metadata} for setting in fields(item)]
    facts = {"name": name, "kind": "optimizer", "doc": inspect.getdoc(item), "source": item.source}
    return facts | {"convergent": item.convergent, "settings": settings}
