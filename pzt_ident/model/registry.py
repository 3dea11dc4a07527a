"""From the word in a job file to the class in the file of that name."""

from __future__ import annotations

import importlib
import importlib.util
import pkgutil
import sys
import warnings
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from functools import cached_property
from importlib.machinery import SourceFileLoader
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from traceback import extract_tb
from types import CodeType, ModuleType
from typing import Any, Generic, NoReturn, Protocol, TypeVar

from pzt_ident.errors import InputError, nearest
from pzt_ident.model.contract import check

T = TypeVar("T", bound=type[Any])


class AsWritten(SourceFileLoader):
    """Loads a file as it is now: bytecode of a file that was mended within the same second, to the same size, passes
    for that of the new one."""

    def get_code(self, fullname: str) -> CodeType:
        return self.source_to_code(self.get_data(self.path), self.path)


class Registry(Generic[T]):
    """Classes by the name of their file. Modules of the packages are imported one by one at the first look-up; others
    add classes by entry points of `group`, or by `register` in a file of their own.

    Raises InputError with the nearest words for an unknown word, and for a word that is claimed twice.
    """

    def __init__(self, kind: str, packages: tuple[str, ...], group: str) -> None:
        self.kind, self.packages, self.group = kind, packages, group
        self._items: dict[str, T] = {}

    def register(self, item: T) -> T:
        """Raises InputError for a class that violates the contract of its kind, or whose word is taken."""
        check(item, self.group)
        package, _, word = item.__module__.rpartition(".")
        taken = word in self._files or self._items.get(word, item).__module__ != item.__module__
        if taken and package not in self.packages:
            self._refuse(word, item.__module__, "rename the module")
        item.name = word
        self._items[word] = item
        return item

    def __getitem__(self, word: str) -> T:
        if word not in self._items or word in self._entries:
            self._load(word)
        if word not in self._items:
            raise InputError(f"unknown {self.kind} {word!r}", remedy=nearest(word, self.words()))
        return self._items[word]

    def __contains__(self, word: str) -> bool:
        return word in self.words()

    def __iter__(self) -> Iterator[T]:
        return (self[word] for word in self.usable())

    def words(self) -> list[str]:
        """Every known word, without importing its module."""
        return sorted({*self._items, *self._files, *self._entries})

    def usable(self, among: Collection[str] | None = None) -> list[str]:
        """The words that can be loaded, of all or of some; warns of faulty entry points."""
        usable = []
        for word in (word for word in self.words() if among is None or word in among):
            try:
                self._load(word)
                usable.append(word)
            except InputError as error:
                warnings.warn(str(error), stacklevel=2)
        return usable

    def modules(self) -> list[str]:
        """The modules of the built-in words."""
        return list(self._files.values())

    @cached_property
    def _files(self) -> dict[str, str]:
        modules = {}
        for package in self.packages:
            for module in pkgutil.iter_modules(importlib.import_module(package).__path__):
                if not module.name.startswith("_"):
                    modules[module.name] = f"{package}.{module.name}"
        return modules

    @cached_property
    def _entries(self) -> dict[str, list[EntryPoint]]:
        entries: dict[str, list[EntryPoint]] = {}
        for entry in entry_points(group=self.group):
            entries.setdefault(entry.name, []).append(entry)
        return entries

    def _load(self, word: str) -> None:
        path, entries = self._files.get(word), self._entries.get(word, [])
        for entry in entries if path else entries[1:]:
            self._refuse(word, described(entry), "give the entry point another name, or uninstall it")
        if path:
            importlib.import_module(path)
        for entry in entries:
            item = load_entry_point(entry)
            if self._items.setdefault(word, item) is not item:
                self._refuse(word, described(entry), "give the entry point another name, or uninstall it")

    def _refuse(self, word: str, where: str, remedy: str) -> NoReturn:
        owner = "a built-in" if word in self._files else "another"
        raise InputError(f"{word!r} is taken by {owner} {self.kind}", where=where, remedy=remedy)


def described(entry: EntryPoint) -> str:
    by = f" of {entry.dist.name} {entry.dist.version}" if entry.dist else ""
    return f"entry point `{entry.name} = {entry.value}`{by}"


def load_entry_point(entry: EntryPoint) -> Any:
    """The object of an entry point. Raises InputError if it cannot be loaded."""
    try:
        return entry.load()
    except Exception as error:
        message = error.message if isinstance(error, InputError) else f"{type(error).__name__}: {error}"
        raise InputError(message, where=described(entry), remedy="repair its package, or uninstall it") from error


def _line(error: Exception, path: Path) -> str:
    """Where in the file it was raised."""
    frames = [frame for frame in extract_tb(error.__traceback__) if frame.filename == str(path.resolve())]
    line = error.lineno if isinstance(error, SyntaxError) else frames[-1].lineno if frames else None
    return f" in line {line}" if line else ""


class Choice(Protocol):
    """A word with the settings beside it: `{name: rod, elements: 16}`."""

    @property
    def name(self) -> str: ...
    @property
    def settings(self) -> Mapping[str, Any]: ...


def form_of(item: str) -> str | None:
    """The form that the item of an effect names: `dahl` of `friction.dahl`; None for its first form."""
    return item.partition(".")[2] or None


def phrase_of(item: str) -> str:
    """The item of an effect in a sentence: `friction (dahl)`; the word alone for its first form."""
    form = form_of(item)
    return f"{word_of(item)} ({form})" if form else item


def word_of(item: str | Choice) -> str:
    """The word of an item of a job: `friction` of `friction.dahl`, and of `{name: friction, ...}`."""
    return item.partition(".")[0] if isinstance(item, str) else item.name


class Blocks(Registry[Any]):
    """Blocks by their words; an effect that has several forms also by word and form, such as `friction.dahl`. The word
    alone is its first form."""

    def __getitem__(self, item: str) -> Any:
        word, _, form = item.partition(".")
        block = super().__getitem__(word)
        return block.make(form=form) if form else block

    def forms(self, effect: str) -> list[str]:
        """The items of all forms of an effect, the first by the word alone."""
        declared = self[word_of(effect)].settings().get("form")
        others = declared.words[1:] if declared else ()
        return [word_of(effect), *(f"{word_of(effect)}.{form}" for form in others)]

    def plug(self, path: Path, is_other: Callable[[ModuleType], bool] = lambda module: False) -> None:
        """Run a Python file of the user, which registers a block of the file's name. `is_other`: whether a module that
        registers none is something else than a block: an optimizer, or a reader of files.

        Raises InputError if there is no such file, it fails, it registers no block, or its name is taken.
        """
        word, where = path.stem, str(path)
        module = f"pzt_ident_plugins.{word}"
        if module in sys.modules and sys.modules[module].__file__ == str(path.resolve()):
            return
        if not path.is_file():
            raise InputError("no such file", where=where, remedy="give the Python file of an effect")
        if not word.isidentifier():
            remedy = "rename the file: letters, digits and _, no digit first"
            raise InputError(f"{word!r} is no word for an effect", where=where, remedy=remedy)
        if word in self.words():
            self._refuse(word, where, "rename the file")
        try:
            self._execute(module, path)
            if word not in self._items and not is_other(sys.modules[module]):
                remedy = "decorate its class with `@blocks.register` or `@optimizers.register`; a reader has `SUFFIXES`"
                raise InputError("registers no block", where=where, remedy=remedy)
        except InputError:
            sys.modules.pop(module, None)
            self._items.pop(word, None)
            raise

    def _execute(self, module: str, path: Path) -> None:
        if path.suffix != ".py":
            raise InputError("is no Python file", where=str(path), remedy="name it `<effect>.py`")
        loader = AsWritten(module, str(path.resolve()))
        spec = importlib.util.spec_from_file_location(module, path.resolve(), loader=loader)
        assert spec
        sys.modules[module] = loaded = importlib.util.module_from_spec(spec)
        try:
            loader.exec_module(loaded)
        except InputError:
            raise
        except Exception as error:
            message = f"{type(error).__name__}{_line(error, path)}: {error}"
            raise InputError(message, where=str(path), remedy="repair the file") from error

    def chain(self, items: Iterable[str | Choice]) -> list[Any]:
        """The blocks of a job's items, with their settings; unknown words are left out.

        Raises InputError for an unknown setting or value.
        """
        known = [item for item in items if word_of(item) in self]
        return [self[item] if isinstance(item, str) else self[item.name].make(**item.settings) for item in known]

    def forms_of(self, items: Iterable[str | Choice]) -> list[Any]:
        """The blocks of a job's items in the forms that these choose; the settings are not checked."""
        known = [item for item in items if word_of(item) in self]
        return [self[word_of(item)].form_of({} if isinstance(item, str) else item.settings) for item in known]

    def effects(self) -> list[str]:
        """The words of all effects."""
        return [word for word in self.usable() if self.is_effect(word)]

    def faults(self) -> list[str]:
        """The words of the effects that are faults of the set-up."""
        return [word for word in self.effects() if self[word].in_setup]

    def is_effect(self, word: str) -> bool:
        """Whether a block may be missing from a model: an effect has a remedy on the rig."""
        return bool(self[word].remedy)

    def folder(self, word: str) -> str:
        """The folder of the file that declares a word's class, for example `hysteresis`."""
        return str(self[word].__module__.rpartition(".")[0].rpartition(".")[2])

    def kind_of(self, word: str) -> str:
        """`effects`, or the folder of a block that a model is made of: `hysteresis`, `mechanics`."""
        return "effects" if self.is_effect(word) else self.folder(word)


blocks = Blocks(
    "block or effect",
    ("pzt_ident.start", "pzt_ident.hysteresis", "pzt_ident.mechanics", "pzt_ident.effects"),
    "pzt_ident.block",
)
optimizers: Registry[Any] = Registry("optimizer", ("pzt_ident.optimizers",), "pzt_ident.optimizer")
