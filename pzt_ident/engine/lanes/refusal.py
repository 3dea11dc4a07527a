"""What numba says of a function that it cannot compile, in the words of its author."""

from __future__ import annotations

import linecache
import re
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from types import FunctionType
from typing import Any

from pzt_ident.errors import InputError

PLACE = re.compile(r"""(?:File "|\bat )(?P<file>[^"\n]+?)(?:", line | \()(?P<line>\d+)""")
REMEDY = "write it with numbers, tuples, conditional expressions and the functions of math and of pzt_ident.model.block"


def refusal(
    block: type[Any], trace: str, functions: Mapping[str, FunctionType], helpers: Iterable[FunctionType]
) -> InputError:
    """The error that names the function and the line, the innermost of the author's. trace: numba's message."""
    every = {**functions, **{helper.__name__: helper for helper in helpers}}
    for file, number in _places(trace):
        for word, function in every.items():
            if _holds(function, file, number):
                where = f"{block.__name__}.{word}" if word in functions else f"{block.__name__}: {word}"
                line = linecache.getline(str(file), number).strip()
                return InputError(f"line {number} cannot be compiled: `{line}`", where=where, remedy=REMEDY)
    word = next((word for word in functions if re.search(rf"\b{word}\b at ", trace)), "")
    where = ".".join(filter(None, (block.__name__, word)))
    return InputError("cannot be compiled", where=where, remedy=REMEDY)


def _places(trace: str) -> Iterator[tuple[Path, int]]:
    for found in PLACE.finditer(trace):
        yield Path(found["file"]).resolve(), int(found["line"])


def _holds(function: FunctionType, file: Path, number: int) -> bool:
    code = function.__code__
    last = max((line for *_, line in code.co_lines() if line is not None), default=code.co_firstlineno)
    return Path(code.co_filename).resolve() == file and code.co_firstlineno <= number <= last
