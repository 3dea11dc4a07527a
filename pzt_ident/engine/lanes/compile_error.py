"""The error for a function that numba cannot compile, with the line of its author."""

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


def compile_error(
    block: type[Any], trace: str, functions: Mapping[str, FunctionType], helpers: Iterable[FunctionType]
) -> InputError:
    """The error with the function and the innermost line that the author wrote. trace: numba's message."""
    candidates = {**functions, **{helper.__name__: helper for helper in helpers}}
    for file, number in _places(trace):
        for word, function in candidates.items():
            if _contains(function, file, number):
                where = f"{block.__name__}.{word}" if word in functions else f"{block.__name__}: {word}"
                line = linecache.getline(str(file), number).strip()
                return InputError(f"line {number} cannot be compiled: `{line}`", where=where, remedy=REMEDY)
    word = next((word for word in functions if re.search(rf"\b{word}\b at ", trace)), "")
    where = ".".join(filter(None, (block.__name__, word)))
    return InputError("cannot be compiled", where=where, remedy=REMEDY)


def _places(trace: str) -> Iterator[tuple[Path, int]]:
    for match in PLACE.finditer(trace):
        yield Path(match["file"]).resolve(), int(match["line"])


def _contains(function: FunctionType, file: Path, number: int) -> bool:
    code = function.__code__
    last = max((line for *_, line in code.co_lines() if line is not None), default=code.co_firstlineno)
    return Path(code.co_filename).resolve() == file and code.co_firstlineno <= number <= last
