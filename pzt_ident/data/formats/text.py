"""Text tables: CSV, TSV or white space, with or without header, in UTF-8, UTF-16, Windows-1252 or Latin-1, packed by
gzip or not.

`str.split` and `float` take 0.1 to 0.2 s for a file of 1.5 MB and know the line of each value; pandas' C reader takes
0.03 s, and 0.6 s more for its import.
"""

from __future__ import annotations

import codecs
import gzip
import re
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.formats import _analyser
from pzt_ident.data.formats._layout import COMMENTS, GAPS, Layout, detect_layout
from pzt_ident.data.notation import counted
from pzt_ident.data.readers.table import Column, Table
from pzt_ident.data.record import Source
from pzt_ident.errors import InputError

SUFFIXES = (".csv", ".tsv", ".txt", ".dat", ".gz")
FEW = 2  # numbers in a column that read as thousands may be decimals
GZIP = b"\x1f\x8b"
FORTRAN = re.compile(r"(?<=\d)[dD](?=[+-]\d)")
"""The exponent of a double in Fortran: 1.5D-03."""


def read(path: Path, source: Source) -> Table:
    """The columns of a text file; of a file with several tables, those of the table `source.table`."""
    first, lines = _analyser.select_table(_lines(path), source.table, str(path))
    return Table(path, parse(lines, str(path), "line", first))


def parts(path: Path) -> tuple[str, dict[str, str]]:
    """The numbers and titles of the tables of an analyser's export."""
    return "table", _analyser.table_titles(_lines(path))


def _lines(path: Path) -> list[str]:
    raw = path.read_bytes()
    text = decode(gzip.decompress(raw) if raw.startswith(GZIP) else raw)
    if "\0" in text:
        raise InputError("is not a text file (it holds zero bytes)", where=str(path), remedy="save it as UTF-8 text")
    return text.replace("\r\n", "\n").replace("\r", "\n").split("\n")


def decode(raw: bytes, whole: bool = True) -> str:
    """By the byte order mark of UTF-8 or UTF-16; without one, as UTF-8, else as Windows-1252, else as Latin-1. Of what
    is not the whole of a text, the last letter may be cut. Raises UnicodeDecodeError where the mark is wrong."""
    for mark, encoding in (
        (codecs.BOM_UTF8, "utf-8-sig"),
        (codecs.BOM_UTF16_LE, "utf-16"),
        (codecs.BOM_UTF16_BE, "utf-16"),
    ):
        if raw.startswith(mark):
            return _decoded(raw, encoding, whole)
    for encoding in ("utf-8", "cp1252"):
        try:
            return _decoded(raw, encoding, whole)
        except UnicodeDecodeError:
            continue
    return raw.decode("latin-1")


def _decoded(raw: bytes, encoding: str, whole: bool) -> str:
    return codecs.getincrementaldecoder(encoding)().decode(raw, whole)


def parse(lines: Sequence[str], where: str, place: str, first: int = 1, delimiter: str | None = None) -> list[Column]:
    """The columns of the only table in `lines`. `place` is what a line is called in messages (line, row); the first of
    them has the number `first`.

    Raises InputError where there is no table of numbers or where a line has more or fewer fields than the others.
    """
    if FORTRAN.search(lines[len(lines) // 2]):
        lines = [FORTRAN.sub("e", line) for line in lines]
    layout = detect_layout(lines, where, delimiter)
    filled = [i for i in range(layout.start, len(lines)) if lines[i].strip() and not lines[i].startswith(COMMENTS)]
    rows = [lines[i] for i in filled]
    split = layout.splitter(rows)
    for i, row in zip(filled, map(split, rows), strict=True):
        if len(row) != layout.width:
            message = f"{place} {first + i} has {counted(len(row), 'field')} instead of {layout.width}"
            raise InputError(message, where=where, remedy=f"complete the {place} or delete it")

    check_end(rows, layout, lambda row: f"{place} {first + filled[row]}", where)

    def row_place(row: int) -> str:
        return f"row {row} ({place} {first + filled[row]})" if row < len(filled) else f"row {row}"

    def values(k: int) -> NDArray[Any]:
        cells = [row[k] for row in map(split, rows)]
        for mark in ".,":
            check_thousands(cells, mark, row_place, where)
        return _numbers(cells, layout.decimal)

    return [Column(layout.names[k], partial(values, k), None, row_place) for k in range(layout.width)]


def check_end(rows: Sequence[str], layout: Layout, place_of: Callable[[int], str], where: str) -> None:
    """Raises InputError where the last rows begin with a word and those above with a number, as statistics do."""
    begin = [layout.is_number(layout.split(rows[i])[0]) for i in (0, len(rows) // 2, -1)]
    if begin == [True, True, False]:
        word = layout.split(rows[-1])[0].strip()
        problem = f"{place_of(len(rows) - 1)} begins with {word!r}, where those above hold numbers"
        raise InputError(problem, where=where, remedy="delete what is no measurement at the end of the file")


def check_thousands(cells: Sequence[str], mark: str, place_of: Callable[[int], str], where: str) -> None:
    """Raises InputError where whole numbers stand below a thousand without a mark and above it always with
    three digits behind: 999 and 1.000."""
    marked = [row for row, cell in enumerate(cells) if mark in cell]
    grouped = re.compile(rf"\s*[+-]?[1-9]\d{{0,2}}(?:{re.escape(mark)}\d{{3}})+\s*")
    if not FEW < len(marked) < len(cells) or not all(grouped.fullmatch(cells[row]) for row in marked):
        return
    whole = [cell for cell in cells if mark not in cell]
    if all(re.fullmatch(r"\s*[+-]?\d{1,3}\s*", cell) for cell in whole):
        problem = f"{place_of(marked[0])} holds {cells[marked[0]].strip()!r}, which reads as a decimal or as thousands"
        remedy = f"beside {whole[0].strip()!r} it is thousands: export the numbers without a sign between them"
        raise InputError(problem, where=where, remedy=remedy)


def _numbers(cells: Sequence[str], decimal: str) -> NDArray[Any]:
    """The cells as numbers, or as text where one is no number."""
    if decimal != ".":
        cells = [cell.replace(decimal, ".") for cell in cells]
    try:
        if "_" not in "".join(cells):
            return np.array(list(map(float, cells)))
    except ValueError:
        pass
    return np.array(["nan" if cell.strip().lower() in GAPS else cell.strip() for cell in cells], dtype=object)
