"""What a block or an optimizer owes its kind: `check` says what it lacks.

A class is checked where it is registered, so that a mistake is told in its author's own words before anything is
compiled. Its functions are tried there too, unless they call others that stand further down in the file: then where the
block is compiled, or the job that plugs it in is checked.
"""

from __future__ import annotations

import inspect
from contextlib import suppress
from typing import Any

from pzt_ident.errors import InputError, nearest
from pzt_ident.model.contract.declared import (
    check_counts,
    check_docstring,
    check_effect,
    check_facts,
    check_parameters,
    check_place,
    check_settings,
    check_words,
    fault,
    parameters,
)
from pzt_ident.model.contract.functions import TooSoon, called, check_asked, tried
from pzt_ident.model.contract.kinds import ANY, BRANCHED, KINDS, kind_of, kinds
from pzt_ident.model.contract.optimizer import check_optimizer

__all__ = ["called", "check", "check_loaded", "tried"]


def check(item: Any, registry: str = "") -> None:
    """Raises InputError where a class is no sound block or optimizer: what is wrong, in which function, and what to do.

    registry: the group of the registry that it is meant for; found from the class where it is not given.
    """
    if not inspect.isclass(item):
        raise InputError("is no class", where=str(getattr(item, "__name__", item)), remedy="decorate a class")
    if registry.endswith("optimizer") or (not registry and not kind_of(item)):
        return check_optimizer(item)
    check_block(item)


def check_block(block: Any) -> None:
    kind = kind_of(block)
    if not kind:
        raise InputError("is no block", where=block.__name__, remedy="derive it from Block or one of its kinds")
    bases = kinds(block)
    taken = set(KINDS[kind]) | {word for base in bases for word in (*vars(base), *base.__annotations__)}
    check_words(block, {word.removesuffix("?") for word in (*taken, *ANY)})
    check_docstring(block)
    if kind != "term":
        check_place(block)
    check_facts(block)
    check_settings(block)
    if kind == "modes" and len(getattr(block, "weights", ())) != 2:
        raise fault(block, "weights", "does not name two `weights`", "name the parameters of enters and leaves")
    check_parameters(block)
    check_asked(block)
    check_counts(block, kind in BRANCHED, kind == "addition")
    check_effect(block, kind == "term", bases)
    with suppress(TooSoon):
        tried(block)


def check_loaded(block: Any, known: Any) -> None:
    """What can be told of a block only once its file and those of other effects have been read. known: the registry of
    blocks."""
    tried(block)
    named = [("look_alikes", word) for word in block.look_alikes]
    named += [(word, item.effect) for word, item in parameters(block).items() if item.effect]
    for where, word in named:
        if word not in known:
            raise fault(block, where, f"unknown effect {word!r}", nearest(word, known.effects()))
        if not known[word].remedy:
            raise fault(block, where, f"{word!r} is a block, but no effect", "name an effect: it has a remedy")
