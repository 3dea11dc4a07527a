"""The files of code that a job brings: blocks, optimizers and readers of file formats."""

from __future__ import annotations

from pathlib import Path
from types import ModuleType

from pzt_ident.model.registry import blocks, optimizers


def plug(path: Path) -> None:
    """Run a file of the user's. Raises InputError where it fails, or declares no block, optimizer or reader."""
    blocks.plug(path, _is_other)


def _is_other(module: ModuleType) -> bool:
    from pzt_ident.data.readers.registry import readers

    word = module.__name__.rpartition(".")[2]
    is_optimizer = word in optimizers and optimizers[word].__module__ == module.__name__
    return is_optimizer or readers.add_declared(module)
