"""Workbooks (xlsx, xls, xlsb, ods): one sheet, laid out like a text table."""

from __future__ import annotations

from pathlib import Path

from pzt_ident.data.formats.text import parse
from pzt_ident.data.readers.table import Table
from pzt_ident.data.record import Source
from pzt_ident.errors import InputError, nearest

SUFFIXES = (".xlsx", ".xlsm", ".xlsb", ".xls", ".ods")
MAGIC = (b"PK\x03\x04", b"\xd0\xcf\x11\xe0")


def parts(path: Path) -> tuple[str, dict[str, str]]:
    """The sheets of a workbook."""
    from python_calamine import CalamineWorkbook

    return "sheet", {name: name for name in CalamineWorkbook.from_path(path).sheet_names}


def read(path: Path, source: Source) -> Table:
    """The columns of the sheet `source.sheet`, of the first one where the job names none."""
    from python_calamine import CalamineWorkbook

    book = CalamineWorkbook.from_path(path)
    sheet = source.sheet or book.sheet_names[0]
    if sheet not in book.sheet_names:
        raise InputError(f"has no sheet {sheet!r}", where=str(path), remedy=nearest(sheet, book.sheet_names))
    rows = book.get_sheet_by_name(sheet).to_python(skip_empty_area=False)
    lines = ["\t".join(" ".join(str(cell).split()) for cell in row) for row in rows]
    return Table(path, parse(lines, f"{path}: sheet {sheet!r}", "row", delimiter="\t"))
