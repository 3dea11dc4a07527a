"""Trying the functions of a block once in plain Python, with parameters in the middle of their bounds."""

from __future__ import annotations

import inspect
import linecache
import re
from collections.abc import Iterable, Mapping
from types import FunctionType
from typing import Any

from pzt_ident.errors import InputError, nearest
from pzt_ident.model.contract.declared import fault, parameters
from pzt_ident.model.contract.kinds import ANY, BRANCHED, KINDS, Owed, kind_of, owed
from pzt_ident.model.parameter import Setting

MEASURED = ("dt", "span", "peak")
SAMPLES = 16
EXAMPLE = {"dt": 1e-3, "span": 1.0, "peak": 1.0, "branch": 0, "low": 0.0, "further": 0.01, "sign": 1.0}
Known = dict[str, Any]


class TooSoon(InputError):
    """A function of a block calls another that stands further down in the file, which is not there yet."""


def check_asked(block: Any) -> None:
    """Raises InputError for the first function that is missing, or asks for what there is not."""
    for word, item in owed(block).items():
        asked = named(block, word)
        if item.worded:
            _words(block, word, asked[len(item.arguments) - 1 :], _allowed(block, item.worded))


def tried(block: Any) -> dict[str, tuple[Any, ...]]:
    """The groups of numbers that a block's functions give, by name, for parameters in the middle of their bounds.

    Raises InputError for the first function that is missing, asks for what there is not, fails or gives too much or
    too little.
    """
    check_asked(block)
    functions, known = owed(block), example(block)
    groups: dict[str, tuple[Any, ...]] = {}
    if kind_of(block) == "addition":
        groups["amounts"] = tuple(item for item in parameters(block).values() if item.per_record)
    for word, item in functions.items():
        arguments = _arguments(block, word, functions, known, groups)
        if item.results:
            _take(block, word, item, called(block, word, *arguments), known, groups)
    if len(groups.get("along", ())) != len(groups.get("against", ())):
        counts = f"{len(groups['along'])} and {len(groups['against'])} coefficients"
        raise fault(block, "prepare", f"gives {counts} of the two regimes", "give as many along the motion as against")
    return groups


def example(block: Any) -> Known:
    """What the functions of a block may ask for, and an example of each."""
    middle = {word: sum(item.bounds) / 2 for word, item in parameters(block).items()}
    known = EXAMPLE | block.numbers() | dict.fromkeys(getattr(block, "solved", ()), 0.5) | middle
    if kind_of(block) == "addition":
        import numpy as np

        known["t"] = np.linspace(0, 1, SAMPLES)
    return known


def function_of(block: Any, word: str) -> FunctionType:
    """Raises InputError where there is no such function."""
    found = getattr(block, word, None)
    if found is None:
        wanted = (KINDS[kind_of(block)] | ANY).get(word) or KINDS[kind_of(block)][f"{word}?"]
        arguments = wanted.partition(" -> ")[0].replace("*", "")
        others = [name for name, item in vars(block).items() if isinstance(item, staticmethod) and name not in KINDS]
        hint = nearest(word, others)
        hint = f"; {hint}" if hint.startswith("did") else ""
        raise fault(block, word, f"has no function `{word}`", f"write {word}({arguments}){hint}")
    if not isinstance(found, FunctionType):
        raise fault(block, word, f"is {type(found).__name__}, no plain function", f"declare it as `def {word}(...)`")
    code = found.__code__
    if code.co_flags & (inspect.CO_VARARGS | inspect.CO_VARKEYWORDS) or code.co_kwonlyargcount:
        raise fault(block, word, "takes arguments of any number or by keyword", "name them one by one")
    return found


def named(block: Any, word: str) -> tuple[str, ...]:
    code = function_of(block, word).__code__
    return code.co_varnames[: code.co_argcount]


def called(block: Any, word: str, *arguments: Any) -> Any:
    """What a function of a block gives. Raises InputError where it raises anything else."""
    try:
        return getattr(block, word)(*arguments)
    except InputError:
        raise
    except Exception as error:
        if isinstance(error, NameError) and _further_down(getattr(block, word), str(error.name)):
            where = f"{block.__name__}.{word}"
            raise TooSoon(f"{error.name!r} is not there yet", where=where, remedy="move it up") from error
        line = inspect.getinnerframes(error.__traceback__, context=0)[-1].lineno if error.__traceback__ else 0
        remedy = "it is called with parameters in the middle of their bounds"
        raise fault(block, word, f"raises {type(error).__name__} in line {line}: {error}", remedy) from error


def _further_down(function: FunctionType, name: str) -> bool:
    """Whether the file of a function will define a name that is not there yet."""
    text = "".join(linecache.getlines(function.__code__.co_filename))
    defines = (
        rf"^(?:(?:def|class) {re.escape(name)}\b|(?:\w+, *)*{re.escape(name)} *[,=:]|(?:from|import) .*\b{name}\b)"
    )
    return name not in function.__globals__ and re.search(defines, text, re.MULTILINE) is not None


def _arguments(block: Any, word: str, functions: Mapping[str, Owed], known: Known, groups: Known) -> list[Any]:
    item, names = functions[word], named(block, word)
    fixed = [token for token in item.arguments if token != item.worded]
    places = [_members(block, token, word, functions, groups) for token in fixed]
    expected = [name for own in places for name in own]
    asked = names[len(expected) :] if item.worded else ()
    names = names[: len(expected)] if item.worded else names
    if len(names) != len(expected):
        raise _misfit(block, word, names, expected, groups)
    given: list[Any] = []
    for token in fixed:
        group = groups.get(token.strip("*()"), ())
        given += [group] if token.startswith("(") else group if token.startswith("*") else [known.get(token, 0.5)]
    return [*given, *(known[name] for name in asked)]


def _members(block: Any, token: str, word: str, functions: Mapping[str, Owed], groups: Known) -> list[str]:
    """What a function is given for a token, in the words that the author has for it elsewhere."""
    if not token.startswith("*"):
        return [token.strip("()")]
    size = len(groups[token[1:]])
    for other, item in functions.items():
        if other != word and token in item.arguments:
            names = named(block, other)
            own = names[:size] if token == item.arguments[0] else names[len(names) - size :]
            if len(own) == size and not set(own) & set(item.arguments):
                return list(own)
    known = _beside(named(block, word), token, functions[word].arguments)[:size]
    return [*known, *(f"{token[1:].removesuffix('s')} {i + 1}" for i in range(len(known), size))]


def _beside(names: tuple[str, ...], token: str, arguments: tuple[str, ...]) -> tuple[str, ...]:
    """The names of a function's own that stand where a group does: ahead of or behind what is given beside it."""
    fixed = [one for one in arguments if not one.startswith("*")]
    edge = fixed[0] if token == arguments[0] else fixed[-1]
    if edge not in names:
        return ()
    return names[: names.index(edge)] if token == arguments[0] else names[names.index(edge) + 1 :]


def _misfit(block: Any, word: str, names: Iterable[str], expected: list[str], groups: Known) -> InputError:
    takes = list(names)
    missing = [name for name in expected if name not in takes]
    surplus = [name for name in takes if name not in expected]
    short = len(takes) < len(expected)
    of = takes[:1] if takes[:1] == ["self"] else (missing if short else surplus) or (expected if short else takes)[-1:]
    said = f"takes ({', '.join(takes)}), but is given ({', '.join(expected)}): "
    said += " and ".join(f"{name!r}" for name in of) + (" missing" if short else " too many")
    counts = ", ".join(f"{len(own)} {group}" for group, own in groups.items())
    remedy = "a block's functions have no self" if takes[:1] == ["self"] else f"its functions give {counts or 'none'}"
    return fault(block, word, said, remedy)


def _allowed(block: Any, token: str) -> set[str]:
    """The words that a function may ask for."""
    kind = kind_of(block)
    own = {word for word, item in parameters(block).items() if not item.per_record}
    if token == "settings":
        return {word for word, item in block.settings().items() if isinstance(item, Setting)}
    if token == "own parameters":
        return own
    if token == "branches":
        return own | set(block.numbers()) | {"branch"}
    own -= set(block.weights) if kind == "modes" else set()
    branch = {"branch"} if kind in BRANCHED else set()
    return own | set(block.numbers()) | set(MEASURED) | branch | set(getattr(block, "solved", ()))


def _words(block: Any, function: str, asked: Iterable[str], allowed: set[str]) -> None:
    for word in asked:
        if word not in allowed:
            said = f"asks for {word!r}, which is neither a parameter nor a setting of the block nor measured"
            raise fault(block, function, said, nearest(word, allowed) if allowed else "there is nothing to ask for")


def _take(block: Any, word: str, item: Owed, result: Any, known: Known, groups: Known) -> None:
    """Put away what a function gave."""
    parts = [token.lstrip("*+") for token in item.results]
    group = next((token for token in item.results if token[0] in "*+"), "")
    due = len(groups.get(group[1:], ())) + len(parts) - 1 if group else len(parts)
    free = bool(group) and group[1:] not in groups
    bare = not item.packed or (due == 1 and not free and len(parts) > 1)
    if bare:
        result = (result,) if not isinstance(result, tuple) else _fail(block, word, item, result, "one number, bare")
    elif not isinstance(result, tuple):
        _fail(block, word, item, result, "a tuple")
    if len(result) < 1 if group.startswith("+") else len(result) != due and not free:
        _fail(block, word, item, result, "one value or more" if free else "one value" if due == 1 else f"{due} values")
    if free or (item.packed and len(parts) == 1):
        groups[parts[0]] = result
    for token, value in zip(parts, result, strict=False) if not group else ():
        if token.startswith("("):
            if not isinstance(value, tuple) or not value:
                _fail(block, word, item, result, f"a tuple of one or more for {token.strip('()')}")
            groups[token.strip("()")] = value
        known[token] = value
    for value in (one for each in result for one in (each if isinstance(each, tuple) else (each,))):
        if not hasattr(value, "__float__") or getattr(value, "shape", ()) != getattr(known.get("t"), "shape", ()):
            _fail(block, word, item, result, "numbers" if "t" not in known else "arrays over t")


def _fail(block: Any, word: str, item: Owed, result: Any, due: str) -> Any:
    shown = f"{len(result)} values" if isinstance(result, tuple) and len(result) != 1 else repr(result)[:60]
    raise fault(block, word, f"gives {shown}, where {due} should be", f"return {', '.join(item.results)}")
