"""Malformed data files: mutations of cells, lines, arrays and bytes, and what must come of each."""

from __future__ import annotations

from typing import Any

import numpy as np

from experiments.trust import mutants
from experiments.trust.files import TEXTS, Cells, binary, cells_of, delimiter_of, raw, text_of
from experiments.trust.good import Columns
from experiments.trust.mutants import BYTES, READ, REFUSE, SAME, Kind, Mutant, Random, kind

CELLS: Kind = {}
LINES: Kind = {}
ARRAYS: Kind = {}


def mutant(form: str, columns: Columns, rng: Random) -> Mutant:
    """A mutation by chance of the file of a good measurement."""
    some = (BYTES, 0.4, lambda: raw(columns, form), bytes)
    if form not in TEXTS:
        return mutants.mutant([some, (ARRAYS, 0.6, lambda: copied(columns), lambda made: binary(made, form))], rng)
    cells = (CELLS, 0.3, lambda: cells_of(columns, form), lambda made: text_of(made, delimiter_of(form)))
    return mutants.mutant([some, cells, (LINES, 0.3, lambda: raw(columns, form).decode(), str)], rng)


def copied(columns: Columns) -> Columns:
    return {name: values.copy() for name, values in columns.items()}


def head_of(cells: Cells) -> int:
    """Rows of it."""
    return "[" in cells[0][0]


def row_by_chance(cells: Cells, rng: Random) -> int:
    return int(rng.integers(head_of(cells) + 2, len(cells) - 2))


@kind(CELLS)
def cell_of_text(cells: Cells, rng: Random) -> Any:
    row, column = row_by_chance(cells, rng), int(rng.integers(3))
    word = str(rng.choice(["ERROR", "overflow", "1.2.3", "0x1F", "1e", "#REF!", "12:30", "1_000"]))
    cells[row][column] = word
    return cells, REFUSE, word


@kind(CELLS)
def cell_without_number(cells: Cells, rng: Random) -> Any:
    row, column = row_by_chance(cells, rng), int(rng.integers(3))
    cells[row][column] = str(rng.choice(["nan", "NaN", "inf", "-inf", "Infinity"]))
    return cells, REFUSE


@kind(CELLS)
def cell_empty(cells: Cells, rng: Random) -> Any:
    cells[row_by_chance(cells, rng)][int(rng.integers(3))] = str(rng.choice(["", "--"]))
    return cells, REFUSE


@kind(CELLS)
def cell_beyond_measure(cells: Cells, rng: Random) -> Any:
    value = str(rng.choice(["1e300", "-1e300", "1e400", "-1e18", "9" * 400]))
    cells[row_by_chance(cells, rng)][int(rng.integers(3))] = value
    return cells, REFUSE


@kind(CELLS)
def field_missing(cells: Cells, rng: Random) -> Any:
    del cells[row_by_chance(cells, rng)][int(rng.integers(3))]
    return cells, REFUSE


@kind(CELLS)
def field_more(cells: Cells, rng: Random) -> Any:
    cells[row_by_chance(cells, rng)].insert(int(rng.integers(4)), "7")
    return cells, REFUSE


@kind(CELLS)
def row_missing(cells: Cells, rng: Random) -> Any:
    del cells[row_by_chance(cells, rng)]
    return cells, REFUSE


@kind(CELLS)
def row_twice(cells: Cells, rng: Random) -> Any:
    row = row_by_chance(cells, rng)
    cells.insert(row, cells[row])
    return cells, REFUSE


@kind(CELLS)
def rows_shuffled(cells: Cells, rng: Random) -> Any:
    header = head_of(cells)
    rows = cells[header:]
    return cells[:header] + [rows[i] for i in rng.permutation(len(rows))], REFUSE


@kind(CELLS)
def rows_backwards(cells: Cells, rng: Random) -> Any:
    header = head_of(cells)
    return cells[:header] + cells[header:][::-1], REFUSE


@kind(CELLS)
def few_rows(cells: Cells, rng: Random) -> Any:
    header = head_of(cells)
    return cells[: header + int(rng.integers(0, 3))], REFUSE


@kind(CELLS)
def column_missing(cells: Cells, rng: Random) -> Any:
    column = int(rng.integers(3))
    return [row[:column] + row[column + 1 :] for row in cells], REFUSE


@kind(CELLS)
def column_more(cells: Cells, rng: Random) -> Any:
    header = head_of(cells)
    return [[*row, "note [1]" if header and i == 0 else "1.5"] for i, row in enumerate(cells)], SAME


@kind(CELLS)
def constant_response(cells: Cells, rng: Random) -> Any:
    header = head_of(cells)
    return cells[:header] + [[*row[:2], "1.5"] for row in cells[header:]], REFUSE


@kind(CELLS)
def time_stands_still(cells: Cells, rng: Random) -> Any:
    header = head_of(cells)
    return cells[:header] + [["0.5", *row[1:]] for row in cells[header:]], REFUSE


@kind(CELLS)
def time_jumps(cells: Cells, rng: Random) -> Any:
    row = row_by_chance(cells, rng)
    later = [[repr(float(line[0]) + 0.5), *line[1:]] for line in cells[row:]]
    return cells[:row] + later, REFUSE


@kind(CELLS)
def one_stamp_off(cells: Cells, rng: Random) -> Any:
    row = row_by_chance(cells, rng)
    cells[row][0] = repr(float(cells[row][0]) + 0.01)
    return cells, REFUSE


for alike in (mutants.carriage_returns, mutants.byte_order_mark, mutants.without_last_newline):
    kind(LINES)(alike)


@kind(LINES)
def last_line_torn(text: str, rng: Random) -> Any:
    return text[: len(text) - int(rng.integers(3, 12))], READ


@kind(LINES)
def blank_lines_behind(text: str, rng: Random) -> Any:
    return text + "\n" * int(rng.integers(1, 9)), SAME


@kind(LINES)
def title_ahead(text: str, rng: Random) -> Any:
    return "Measurement of May\n" + text, SAME


@kind(LINES)
def comment_ahead(text: str, rng: Random) -> Any:
    return "# measured in May, 23 degrees\n" + text, SAME


@kind(LINES)
def header_twice(text: str, rng: Random) -> Any:
    lines = text.splitlines()
    return "\n".join([*lines[:40], lines[0] if "[" in lines[0] else "time u x", *lines[40:]]) + "\n", REFUSE


@kind(LINES)
def unit_of_another_kind(text: str, rng: Random) -> Any:
    if "[" not in text:
        return text.replace("\n", "\n\n", 1), READ
    old = str(rng.choice(["[s]", "[V]", "[um]"]))
    return text.replace(old, "[kg]", 1), REFUSE, "kg"


@kind(LINES)
def unit_that_is_none(text: str, rng: Random) -> Any:
    if "[" not in text:
        return text + "\x1a", READ
    old = str(rng.choice(["[s]", "[V]", "[um]"]))
    return text.replace(old, "[furlong]", 1), REFUSE, "furlong"


@kind(LINES)
def decimal_commas(text: str, rng: Random) -> Any:
    if "," in text:
        return text.replace(",", ";").replace(".", ","), SAME
    return text.replace(".", ","), SAME


@kind(LINES)
def quoted(text: str, rng: Random) -> Any:
    return "".join(
        ",".join(f'"{cell}"' for cell in line.split(",")) + "\n" for line in text.splitlines()
    ), SAME if "," in text else READ


@kind(LINES)
def blanks_around(text: str, rng: Random) -> Any:
    return text.replace(",", " , "), SAME


@kind(LINES)
def form_feeds(text: str, rng: Random) -> Any:
    place = int(rng.integers(len(text)))
    return text[:place] + "\x0c\x00\x1b[31m" + text[place:], READ


@kind(LINES)
def latin_1(text: str, rng: Random) -> Any:
    return text.replace("[um]", "[µm]").encode("latin-1"), SAME


@kind(LINES)
def long_line(text: str, rng: Random) -> Any:
    lines = text.splitlines()
    lines[len(lines) // 2] += " 0" * 200_000
    return "\n".join(lines) + "\n", REFUSE


@kind(ARRAYS)
def value_without_number(columns: Columns, rng: Random) -> Any:
    values = list(columns.values())[rng.integers(3)]
    values[rng.integers(2, values.size - 2)] = (np.nan, np.inf, -np.inf, 1e300)[rng.integers(4)]
    return columns, REFUSE


@kind(ARRAYS)
def stamp_twice(columns: Columns, rng: Random) -> Any:
    t = columns["time [s]"]
    t[30] = t[29]
    return columns, REFUSE


@kind(ARRAYS)
def constant(columns: Columns, rng: Random) -> Any:
    columns["x [um]"][:] = 2.5
    return columns, REFUSE


@kind(ARRAYS)
def no_samples(columns: Columns, rng: Random) -> Any:
    left = int(rng.integers(0, 3))
    return {name: values[:left] for name, values in columns.items()}, REFUSE


@kind(ARRAYS)
def whole_numbers(columns: Columns, rng: Random) -> Any:
    columns["x [um]"] = np.arange(80) % 7
    return columns, READ


@kind(ARRAYS)
def single_precision(columns: Columns, rng: Random) -> Any:
    return {name: values.astype(np.float32) for name, values in columns.items()}, READ
