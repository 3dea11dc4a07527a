"""Checks of the parameters of a job: names that its model has, bounds and values that they can take."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from pzt_ident.data.notation import either
from pzt_ident.errors import InputError, nearest
from pzt_ident.job.chain import ChainParts
from pzt_ident.job.document import Document, Loc
from pzt_ident.model.registry import blocks, word_of

if TYPE_CHECKING:
    from pzt_ident.job.sections import Setting
    from pzt_ident.model.chain import Chain, Entry

Earlier = Mapping[str, Any]
"""The sections before the one that is checked, without those that cannot be read."""


def check_parameters(document: Document, settings: dict[str, Setting], earlier: Earlier) -> None:
    for name, setting in settings.items():
        _setting(document, ("parameters", name), setting)
    if not {"channels", "model", "effects"} <= set(earlier):
        return
    axes = earlier["channels"].axes
    if all(axis.response is None for axis in axes.values()):
        return
    try:
        parts = ChainParts.of((*earlier["model"], *earlier["effects"]), axes, earlier.get("shared", ()), settings)
        model = document.chain.of(parts)
    except InputError:
        return  # a bad setting of a block, reported at the setting
    entries = {name: entry for entry in model.entries for name in model.spellings(entry)}
    if entries and not any(_is_free(model, entry, settings) for entry in model.entries):
        document.fault(("parameters",), "every parameter is fixed", "free at least one: give it `bounds`")
    for name, setting in settings.items():
        loc: Loc = ("parameters", name)
        if name not in entries:
            _unknown_name(document, name, earlier, entries)
            continue
        declared = entries[name].parameter
        least = setting.bounds[0] if setting.bounds else setting.value
        if declared.scale == "log" and least is not None and least <= 0:
            document.fault(loc, f"{least:g} is not above 0", "give a value or lower bound above 0")


def _is_free(model: Chain, entry: Entry, settings: Mapping[str, Setting]) -> bool:
    """Whether a parameter is searched for."""
    setting = next((settings[name] for name in model.spellings(entry) if name in settings), None)
    if setting is not None:
        return setting.bounds is not None
    return entry.parameter.value is None and not entry.parameter.linear


def _setting(document: Document, loc: Loc, setting: Setting) -> None:
    if setting.bounds is None and setting.value is None:
        document.fault(loc, "sets nothing", "give `bounds: [low, high]` or `value: ...`")
    if setting.bounds is None:
        return
    low, high = setting.bounds
    if low >= high:
        if low == high:
            document.fault((*loc, "bounds"), f"both bounds are {low:g}", f"fix it with `value: {low:g}`")
        else:
            message = f"bounds reversed, {low:g} is not below {high:g}"
            document.fault((*loc, "bounds"), message, "write [low, high], the lower first")
    if setting.value is not None:
        document.fault((*loc, "value"), "beside `bounds`", "keep one: bounds free a parameter, a value fixes it")


def _unknown_name(document: Document, name: str, earlier: Earlier, entries: Mapping[str, Entry]) -> None:
    """Report a name that no parameter of this job has."""
    *axis, block, word = ["", *name.split(".")]
    axes, words = earlier["channels"].axes, list(map(word_of, earlier["model"]))
    chosen = (*words, *map(word_of, earlier["effects"]))
    if len(axis) == 2 and axis[1] not in axes:
        fault = f"there is no axis {axis[1]!r}", nearest(axis[1], axes)
    elif len(axis) == 2 and axes[axis[1]].response is None:
        fault = f"axis {axis[1]!r} has no response, so it has no such parameter", "take it out"
    elif block not in chosen and block in blocks:
        if any(word not in blocks for word in words):
            return  # one of the unknown words may be meant for this block
        fault = f"{block!r} is not in this model", "list it under `model` or `effects`, or take this out"
    elif block not in chosen:
        fault = f"unknown parameter {name!r}", nearest(name, entries)
    elif declared := blocks[block].parameters().get(word):
        fault = (
            f"is not in the form of {block!r} that is chosen",
            f"take it out; `pzt-ident show {block}` says which has it",
        )
        if declared.effects:
            fault = (
                f"belongs to the effect {either(map(repr, declared.effects))}",
                f"add `effects: [{declared.effects[0]}]`",
            )
        elif declared.per_record:
            fault = "is solved for in every record by itself", "take it out"
        elif declared.per == "stage":
            fault = "belongs to the whole stage, not to an axis", f"write {block}.{word}"
        elif declared.per_later_axis:
            fault = "is relative to that of the first axis, which has none", "take it out"
    else:
        similar = [known for known in entries if f"{block}." in known and known.count(".") == name.count(".")]
        fault = f"{block!r} has no parameter {word!r}", nearest(name, similar)
    document.fault(("parameters", name), *fault, at_key=True)
