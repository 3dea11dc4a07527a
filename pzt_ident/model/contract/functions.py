"""Calls the functions of a block once in plain Python, with parameters in the middle of their bounds."""

from __future__ import annotations

import inspect
import linecache
import re
from collections.abc import Iterable, Mapping
from types import FunctionType
from typing import Any

from pzt_ident.errors import InputError, nearest
from pzt_ident.model.contract.declared import fault, parameters
from pzt_ident.model.contract.kinds import ANY, BRANCHED, KINDS, Signature, kind_of, signatures
from pzt_ident.model.parameter import Setting

MEASURED = ("dt", "span", "peak", "duration", "lead", "from_rest")
EXAMPLE = {
    "dt": 1e-3,
    "span": 1.0,
    "peak": 1.0,
    "branch": 0,
    "low": 0.0,
    "sign": 1.0,
    "duration": 1.0,
    "lead": 1.0,
    "from_rest": 1.0,
}
Known = dict[str, Any]


class NotYetDefined(InputError):
    """A function of a block calls another that is defined further down in the file."""


def check_asked(block: Any) -> None:
    """Raises InputError for the first function that is missing or asks for an unknown name, and for a parameter for
    which none asks."""
    for word, item in signatures(block).items():
        names = arguments_of(block, word)
        if item.asked_by_name:
            _check_names(block, word, names[len(item.arguments) - 1 :], _allowed(block, item.asked_by_name))
    _check_all_asked(block)


def _check_all_asked(block: Any) -> None:
    """A block without `solved` or `weights` gets no parameter but those for which its functions ask; one of an effect
    belongs to a form of the block, which is not known yet."""
    if getattr(block, "solved", ()):
        return
    asking = [word for word, item in signatures(block).items() if item.asked_by_name]
    asked = {name for word in asking for name in arguments_of(block, word)}
    asked |= {*getattr(block, "weights", ()), *(item.smooth for item in parameters(block).values() if item.smooth)}
    for name, item in parameters(block).items():
        if name not in asked and not item.per_record and not item.effects:
            remedy = "name it among the arguments, or take it out of the declaration"
            raise fault(block, asking[0], f"does not ask for the parameter {name!r}", remedy)


def try_functions(block: Any) -> dict[str, tuple[Any, ...]]:
    """The groups of numbers that a block's functions return (coefficients, states, ...), by name.

    Raises InputError for the first function that is missing, asks for an unknown name, fails, or returns too many or
    too few values.
    """
    check_asked(block)
    functions, known = signatures(block), example(block)
    groups: dict[str, tuple[Any, ...]] = {}
    if kind_of(block) == "addition":
        groups["amounts"] = tuple(item for item in parameters(block).values() if item.per_record)
    for word, item in functions.items():
        arguments = _arguments(block, word, functions, known, groups)
        if item.results:
            _store(block, word, item, call_function(block, word, *arguments), known, groups)
        if len(groups.get("along", ())) != len(groups.get("against", ())):
            counts = f"{len(groups['along'])} and {len(groups['against'])} coefficients"
            remedy = "give as many along the motion as against"
            raise fault(block, "prepare", f"gives {counts} of the two regimes", remedy)
    return groups


def example(block: Any) -> Known:
    """An example value for each name that the functions of a block may ask for."""
    middle = {word: sum(item.bounds) / 2 for word, item in parameters(block).items()}
    solved, others = getattr(block, "solved", ()), block.asked_of_others() if kind_of(block) == "coupling" else ()
    return EXAMPLE | block.numbers() | dict.fromkeys(solved, 0.5) | dict.fromkeys(others, 1.0) | middle


def function_of(block: Any, word: str) -> FunctionType:
    """Raises InputError where there is no such function."""
    function = getattr(block, word, None)
    if function is None:
        signature = (KINDS[kind_of(block)] | ANY).get(word) or KINDS[kind_of(block)][f"{word}?"]
        arguments = signature.partition(" -> ")[0].replace("*", "")
        others = [name for name, item in vars(block).items() if isinstance(item, staticmethod) and name not in KINDS]
        hint = nearest(word, others)
        hint = f"; {hint}" if hint.startswith("did") else ""
        raise fault(block, word, f"has no function `{word}`", f"write {word}({arguments}){hint}")
    if not isinstance(function, FunctionType):
        raise fault(block, word, f"is {type(function).__name__}, no plain function", f"declare it as `def {word}(...)`")
    code = function.__code__
    if code.co_flags & (inspect.CO_VARARGS | inspect.CO_VARKEYWORDS) or code.co_kwonlyargcount:
        raise fault(block, word, "takes arguments of any number or by keyword", "name them one by one")
    return function


def arguments_of(block: Any, word: str) -> tuple[str, ...]:
    code = function_of(block, word).__code__
    return code.co_varnames[: code.co_argcount]


def call_function(block: Any, word: str, *arguments: Any) -> Any:
    """What a function of a block returns. Raises InputError for any other exception."""
    try:
        return getattr(block, word)(*arguments)
    except InputError:
        raise
    except Exception as error:
        if isinstance(error, NameError) and _further_down(getattr(block, word), str(error.name)):
            where = f"{block.__name__}.{word}"
            raise NotYetDefined(f"{error.name!r} is not defined yet", where=where, remedy="move it up") from error
        line = inspect.getinnerframes(error.__traceback__, context=0)[-1].lineno if error.__traceback__ else 0
        remedy = "it is called with parameters in the middle of their bounds"
        raise fault(block, word, f"raises {type(error).__name__} in line {line}: {error}", remedy) from error


def _further_down(function: FunctionType, name: str) -> bool:
    """Whether the file of a function defines a name further down, which does not exist yet."""
    text = "".join(linecache.getlines(function.__code__.co_filename))
    defines = (
        rf"^(?:(?:def|class) {re.escape(name)}\b|(?:\w+, *)*{re.escape(name)} *[,=:]|(?:from|import) .*\b{name}\b)"
    )
    return name not in function.__globals__ and re.search(defines, text, re.MULTILINE) is not None


def _arguments(block: Any, word: str, functions: Mapping[str, Signature], known: Known, groups: Known) -> list[Any]:
    item, names = functions[word], arguments_of(block, word)
    fixed = [token for token in item.arguments if token != item.asked_by_name]
    expected = [name for token in fixed for name in _members(block, token, word, functions, groups)]
    asked = names[len(expected) :] if item.asked_by_name else ()
    names = names[: len(expected)] if item.asked_by_name else names
    if len(names) != len(expected):
        raise _argument_error(block, word, names, expected, groups)
    values: list[Any] = []
    for token in fixed:
        group = groups.get(token.strip("*()"), ())
        values += [group] if token.startswith("(") else group if token.startswith("*") else [known.get(token, 0.5)]
    return [*values, *(known[name] for name in asked)]


def _members(block: Any, token: str, word: str, functions: Mapping[str, Signature], groups: Known) -> list[str]:
    """The argument names that a token stands for, as the author names them in another function."""
    if not token.startswith("*"):
        return [token.strip("()")]
    size = len(groups[token[1:]])
    for other, item in functions.items():
        if other != word and token in item.arguments:
            names = arguments_of(block, other)
            members = names[:size] if token == item.arguments[0] else names[len(names) - size :]
            if len(members) == size and not set(members) & set(item.arguments):
                return list(members)
    known = _names_of_group(arguments_of(block, word), token, functions[word].arguments)[:size]
    return [*known, *(f"{token[1:].removesuffix('s')} {i + 1}" for i in range(len(known), size))]


def _names_of_group(names: tuple[str, ...], token: str, arguments: tuple[str, ...]) -> tuple[str, ...]:
    """The names at the place of a group: before or after the fixed arguments."""
    fixed = [argument for argument in arguments if not argument.startswith("*")]
    edge = fixed[0] if token == arguments[0] else fixed[-1]
    if edge not in names:
        return ()
    return names[: names.index(edge)] if token == arguments[0] else names[names.index(edge) + 1 :]


def _argument_error(block: Any, word: str, names: Iterable[str], expected: list[str], groups: Known) -> InputError:
    takes = list(names)
    missing = [name for name in expected if name not in takes]
    surplus = [name for name in takes if name not in expected]
    short = len(takes) < len(expected)
    wrong = missing if short else surplus
    wrong = takes[:1] if takes[:1] == ["self"] else wrong or (expected if short else takes)[-1:]
    message = f"takes ({', '.join(takes)}), but is given ({', '.join(expected)}): "
    message += " and ".join(f"{name!r}" for name in wrong) + (" missing" if short else " too many")
    counts = ", ".join(f"{len(values)} {group}" for group, values in groups.items())
    remedy = "a block's functions have no self" if takes[:1] == ["self"] else f"its functions give {counts or 'none'}"
    return fault(block, word, message, remedy)


def _allowed(block: Any, token: str) -> set[str]:
    """The names that a function may ask for."""
    kind = kind_of(block)
    addition = kind == "addition"
    names = {word for word, item in parameters(block).items() if not (addition and item.per_record)}
    if token == "settings":
        return {word for word, item in block.settings().items() if isinstance(item, Setting)}
    if token == "own parameters":
        return names | {"duration"}
    if token == "branches":
        return names | set(block.numbers()) | {"branch"}
    names -= set(block.weights) if kind == "modes" else set()
    branch = {"branch"} if kind in BRANCHED else set()
    names |= block.asked_of_others() if kind == "coupling" else set()
    return names | set(block.numbers()) | set(MEASURED) | branch | set(getattr(block, "solved", ()))


def _check_names(block: Any, function: str, names: Iterable[str], allowed: set[str]) -> None:
    for word in names:
        if word not in allowed:
            message = f"asks for {word!r}, which is neither a parameter nor a setting of the block nor measured"
            raise fault(block, function, message, nearest(word, allowed) if allowed else "there is nothing to ask for")


def _store(block: Any, word: str, item: Signature, result: Any, known: Known, groups: Known) -> None:
    """Check what a function returned, and keep it for the arguments of the others."""
    parts = [token.lstrip("*+") for token in item.results]
    group = next((token for token in item.results if token[0] in "*+"), "")
    expected_count = len(groups.get(group[1:], ())) + len(parts) - 1 if group else len(parts)
    free = bool(group) and group[1:] not in groups
    bare = not item.packed or (expected_count == 1 and not free and len(parts) > 1)
    if bare:
        result = (result,) if not isinstance(result, tuple) else _fail(block, word, item, result, "one number, bare")
    elif not isinstance(result, tuple):
        _fail(block, word, item, result, "a tuple")
    if len(result) < 1 if group.startswith("+") else len(result) != expected_count and not free:
        _fail(
            block,
            word,
            item,
            result,
            "one value or more" if free else "one value" if expected_count == 1 else f"{expected_count} values",
        )
    if free or (item.packed and len(parts) == 1):
        groups[parts[0]] = result
    for token, value in zip(parts, result, strict=False) if not group else ():
        if token.startswith("("):
            if not isinstance(value, tuple) or not value:
                _fail(block, word, item, result, f"a tuple of one or more for {token.strip('()')}")
            groups[token.strip("()")] = value
        known[token] = value
    for value in (number for entry in result for number in (entry if isinstance(entry, tuple) else (entry,))):
        if not hasattr(value, "__float__") or getattr(value, "shape", None):
            _fail(block, word, item, result, "numbers")


def _fail(block: Any, word: str, item: Signature, result: Any, expected: str) -> Any:
    shown = f"{len(result)} values" if isinstance(result, tuple) and len(result) != 1 else repr(result)[:60]
    raise fault(block, word, f"gives {shown}, where {expected} should be", f"return {', '.join(item.results)}")
