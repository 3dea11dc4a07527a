"""What the words of a job stand for, from the declarations of blocks, effects and optimizers."""

from __future__ import annotations

import inspect
from dataclasses import asdict, fields
from typing import Any

from pzt_ident.errors import InputError, nearest
from pzt_ident.model.block import Term
from pzt_ident.model.parameter import Form, Setting
from pzt_ident.model.registry import blocks, optimizers

Facts = dict[str, Any]


def words(kind: str) -> dict[str, str]:
    """The words of a kind (`blocks`, `effects` or `optimizers`) with the first line of what they are."""
    if kind == "optimizers":
        return {item.name: _headline(item) for item in optimizers}
    own = {item.name: _headline(item) for item in blocks if blocks.is_effect(item.name) == (kind == "effects")}
    return (_terms() if kind == "effects" else {}) | own


def _terms() -> dict[str, str]:
    """Effects that are parameters of other blocks, with those blocks."""
    found: dict[str, list[str]] = {}
    for block in blocks:
        for declared in block.parameters().values():
            if declared.effect and block.name not in found.setdefault(declared.effect, []):
                found[declared.effect].append(block.name)
    return {effect: "a term of " + ", ".join(owners) for effect, owners in sorted(found.items())}


def _headline(item: type) -> str:
    return (inspect.getdoc(item) or "").partition("\n")[0]


def description_of(name: str) -> Facts:
    """What a block, effect or optimizer declares. Raises InputError with the nearest words for an unknown one."""
    if name in blocks:
        return _block(name)
    if name in optimizers:
        return _optimizer(name)
    terms = _terms()
    if name in terms:
        return {"name": name, "kind": "effect", "doc": terms[name], "parameters": _owned(name)}
    raise InputError(f"unknown word {name!r}", remedy=nearest(name, [*blocks.words(), *optimizers.words(), *terms]))


def _owned(effect: str) -> list[Facts]:
    """The parameters of all blocks that belong to an effect."""
    every = [row | {"name": f"{block.name}.{row['name']}"} for block in blocks for row in _declared(block)]
    return [row for row in every if row["effect"] == effect]


def _block(name: str) -> Facts:
    block, kind = blocks[name], blocks.kind_of(name)
    facts = {"name": name, "kind": kind, "doc": inspect.getdoc(block)}
    if kind == "effects":
        facts |= {key: getattr(block, key) for key in ("look_alikes", "separate_by", "remedy")}
    if issubclass(block, Term):
        return facts | {"parameters": _owned(name)}
    forms = [block, *(block.make(**{word: each}) for word, each in _forms(block))]
    settings = {word: item for form in forms for word, item in form.settings().items()}
    rows = [{"name": word, "default": item.value, "unit": "1"} | _choices(item) for word, item in settings.items()]
    own = {"settings": rows} if rows else {}
    return facts | {"place": block.place.name.lower(), "parameters": _declared(block)} | own


def _forms(block: type[Any]) -> list[tuple[str, str]]:
    """Settings with the words that make another form of a block."""
    every = [(word, each) for word, item in block.settings().items() for each in getattr(item, "words", ())]
    return [(word, each) for word, each in every if each in block.forms]


def _choices(item: Setting | Form) -> Facts:
    return {key: value for key, value in asdict(item).items() if key != "value"}


def _declared(block: type[Any]) -> list[Facts]:
    """Parameters of a block, and what another form of it has beside them."""
    keys = ("unit", "bounds", "null", "value", "scale", "effect", "per_record", "doc")
    own = {name: (declared, "") for name, declared in block.parameters().items()}
    for word, each in _forms(block):
        more = block.make(**{word: each}).parameters()
        usual = f"{word}: {block.setting(word)}"
        own = {name: (item, form if name in more else usual) for name, (item, form) in own.items()}
        own |= {name: (item, f"{word}: {each}") for name, item in more.items() if name not in own}
    return [
        {"name": name, "form": form} | {key: getattr(item, key) for key in keys} for name, (item, form) in own.items()
    ]


def _optimizer(name: str) -> Facts:
    item = optimizers[name]
    settings = [{"name": setting.name, "default": setting.default, **setting.metadata} for setting in fields(item)]
    facts = {"name": name, "kind": "optimizer", "doc": inspect.getdoc(item), "source": item.source}
    return facts | {"convergent": item.convergent, "settings": settings}
