"""A commented job and its measurement, to start from."""

from __future__ import annotations

from collections.abc import Sequence
from importlib.resources import files
from pathlib import Path

from pzt_ident.errors import InputError


def write_example(folder: Path) -> list[Path]:
    """Write the example into a folder; returns the paths of its files, the job first.

    Raises InputError, and writes nothing, where one of the files exists already.
    """
    return write_shipped("start", folder)


def write_shipped(name: str, folder: Path, without: Sequence[str] = ()) -> list[Path]:
    """Write the files of an example, except those in `without`; returns their paths, the job first."""
    if folder.exists() and not folder.is_dir():
        raise InputError("is not a folder", where=str(folder), remedy="give a folder, new or empty")
    shipped = [item for item in files("pzt_ident.job").joinpath("examples", name).iterdir() if item.name not in without]
    items = sorted(shipped, key=lambda item: (item.name != "job.yaml", item.name))
    paths = [folder / item.name for item in items]
    for path in paths:
        if path.exists():
            raise InputError("exists already", where=str(path), remedy="give another folder")
    folder.mkdir(parents=True, exist_ok=True)
    for item, path in zip(items, paths, strict=True):
        path.write_bytes(item.read_bytes())
    return paths
