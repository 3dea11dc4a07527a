"""The files of code that a job brings: blocks and readers of file formats."""

from __future__ import annotations

from pathlib import Path

from pzt_ident.model.registry import blocks


def plug(path: Path) -> None:
    """Run a file of the user's. Raises InputError where it fails, or declares neither a block nor a reader."""
    blocks.plug(path, _is_reader)


def _is_reader(module: object) -> bool:
    from pzt_ident.data.readers.registry import readers

    return readers.add_declared(module)
