"""Workbooks (xlsx, xls, xlsb, ods): one sheet, laid out like a text table."""

from __future__ import annotations

import io
import re
import zipfile
from pathlib import Path
from typing import TYPE_CHECKING
from xml.etree import ElementTree

from pzt_ident.data.formats.text import parse
from pzt_ident.data.readers.table import Table
from pzt_ident.data.record import Source
from pzt_ident.errors import InputError, nearest

if TYPE_CHECKING:
    from python_calamine import CalamineWorkbook

SUFFIXES = (".xlsx", ".xlsm", ".xlsb", ".xls", ".ods")
MAGIC = (b"PK\x03\x04", b"\xd0\xcf\x11\xe0")


MOST_CELLS = 20_000_000
"""Of a sheet from its first cell to its last: its reader keeps them all, empty ones too, and takes the process along
where they do not fit into memory."""
PARTS = {"[Content_Types].xml", "mimetype"}
"""Of a workbook that is an archive, one or the other."""
CELL = re.compile(rb'<c\b[^>]*?\br="([A-Z]{1,3})(\d{1,7})"')


def parts(path: Path) -> tuple[str, dict[str, str]]:
    """The sheets of a workbook."""
    return "sheet", {name: name for name in _book(path).sheet_names}


def read(path: Path, source: Source) -> Table:
    """The columns of the sheet `source.sheet`, of the first one where the job names none."""
    if zipfile.is_zipfile(path) and not PARTS & {*zipfile.ZipFile(path).namelist()}:
        raise InputError("is an archive and no workbook", where=str(path), remedy="unpack it, and name a file of it")
    book = _book(path)
    sheet = source.sheet or book.sheet_names[0]
    if sheet not in book.sheet_names:
        raise InputError(f"has no sheet {sheet!r}", where=str(path), remedy=nearest(sheet, book.sheet_names))
    _check_size(path, sheet)
    rows = book.get_sheet_by_name(sheet).to_python(skip_empty_area=False)
    lines = ["\t".join(" ".join(str(cell).split()) for cell in row) for row in rows]
    return Table(path, parse(lines, f"{path}: sheet {sheet!r}", "row", delimiter="\t"))


def _book(path: Path) -> CalamineWorkbook:
    """A workbook of the kind that its content says, whatever its name does."""
    from python_calamine import CalamineWorkbook

    return CalamineWorkbook.from_filelike(io.BytesIO(path.read_bytes()))


def _check_size(path: Path, sheet: str) -> None:
    """Raises InputError where the cells of a sheet of an .xlsx are spread too far."""
    columns = rows = 0
    for letters, digits in CELL.findall(_xml_of(path, sheet)):
        columns, rows = max(columns, _number(letters)), max(rows, int(digits))
    if columns * rows > MOST_CELLS:
        problem = f"sheet {sheet!r} has cells as far as row {rows} and column {columns}"
        raise InputError(problem, where=str(path), remedy="delete what is beside the table, or save it as CSV")


def _xml_of(path: Path, sheet: str) -> bytes:
    """The cells of a sheet as an .xlsx has them; nothing for other workbooks."""
    if not zipfile.is_zipfile(path):
        return b""
    with zipfile.ZipFile(path) as book:
        if "xl/workbook.xml" not in book.namelist():
            return b""
        named = {
            element.get("name"): element for element in ElementTree.fromstring(book.read("xl/workbook.xml")).iter()
        }
        place = next((value for key, value in named[sheet].items() if key.endswith("}id")), None)
        links = ElementTree.fromstring(book.read("xl/_rels/workbook.xml.rels"))
        target = next((str(link.get("Target")) for link in links if link.get("Id") == place), "")
        name = target.removeprefix("/") if target.startswith("/") else f"xl/{target}"
        return book.read(name) if name in book.namelist() else b""


def _number(letters: bytes) -> int:
    """The number of a column: 1 of A, 27 of AA."""
    number = 0
    for letter in letters:
        number = 26 * number + letter - 64
    return number
