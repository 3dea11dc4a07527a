"""Checks of what a block declares: parameters, settings, place, and the texts of an effect."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Mapping
from enum import IntEnum
from typing import Any

from pzt_ident.data.units import factor
from pzt_ident.errors import InputError, nearest
from pzt_ident.model.parameter import Form, Parameter, Setting

UNIT_EXAMPLES = {"drive": "V", "response": "m", "first": "m"}
FIELD_TYPES = {
    "unit": str,
    "doc": str,
    "effect": str | tuple | None,
    "count": int | str | None,
    "smooth": str | None,
    "adds_to": str | None,
    "limit": str | None,
}
FIELD_WORDS = {"scale": ("linear", "log"), "per": ("axis", "stage", "later axis")}
TEXT, COUNT = "a text", "a whole number from 1 on"
TUPLE = 'a tuple of words, such as `("creep",)`'
ATTRIBUTES = {
    TUPLE: ("look_alikes", "contains", "leaves", "compared_with_drive", "refines", "alike", "solved", "weights"),
    TEXT: ("separate_by", "remedy", "violation", "equation_of"),
    COUNT: ("oversample",),
    "a tuple of numbers": ("sizes",),
    "a table by parameter": ("trials",),
    "a table of blocks by word": ("forms",),
}
"""Class attributes that a block may declare, by what their value must be."""


def fault(item: Any, where: str, message: str, remedy: str) -> InputError:
    return InputError(message, where=".".join(filter(None, (item.__name__, where))), remedy=remedy)


def declared(block: Any, kinds: type[Any] | tuple[type[Any], ...]) -> dict[str, Any]:
    """The attributes of some kinds that a block and its base classes declare, by attribute name."""
    attributes = [item for owner in reversed(block.__mro__) for item in vars(owner).items()]
    return {word: value for word, value in attributes if isinstance(value, kinds)}


def parameters(block: Any) -> dict[str, Parameter]:
    """By the name under which `prepare` asks for them; one with a `count` appears once."""
    return declared(block, Parameter)


def check_docstring(item: Any) -> None:
    text = vars(item).get("__doc__") or ""
    if not text.strip() or text.startswith(f"{item.__name__}("):  # the latter is what dataclass writes
        raise fault(item, "", "has no docstring", "say in its first line what it is")


def check_place(block: Any) -> None:
    place = getattr(block, "place", None)
    if not isinstance(place, IntEnum):
        message = "has no `place`" if place is None else f"has {place!r} for its `place`"
        raise fault(block, "place", message, "say where it stands in the signal chain, such as `place = Place.READOUT`")


def check_words(block: Any, taken: Iterable[str]) -> None:
    """A parameter or setting must not hide an attribute of every block, nor be one object under two names."""
    for word, item in declared(block, Parameter | Setting | Form).items():  # type: ignore[arg-type]
        if word in taken:
            raise fault(block, word, f"{word!r} is a word of every block of this kind", "rename the parameter")
        if isinstance(item, Parameter) and item.name != word:
            message = f"is the same object as the parameter {item.name!r}"
            raise fault(block, word, message, "declare it anew, or copy it with dataclasses.replace")


def check_facts(block: Any) -> None:
    fits: dict[str, Callable[[Any], bool]] = {
        TUPLE: lambda value: isinstance(value, tuple) and all(isinstance(word, str) for word in value),
        TEXT: lambda value: isinstance(value, str),
        COUNT: lambda value: isinstance(value, int) and value > 0,
        "a tuple of numbers": lambda value: isinstance(value, tuple) and all(isinstance(x, int | float) for x in value),
        "a table by parameter": lambda value: isinstance(value, Mapping),
        "a table of blocks by word": lambda value: (
            isinstance(value, Mapping) and all(isinstance(form, type) for form in value.values())
        ),
    }
    for expected, words in ATTRIBUTES.items():
        for word in words:
            value = getattr(block, word, None)
            if hasattr(block, word) and not fits[expected](value):
                raise fault(block, word, f"{value!r} is not {expected}", f"give {expected}")


def check_settings(block: Any) -> None:
    for word, item in block.settings().items():
        if isinstance(item, Setting) and not ordered(item.bounds):
            raise fault(block, word, f"bounds {item.bounds!r} are no range", "give (least, most), the smaller first")
        item.check(item.value, f"{block.__name__}.{word}")
    for listed in ("compared_with_drive", "trials", "weights"):
        for word in getattr(block, listed, ()):
            if word not in parameters(block):
                raise fault(block, listed, f"unknown parameter {word!r}", nearest(word, parameters(block)))


def ordered(bounds: Any) -> bool:
    return (
        isinstance(bounds, tuple)
        and len(bounds) == 2
        and all(isinstance(end, int | float) and math.isfinite(end) for end in bounds)
        and bounds[0] < bounds[1]
    )


def check_parameters(block: Any) -> None:
    for word, item in parameters(block).items():
        for fact, kind in FIELD_TYPES.items():
            if not isinstance(getattr(item, fact), kind):
                raise fault(
                    block, word, f"{fact} {getattr(item, fact)!r} is no such thing", f"see `{fact}` of Parameter"
                )
        if not all(isinstance(effect, str) for effect in item.effects):
            raise fault(block, word, f"effect {item.effect!r} is not {TUPLE}", f"give {TUPLE}")
        _check_numbers(block, word, item)
        _check_unit(block, word, item)
        for fact, known in FIELD_WORDS.items():
            if getattr(item, fact) not in known:
                message = f"unknown {fact} {getattr(item, fact)!r}"
                raise fault(block, word, message, nearest(str(getattr(item, fact)), known))
        peers = [other for other in parameters(block).values() if {*other.effects} & {*item.effects}]
        if item.effects and all(other.null is None for other in peers):
            raise fault(
                block, word, "belongs to an effect, but has no null", "give the value at which it has no effect"
            )
        for other in filter(None, (item.smooth, item.adds_to)):
            if other not in parameters(block):
                raise fault(block, word, f"unknown parameter {other!r}", nearest(other, parameters(block)))


def _check_numbers(block: Any, word: str, item: Parameter) -> None:
    if not ordered(item.bounds):
        remedy = "give (least, most), finite and the smaller first"
        raise fault(block, word, f"bounds {item.bounds!r} are no range", remedy)
    low, high = item.bounds
    if item.scale == "log" and low <= 0:
        raise fault(block, word, f"a log scale from {low:g}", "give a lower bound above 0, or a linear scale")
    for fact in ("null", "value"):
        number = getattr(item, fact)
        if number is not None and not (isinstance(number, int | float) and low <= number <= high):
            message = f"{fact} {number!r} is out of its bounds ({low:g}, {high:g})"
            raise fault(block, word, message, f"give {fact} a number from {low:g} to {high:g}")


def _check_unit(block: Any, word: str, item: Parameter) -> None:
    try:
        factor(re.sub(r"\b(drive|response|first)(?=\b|\d)", lambda match: UNIT_EXAMPLES[match[0]], item.unit))
    except InputError as error:
        remedy = f"{error.remedy}; `drive`, `response` and `first` stand for the units of the data"
        raise fault(block, word, error.message, remedy) from None


def check_counts(block: Any, branched: bool, many: bool) -> None:
    """Checks the number of branches and the counted parameters. many: a count needs no branches."""
    for word, item in parameters(block).items():
        if isinstance(item.count, str) and item.count not in block.settings():
            remedy = nearest(item.count, block.settings()) if block.settings() else "declare it as a Setting"
            raise fault(block, word, f"is counted by the unknown setting {item.count!r}", remedy)
    branches = getattr(block, "branches", None)
    if branched and (not isinstance(branches, int) or branches < 1):
        message = "has no `branches`" if branches is None else f"has {branches!r} `branches`"
        raise fault(block, "branches", message, "say how many with a whole number, `count` or a setting")
    for word, item in parameters(block).items():
        count = block.setting(item.count) if isinstance(item.count, str) else item.count
        if count is not None and not many and count != branches:
            message = f"there are {count} of it for {branches if branched else 'no'} branches"
            raise fault(block, word, message, "count one per branch" if branched else "leave out `count`")


def check_effect(block: Any, term: bool, kinds: tuple[type, ...]) -> None:
    """A block with a remedy is an effect and must say how to tell it apart. kinds: the base classes of all blocks."""
    declared_words = {word for base in block.__mro__ if base not in kinds for word in vars(base)}
    if not block.remedy:
        if block.look_alikes or block.separate_by or term:
            raise fault(block, "remedy", "is an effect without `remedy`", "say what to do about it on the rig")
        return
    if "look_alikes" not in declared_words:
        remedy = 'name the effects that leave the same trace, `look_alikes = ("creep",)`, or `()` where none does'
        raise fault(block, "look_alikes", "is an effect without look-alikes", remedy)
    if not block.separate_by:
        raise fault(block, "separate_by", "is an effect without `separate_by`", "say which experiment tells it apart")
    if not term and all(item.null is None for item in parameters(block).values()):
        raise fault(block, "", "is an effect without a null", "give a parameter the `null` at which it has no effect")
