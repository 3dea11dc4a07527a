"""Text exports of ferroelectric and piezo analysers: several tables in one file.

A table is a line `Table 3`, lines `key: value` and rows of numbers, up to an empty line. The summary of the tables at
the head of the file may have such a heading too, but has no `key: value` lines.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from pzt_ident.errors import InputError, nearest

_HEADING = re.compile(r"Table (\d+)\s*$")


def select_table(lines: Sequence[str], wanted: int | str | None, where: str) -> tuple[int, Sequence[str]]:
    """Number of the first line, from 1, and the lines of the wanted table; all lines of a file without headings.

    `wanted` is the table's number, its heading `Table 3` or its `SampleName`; a file with one table needs none.
    Raises InputError where it is unknown, or none of several is named.
    """
    blocks = _blocks(lines)
    if not blocks and wanted is None:
        return 1, lines
    if not blocks:
        raise InputError(f"has no tables with numbers, so no {wanted!r}", where=where, remedy="leave `table` out")
    titles = {number: _titles(number, lines[first:last]) for number, (first, last) in blocks.items()}
    matches = [number for number in blocks if (len(blocks) == 1 and wanted is None) or str(wanted) in titles[number]]
    if len(matches) != 1:
        several = f"{len(matches or blocks)} tables" if matches or wanted is None else "no table"
        named = "" if wanted is None else f" {wanted!r}"
        known = [title for number in matches or blocks for title in titles[number][1:]]
        remedy = f"choose one, such as `table: {(matches or list(blocks))[0]}`; {nearest(str(wanted), known)}"
        raise InputError(f"has {several}{named}", where=where, remedy=remedy)
    first, last = blocks[matches[0]]
    return first + 1, lines[first:last]


def table_titles(lines: Sequence[str]) -> dict[str, str]:
    """The heading of each table with its `SampleName`, by its number."""
    blocks = {number: _titles(number, lines[first:last]) for number, (first, last) in _blocks(lines).items()}
    return {number: ": ".join(headings) for number, *headings in blocks.values()}


def _blocks(lines: Sequence[str]) -> dict[int, tuple[int, int]]:
    """First and last line of each table by its number; of two with one number, that with `key: value` lines."""
    blocks: dict[int, tuple[int, int]] = {}
    for i, line in enumerate(lines):
        if line.startswith("Table ") and (heading := _HEADING.match(line)):
            last = next((j for j in range(i, len(lines)) if not lines[j].strip()), len(lines))
            number = int(heading[1])
            if number not in blocks or ":" in lines[min(i + 1, last - 1)]:
                blocks[number] = (i, last)
    return blocks


def _titles(number: int, lines: Sequence[str]) -> list[str]:
    samples = [line.partition(":")[2].strip() for line in lines if line.startswith("SampleName:")]
    return [str(number), f"Table {number}", *samples]
