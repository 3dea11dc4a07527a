"""Modules of other libraries without all that their packages import beside them."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from functools import cache
from importlib import import_module
from importlib.machinery import PathFinder
from importlib.util import find_spec, module_from_spec
from itertools import accumulate
from threading import RLock
from types import ModuleType

_lock = RLock()


@cache
def extension(package: str, name: str) -> ModuleType:
    """A compiled module of a package, which needs nothing of it: LAPACK's functions are there after 7 ms of CPU, with
    scipy.linalg after 70. It is another one than who imports the package gets."""
    home = find_spec(package)
    spec = PathFinder.find_spec(name, home.submodule_search_locations) if home else None
    assert spec and spec.loader
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@cache
def modules(*names: str, beside: ModuleType | None = None) -> tuple[ModuleType, ...]:
    """Modules of a package that is installed, each there once for every caller of the same names.

    The packages around them stand empty while they are imported, with `beside` in the place of the module of its name.
    Who imports the packages, before or later, gets them as they are.
    """
    with _lock:
        parts = [*names, beside.__name__] if beside else names
        packages = dict.fromkeys(package for name in parts for package in list(accumulate(name.split("."), _join))[:-1])
        before = _taken(packages)
        for package in packages:
            spec = find_spec(package)
            assert spec
            sys.modules[package] = module_from_spec(spec)
        if beside:
            sys.modules[beside.__name__] = beside
        try:
            return tuple(import_module(name) for name in names)
        finally:
            _taken(packages)
            sys.modules.update(before)


def _taken(packages: Iterable[str]) -> dict[str, ModuleType]:
    """What is imported of packages, which is imported no more."""
    heads = tuple(f"{package}." for package in packages)
    names = [name for name in sys.modules if f"{name}.".startswith(heads)]
    return {name: sys.modules.pop(name) for name in names}


def _join(package: str, name: str) -> str:
    return f"{package}.{name}"
