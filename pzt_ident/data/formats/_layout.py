"""How a text table is laid out: delimiter, decimal sign, header, first line of numbers."""

from __future__ import annotations

import csv
import re
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from operator import methodcaller

from pzt_ident.data.units import is_unit
from pzt_ident.errors import InputError

DELIMITERS = ("\t", ";", ",", " ")
COMMENTS = ("#", "%", "//", "!")
FLAGS = 3  # values of a column of flags, which may have no name at the end of a row
NUMBER_AND_UNIT = re.compile(r"[+-]?\d+[.,]?\d*(?:[eE][+-]?\d+)?\s*([^\W\d_]+)")
GAPS = frozenset(("", "nan", "na", "n/a", "#n/a", "null", "none", "-", "--"))


@dataclass(frozen=True)
class Layout:
    """`start`: index of the first line of numbers; `width`: columns; `names`: the header text of each column, or "".

    The delimiter " " stands for any white space.
    """

    delimiter: str
    decimal: str
    start: int = 0
    width: int = 0
    names: tuple[str, ...] = ()

    def split(self, line: str) -> list[str]:
        if '"' in line:
            line = line.strip() if self.delimiter == " " else line
            return next(csv.reader([line], delimiter=self.delimiter, skipinitialspace=True))
        return line.split() if self.delimiter == " " else line.split(self.delimiter)

    def splitter(self, lines: Iterable[str]) -> Callable[[str], list[str]]:
        """`split`, without its search for quotes where no line has any."""
        if any('"' in line for line in lines):
            return self.split
        return methodcaller("split", None if self.delimiter == " " else self.delimiter)

    def is_number(self, cell: str) -> bool:
        """Whether a cell holds a number, a gap included."""
        try:
            float(cell.replace(self.decimal, "."))
        except ValueError:
            return cell.strip().lower() in GAPS
        return True


def detect_layout(lines: Sequence[str], where: str, delimiter: str | None = None) -> Layout:
    """The layout of the table in `lines`, judged by up to 100 lines from the middle of the file on.

    Raises InputError where there are no two lines of numbers, and says so where there is one.
    """
    filled = [i for i, line in enumerate(lines) if line.strip()]
    sample = [lines[i] for i in filled[len(filled) // 2 :][:100] if not lines[i].startswith(COMMENTS)]
    layout = _punctuation(sample, delimiter)
    rows = [layout.split(line) for line in sample]
    width = Counter(map(len, rows)).most_common(1)[0][0] if rows else 0
    full = [row for row in rows if len(row) == width]
    numeric = [k for k in range(width) if 2 * sum(layout.is_number(row[k]) for row in full) > len(full)]
    data = [i for i in filled if not lines[i].startswith(COMMENTS)]
    start = _start(lines, data, layout, width, numeric)
    if start is None:
        alone = any(_is_complete(layout.split(lines[i]), layout, width, range(width)) for i in data)
        problem = "holds one row of numbers" if alone else "holds no table of numbers"
        remedy = "was the recording stopped before it was saved?" if alone else no_table_remedy(sample)
        raise InputError(problem, where=where, remedy=remedy)
    above = [lines[i].lstrip("".join(COMMENTS) + " ") for i in filled if i < start]
    names = _names(above, layout, width)
    surplus = [{row[k].strip() for row in full} for k in numeric if k >= len(names)]
    if names and any(len(values) > min(FLAGS, len(full) / 2) and "" not in values for values in surplus):
        names = _beside_row_names(names, full, width, where)
    return Layout(layout.delimiter, layout.decimal, start, width, (*names, *[""] * (width - len(names))))


def no_table_remedy(lines: Sequence[str]) -> str:
    """What may help where the fields of lines are no numbers."""
    cells = [cell.strip() for line in lines for cell in re.split(r"[,;\t]", line)]
    with_unit = (cell for cell in cells if (match := NUMBER_AND_UNIT.fullmatch(cell)) and is_unit(match[1]))
    if cell := next(with_unit, None):
        return f"it holds {cell!r}: put the unit into the header, as in `x [um]`, and leave it out of every line"
    return "is it the right file, sheet or table?"


def _punctuation(sample: Sequence[str], delimiter: str | None) -> Layout:
    layouts = [Layout(mark, decimal) for mark in ([delimiter] if delimiter else DELIMITERS) for decimal in ".,"]

    def numbers_minus_words(layout: Layout) -> int:
        cells = (cell for line in sample for cell in layout.split(line) if cell.strip())
        return sum(1 if layout.is_number(cell) else -1 for cell in cells)

    return max((layout for layout in layouts if layout.delimiter != layout.decimal), key=numbers_minus_words)


def _is_complete(row: Sequence[str], layout: Layout, width: int, numeric: Sequence[int]) -> bool:
    """Whether a line holds numbers, gaps included, in all columns of numbers."""
    filled = len(row) == width and any(row[k].strip() for k in numeric)
    return filled and all(layout.is_number(row[k]) for k in numeric)


def _start(lines: Sequence[str], data: Sequence[int], layout: Layout, width: int, numeric: Sequence[int]) -> int | None:
    """The first of two lines of numbers, or a line above it that is no header. data: the lines that are no comments."""

    def is_complete(i: int) -> bool:
        return _is_complete(layout.split(lines[i]), layout, width, numeric)

    def is_partial(i: int) -> bool:
        row = layout.split(lines[i])
        numbers = [cell.strip() != "" and layout.is_number(cell) for cell in row]
        torn = len(row) > 1 and all(numbers)  # of another width: who parses it says so
        return (torn or (len(row) == width and any(numbers))) and not _are_units(row)

    rows: list[int] = []
    for i in data:
        rows.append(i)
        if len(rows) > 1 and is_complete(rows[-1]) and is_complete(rows[-2]):
            break
    else:
        return None
    start = len(rows) - 2
    while start > 0 and is_partial(rows[start - 1]):
        start -= 1
    return rows[start]


def _names(above: Sequence[str], layout: Layout, width: int) -> tuple[str, ...]:
    """Header texts from the lines `above` the numbers, joined with the units of a second header line; fewer than there
    are columns where the last have none, and none without a header."""
    last = _fields(above[-1], layout, width) if above else []
    first = _fields(above[-2], layout, width) if len(above) > 1 and _are_units(last) else []
    if len(first) == len(last) and _are_names(first):
        return tuple(f"{name} [{unit.strip('[]()- ')}]" for name, unit in zip(first, last, strict=True))
    return tuple(last) if _are_names(last) else ()


def _beside_row_names(names: tuple[str, ...], rows: Sequence[Sequence[str]], width: int, where: str) -> tuple[str, ...]:
    """The names of columns where those of numbers are more: that of the first is missing where it counts the rows.
    Raises InputError where it does not and the names have units: none says which column is meant."""
    if width == len(names) + 1 and _counts(row[0] for row in rows):
        return ("", *names)
    if not any(re.search(r"[\[(].+[\])]$", name) for name in names):
        return ()
    problem = f"the header names {len(names)} columns, and the rows have {width}"
    remedy = "name every column; where a comma is the decimal sign, export with semicolons between the columns"
    raise InputError(problem, where=where, remedy=remedy)


def _counts(cells: Iterable[str]) -> bool:
    """Whether cells are whole numbers, each one more than the one before."""
    texts = [cell.strip() for cell in cells]
    numbers = [int(text) for text in texts if text.isdigit()]
    return len(numbers) == len(texts) and all(b - a == 1 for a, b in pairwise(numbers))


def _fields(line: str, layout: Layout, width: int) -> list[str]:
    """The cells of a header line, by the delimiter of the numbers or another one that gives as many cells, without the
    empty ones at its end."""
    for delimiter in (layout.delimiter, *DELIMITERS):
        if delimiter == " " and '"' not in line:
            cells = re.findall(r"\S+(?:\s*[\[(][^\])]*[\])])?", line)
        else:
            cells = [cell.strip() for cell in Layout(delimiter, ".").split(line)]
        while cells and not cells[-1]:
            cells.pop()
        if 2 * sum(map(bool, cells)) >= width >= len(cells):
            return cells
    return []


def _are_names(cells: Sequence[str]) -> bool:
    return bool(cells) and not any(re.fullmatch(r"[+-]?[\d.,]+(?:[eE][+-]?\d+)?", cell) for cell in cells)


def _are_units(cells: Iterable[str]) -> bool:
    """Whether the cells are the units of a second header line: `1` is one, other numbers are not."""
    units = [unit for cell in cells if (unit := cell.strip("[]()- "))]
    return any(unit != "1" for unit in units) and all(unit == "1" or _is_word_unit(unit) for unit in units)


def _is_word_unit(text: str) -> bool:
    return not text[0].isdigit() and is_unit(text)
