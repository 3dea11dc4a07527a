"""What a block or an optimizer must declare and define; `check` raises InputError for what is missing or wrong.

A class is checked when it is registered, so that a mistake is reported in the author's own names before anything is
compiled. Its functions are also called once, unless they call others that are defined further down in the file: those
are called when the block is compiled or a job that lists it as a plugin is checked.
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
from pzt_ident.model.contract.functions import NotYetDefined, call_function, check_asked, try_functions
from pzt_ident.model.contract.identity import check_identity
from pzt_ident.model.contract.kinds import ANY, BRANCHED, KINDS, kind_of, kinds
from pzt_ident.model.contract.optimizer import check_optimizer

__all__ = ["call_function", "check", "check_loaded", "try_functions"]


def check(item: Any, registry: str = "") -> None:
    """Raises InputError for a faulty block or optimizer: what is wrong, in which function, and the remedy.

    registry: the entry-point group of the registry; derived from the class if empty.
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
    reserved = set(KINDS[kind]) | {word for base in bases for word in (*vars(base), *base.__annotations__)}
    check_words(block, {word.removesuffix("?") for word in (*reserved, *ANY)})
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
    with suppress(NotYetDefined):
        try_functions(block)
        check_identity(block)


def check_loaded(block: Any, known: Any) -> None:
    """The checks of a block that need its whole file and the other effects. known: the registry of blocks."""
    try_functions(block)
    check_identity(block)
    references = [(where, word) for where in ("look_alikes", "leaves") for word in getattr(block, where)]
    forms = (block, *block.forms.values())
    references += [("contains", word) for form in forms for word in form.contains]
    references += [("equation_of", form.equation_of) for form in forms if form.equation_of]
    references += [(word, effect) for word, item in parameters(block).items() for effect in item.effects]
    for where, word in references:
        word = word.partition(".")[0]
        if word not in known:
            raise fault(block, where, f"unknown effect {word!r}", nearest(word, known.effects()))
        if not known[word].remedy and not known[word].lead:
            raise fault(block, where, f"{word!r} is a block, but no effect", "name an effect: it has a remedy")
