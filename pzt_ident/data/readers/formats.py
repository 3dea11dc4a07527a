"""From the name of a file to the reader of its format."""

from __future__ import annotations

import importlib
from pathlib import Path

from pzt_ident.data.readers.column import Table
from pzt_ident.data.record import Source
from pzt_ident.errors import InputError, nearest

READERS = {
    ".csv": "text",
    ".tsv": "text",
    ".txt": "text",
    ".dat": "text",
    ".mat": "mat",
    ".h5": "hdf5",
    ".hdf5": "hdf5",
    ".nc": "hdf5",
    ".npy": "npy",
    ".tdms": "tdms",
    ".parquet": "parquet",
    ".xlsx": "excel",
    ".xlsm": "excel",
    ".xlsb": "excel",
    ".xls": "excel",
    ".ods": "excel",
}
_BEGINNINGS = {
    b"\x89HDF\r\n\x1a\n": "hdf5",
    b"\x93NUMPY": "npy",
    b"MATLAB ": "mat",
    b"TDSm": "tdms",
    b"PAR1": "parquet",
    b"PK\x03\x04": "excel",
    b"\xd0\xcf\x11\xe0": "excel",
}


def open_table(path: Path, source: Source) -> Table:
    """The columns of a file. Of a text export or a workbook, `source` says which table or sheet.

    Raises InputError where the file is missing, empty, of unknown type or damaged.
    """
    word = _format(path)
    reader = importlib.import_module(f"pzt_ident.data.readers.{word}")
    try:
        return reader.read(path, source)
    except InputError:
        raise
    except Exception as error:  # a damaged file can raise anything in the library that reads its format
        message = f"cannot be read as {word}: {str(error) or type(error).__name__}"
        raise InputError(
            message, where=str(path), remedy="is it complete, and of the type that its name says?"
        ) from error


def parts_of(path: Path) -> tuple[str, dict[str, str]]:
    """The key of a job by which one of several tables or sheets of a file is taken, and what it may be, with its
    name; nothing where the file has only one. Raises InputError as `open_table` does."""
    reader = importlib.import_module(f"pzt_ident.data.readers.{_format(path)}")
    try:
        found: tuple[str, dict[str, str]] = reader.parts(path) if hasattr(reader, "parts") else ("", {})
    except InputError:
        raise
    except Exception:  # what is damaged is said when it is opened
        return "", {}
    return found if len(found[1]) > 1 else ("", {})


def _format(path: Path) -> str:
    """By the suffix; what that calls text, or no suffix that is known, by the first bytes."""
    beginning = _beginning(path)
    word = READERS.get(path.suffix.lower(), "text")
    if word != "text":
        return word
    return next((word for magic, word in _BEGINNINGS.items() if beginning.startswith(magic)), "text")


def _beginning(path: Path) -> bytes:
    try:
        with path.open("rb") as file:
            beginning = file.read(16)
    except FileNotFoundError:
        raise InputError("no such file", where=str(path), remedy=_missing(path)) from None
    except OSError as error:
        remedy = "give a file that can be read"
        raise InputError(error.strerror or "cannot be opened", where=str(path), remedy=remedy) from None
    if not beginning:
        raise InputError("the file is empty", where=str(path), remedy="was the recording stopped before it was saved?")
    return beginning


def _missing(path: Path) -> str:
    if not path.parent.is_dir():
        return f"there is no folder {path.parent}"
    files = [item.name for item in path.parent.iterdir() if item.suffix.lower() in READERS]
    return nearest(path.name, files) if files else f"the folder {path.parent} holds no data file"
