"""From the word in a job file to the thing in the file of that name."""

from __future__ import annotations

import importlib
import importlib.util
import pkgutil
import sys
from collections.abc import Iterable, Iterator, Mapping
from functools import cached_property
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from typing import Any, Generic, Protocol, TypeVar

from pzt_ident.errors import InputError, nearest
from pzt_ident.model.contract import check

T = TypeVar("T", bound=type[Any])


class Registry(Generic[T]):
    """Classes by their file's name. Folders are imported word by word at the first look-up; others add theirs by
    entry points of `group`, or by `register` in a file of theirs.

    Raises InputError with the nearest words for an unknown one.
    """

    def __init__(self, kind: str, packages: tuple[str, ...], group: str) -> None:
        self.kind, self.packages, self.group = kind, packages, group
        self._items: dict[str, T] = {}

    def register(self, item: T) -> T:
        """Raises InputError for a class that breaks the contract of its kind."""
        check(item, self.group)
        item.name = item.__module__.rpartition(".")[2]
        self._items[item.name] = item
        return item

    def __getitem__(self, word: str) -> T:
        if word not in self._items:
            self._load(word)
        if word not in self._items:
            raise InputError(f"unknown {self.kind} {word!r}", remedy=nearest(word, self.words()))
        return self._items[word]

    def __contains__(self, word: str) -> bool:
        return word in self.words()

    def __iter__(self) -> Iterator[T]:
        return (self[word] for word in self.words())

    def words(self) -> list[str]:
        """Every known word, without importing what stands behind it."""
        return sorted(set(self._items) | set(self._files()) | {entry.name for entry in self._entries})

    def folder(self, word: str) -> str:
        """The last part of the package that the word's class was declared in, for example `effects`."""
        return self[word].__module__.rpartition(".")[0].rpartition(".")[2]

    def _files(self) -> dict[str, str]:
        found = {}
        for package in self.packages:
            for module in pkgutil.iter_modules(importlib.import_module(package).__path__):
                if not module.name.startswith("_"):
                    found[module.name] = f"{package}.{module.name}"
        return found

    @cached_property
    def _entries(self) -> tuple[EntryPoint, ...]:
        return tuple(entry_points(group=self.group))

    def _load(self, word: str) -> None:
        if path := self._files().get(word):
            importlib.import_module(path)
        for entry in self._entries:
            if entry.name == word:
                self._items[word] = entry.load()


class Choice(Protocol):
    """A word with the settings beside it: `{name: rod, elements: 16}`."""

    @property
    def name(self) -> str: ...
    @property
    def settings(self) -> Mapping[str, Any]: ...


def word_of(item: str | Choice) -> str:
    return item if isinstance(item, str) else item.name


class Blocks(Registry[Any]):
    def plug(self, path: Path) -> None:
        """Run a file of the user's, which registers the block that it is named like.

        Raises InputError where there is no such file, it fails, it registers nothing, or its name is taken.
        """
        word, where = path.stem, str(path)
        module = f"pzt_ident_plugins.{word}"
        if module in sys.modules and sys.modules[module].__file__ == str(path.resolve()):
            return
        if not path.is_file():
            raise InputError("no such file", where=where, remedy="give the Python file of an effect")
        if word in self.words() or not word.isidentifier():
            raise InputError(f"{word!r} cannot name an effect", where=where, remedy="rename the file")
        self._execute(module, path)
        if word not in self._items:
            raise InputError("registers no block", where=where, remedy="decorate its class with `@blocks.register`")

    def _execute(self, module: str, path: Path) -> None:
        spec = importlib.util.spec_from_file_location(module, path.resolve())
        if spec is None or spec.loader is None:
            raise InputError("is no Python file", where=str(path), remedy="name it `<effect>.py`")
        sys.modules[module] = made = importlib.util.module_from_spec(spec)
        try:
            spec.loader.exec_module(made)
        except Exception as error:
            del sys.modules[module]
            raise InputError(f"{type(error).__name__}: {error}", where=str(path), remedy="mend the file") from error

    def chain(self, items: Iterable[str | Choice]) -> list[Any]:
        """The blocks of a job's items, as their settings make them; an effect that is only a term has none.

        Raises InputError for an unknown setting, or one that does not fit.
        """
        known = [item for item in items if word_of(item) in self]
        return [self[item] if isinstance(item, str) else self[item.name].make(**item.settings) for item in known]

    def formed(self, items: Iterable[str | Choice]) -> list[Any]:
        """The blocks of a job's items in the forms that these choose, whether or not their settings fit."""
        known = [item for item in items if word_of(item) in self]
        return [self[word_of(item)].formed({} if isinstance(item, str) else item.settings) for item in known]

    def effects(self) -> list[str]:
        """The words of what may be missing from a model."""
        return [word for word in self.words() if self.is_effect(word)]

    def is_effect(self, word: str) -> bool:
        """Whether a block may be missing from a model: it says what to do about it on the rig."""
        return bool(self[word].remedy)

    def kind_of(self, word: str) -> str:
        """`effects`, or the folder of a block that a model is made of: `hysteresis`, `mechanics`."""
        return "effects" if self.is_effect(word) else self.folder(word)


blocks = Blocks(
    "block or effect", ("pzt_ident.hysteresis", "pzt_ident.mechanics", "pzt_ident.effects"), "pzt_ident.block"
)
optimizers: Registry[Any] = Registry("optimizer", ("pzt_ident.optimizers",), "pzt_ident.optimizer")
