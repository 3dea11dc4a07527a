"""From the path of a file to its columns, by the reader of its format."""

from __future__ import annotations

import stat
from pathlib import Path

from pzt_ident.data.readers.registry import Parts, Reader, readers
from pzt_ident.data.readers.table import Table
from pzt_ident.data.record import Source
from pzt_ident.errors import InputError, in_words, nearest


def open_table(path: Path, source: Source) -> Table:
    """The columns of a file. Of a text export or a workbook, `source` says which table or sheet.

    Raises InputError where the file is missing, empty, of unknown type or damaged.
    """
    reader = _reader_of(path)
    try:
        table = reader.read(path, source)
    except InputError:
        raise
    except Exception as error:  # a damaged file can raise anything in the library that reads its format
        message = f"cannot be read as {reader.name}: {in_words(error)}"
        remedy = "is it complete, and of the type that its name says?"
        raise InputError(message, where=str(path), remedy=remedy) from error
    if not isinstance(table, Table):
        message = f"`read` returns {type(table).__name__} instead of a Table"
        raise InputError(f"{reader.file}: {message}", where=str(path), remedy="return Table(path, columns)")
    return table


def parts_of(path: Path) -> Parts:
    """The tables or sheets of a file; `("", {})` where it has only one, or is damaged.

    Raises InputError where the file is missing, empty or of unknown type.
    """
    reader = _reader_of(path)
    if reader.parts is None:
        return "", {}
    try:
        key, titles = reader.parts(path)
    except InputError:
        raise
    except Exception:  # opening the file says what is damaged
        return "", {}
    return (key, titles) if len(titles) > 1 else ("", {})


def _reader_of(path: Path) -> Reader:
    try:
        if not stat.S_ISREG(path.stat().st_mode) and not path.is_dir():
            remedy = "save what comes through it into a file first"
            raise InputError("is no file but a pipe or a device", where=str(path), remedy=remedy)
        with path.open("rb") as file:
            is_empty = not file.read(1)
        if is_empty:
            remedy = "was the recording stopped before it was saved?"
            raise InputError("the file is empty", where=str(path), remedy=remedy)
        return readers.find(path)
    except FileNotFoundError:
        raise InputError("no such file", where=str(path), remedy=_similar_file(path)) from None
    except OSError as error:
        remedy = "give a file that can be read"
        raise InputError(error.strerror or "cannot be opened", where=str(path), remedy=remedy) from None


def _similar_file(path: Path) -> str:
    """A remedy for a missing file: the data files of its folder that are named most like it."""
    if not path.parent.is_dir():
        return f"there is no folder {path.parent}"
    suffixes = readers.suffixes()
    files = [item.name for item in path.parent.iterdir() if item.suffix.lower() in suffixes]
    return nearest(path.name, files) if files else f"the folder {path.parent} holds no data file"
