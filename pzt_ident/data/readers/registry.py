"""The known readers of file formats, by the suffix of a file or by its first bytes."""

from __future__ import annotations

import importlib
import inspect
import pkgutil
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from types import ModuleType
from typing import Any

from pzt_ident.data.readers.table import Table
from pzt_ident.data.record import Source
from pzt_ident.errors import InputError

PACKAGE = "pzt_ident.data.formats"
GROUP = "pzt_ident.reader"
TEXT = "text"

Parts = tuple[str, dict[str, str]]
"""The key of a record in a job that selects a part of a file (`table`, `sheet`), and the title of every part."""


@dataclass(frozen=True)
class Reader:
    """What the module of a format declares. `read` gives the columns of a file, `parts` its tables or sheets."""

    name: str
    file: str
    suffixes: tuple[str, ...]
    magic: tuple[bytes, ...]
    read: Callable[[Path, Source], Table]
    parts: Callable[[Path], Parts] | None

    @classmethod
    def of(cls, module: Any) -> Reader:
        """The reader that a module declares. Raises InputError where it breaks the contract."""
        if not isinstance(module, ModuleType):
            raise InputError("is not a module", where=repr(module), remedy="name the module that declares the reader")
        _check(module)
        return cls(
            name=module.__name__.rpartition(".")[2],
            file=str(module.__file__),
            suffixes=module.SUFFIXES,
            magic=getattr(module, "MAGIC", ()),
            read=module.read,
            parts=getattr(module, "parts", None),
        )


class Readers:
    """Every file of `pzt_ident.data.formats`, those that entry points of `pzt_ident.reader` name, and those of plugins.

    They are imported at the first look-up. An entry point that cannot be used is left out with a warning.
    """

    def __init__(self) -> None:
        self._added: list[Reader] = []

    def __iter__(self) -> Iterator[Reader]:
        yield from self._installed
        yield from self._added

    def suffixes(self) -> tuple[str, ...]:
        """The suffixes of all data files, in lower case with their dot."""
        return tuple(suffix for reader in self for suffix in reader.suffixes)

    def find(self, path: Path) -> Reader:
        """By the suffix; where that is unknown or that of a text file, by the first bytes, else the reader of text.

        Raises OSError where the file cannot be opened.
        """
        text = next(reader for reader in self if reader.name == TEXT)
        by_suffix = next((reader for reader in self if path.suffix.lower() in reader.suffixes), text)
        if by_suffix is not text:
            return by_suffix
        with path.open("rb") as file:
            beginning = file.read(max(len(magic) for reader in self for magic in reader.magic))
        return next((reader for reader in self if beginning.startswith(reader.magic)), text)

    def add(self, module: Any) -> None:
        """Add the reader of a module, in place of an earlier one from the same file.

        Raises InputError where it breaks the contract, or claims what another reader has.
        """
        added = [reader for reader in self._added if reader.file != getattr(module, "__file__", None)]
        self._added = [*added, _free_reader(module, [*self._installed, *added])]

    def add_declared(self, module: Any) -> bool:
        """Add the reader that a user's file declares; False where it declares none. Raises InputError as `add`."""
        if not hasattr(module, "SUFFIXES"):
            return False
        self.add(module)
        return True

    @cached_property
    def _installed(self) -> list[Reader]:
        installed: list[Reader] = []
        for name in _format_modules():
            installed.append(_free_reader(importlib.import_module(name), installed))
        for entry in entry_points(group=GROUP):
            try:
                installed.append(_free_reader(entry.load(), installed))
            except Exception as error:  # importing another distribution can raise anything
                warnings.warn(f"{_origin(entry)}: {_reason(error)}", stacklevel=2)
        return installed


def _format_modules() -> list[str]:
    modules = pkgutil.iter_modules(importlib.import_module(PACKAGE).__path__)
    return [f"{PACKAGE}.{module.name}" for module in modules if not module.name.startswith("_")]


def _free_reader(module: Any, others: list[Reader]) -> Reader:
    """The reader of a module. Raises InputError where it breaks the contract, or claims what another has."""
    reader = Reader.of(module)
    _check_free(reader, others)
    return reader


def _check(module: ModuleType) -> None:
    where = str(module.__file__)
    if not inspect.getdoc(module):
        raise InputError("has no docstring", where=where, remedy="say in the first line which files it reads")
    suffixes, magic = getattr(module, "SUFFIXES", ()), getattr(module, "MAGIC", ())
    if not _are_suffixes(suffixes):
        remedy = 'write `SUFFIXES = (".abc",)`, in lower case with the dot'
        raise InputError("does not declare its suffixes", where=where, remedy=remedy)
    if not isinstance(magic, tuple) or not all(isinstance(first, bytes) and first for first in magic):
        raise InputError(
            "MAGIC is not a tuple of bytes", where=where, remedy='write `MAGIC = (b"ABC1",)`, or leave it out'
        )
    _check_function(module, "read", 2, "def read(path, source):")
    if hasattr(module, "parts"):
        _check_function(module, "parts", 1, "def parts(path):")


def _are_suffixes(suffixes: Any) -> bool:
    return (
        isinstance(suffixes, tuple)
        and bool(suffixes)
        and all(isinstance(item, str) and item and item == Path(f"file{item}").suffix.lower() for item in suffixes)
    )


def _check_function(module: ModuleType, name: str, arguments: int, line: str) -> None:
    function = getattr(module, name, None)
    if not callable(function):
        raise InputError(f"has no function `{name}`", where=str(module.__file__), remedy=f"write `{line}`")
    try:
        inspect.signature(function).bind(*[None] * arguments)
    except TypeError:
        message = f"`{name}` cannot be called with {arguments} argument{'s' if arguments > 1 else ''}"
        raise InputError(message, where=str(module.__file__), remedy=f"write `{line}`") from None


def _check_free(reader: Reader, others: list[Reader]) -> None:
    for other in others:
        for suffix in reader.suffixes:
            if suffix in other.suffixes:
                message = f"the suffix {suffix!r} is taken by the reader `{other.name}`"
                raise InputError(message, where=reader.file, remedy="take it out of SUFFIXES")
        for magic in reader.magic:
            if any(magic.startswith(taken) or taken.startswith(magic) for taken in other.magic):
                message = f"the first bytes {magic!r} are taken by the reader `{other.name}`"
                raise InputError(message, where=reader.file, remedy="take them out of MAGIC: the suffix is enough")


def _origin(entry: EntryPoint) -> str:
    distribution = f" of {entry.dist.name} {entry.dist.version}" if entry.dist else ""
    return f"entry point `{entry.name} = {entry.value}`{distribution}"


def _reason(error: Exception) -> str:
    return str(error) if isinstance(error, InputError) else f"{type(error).__name__}: {error}"


readers = Readers()
