"""Numbers and tables on the terminal."""

from __future__ import annotations

import math
import sys
from collections.abc import Iterable, Iterator, Sequence
from itertools import groupby
from typing import Any, TextIO

import click

from pzt_ident.data.notation import ranges

Row = Sequence[object]


def is_terminal(stream: TextIO | None) -> bool:
    """Whether the stream is a terminal. It is None where the process was started with it closed."""
    return stream is not None and stream.isatty()


def number(value: float | None) -> str:
    """Four significant digits; a dash for a missing or infinite value."""
    return "-" if value is None or not math.isfinite(value) else f"{value:.4g}"


def table(header: Sequence[str], rows: Sequence[Row]) -> None:
    """Print columns under their headings, by rich on a terminal and with blanks elsewhere; no word is cut."""
    cells = [["" if cell is None else str(cell) for cell in row] for row in rows]
    if is_terminal(sys.stdout):
        from rich.box import SIMPLE_HEAD
        from rich.console import Console
        from rich.table import Table
        from rich.text import Text

        rich_table = Table(box=SIMPLE_HEAD)
        for heading in header:
            rich_table.add_column(Text(heading))
        for row in cells:
            rich_table.add_row(*map(Text, row))
        console = Console()
        least = console.measure(rich_table, options=console.options.update_width(1000)).minimum
        console.width = max(console.width, least)
        console.print(rich_table)
        return
    widths = [max(map(len, column)) for column in zip(header, *cells, strict=True)]
    for row in [list(header), *cells]:
        click.echo("  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip())
    click.echo()


def tracked(items: Iterable[Any], what: str, silent: bool) -> Iterator[Any]:
    """The items, with a progress bar on a terminal."""
    if silent or not is_terminal(sys.stdout):
        yield from items
        return
    from rich.progress import track

    yield from track(items, what, transient=True)


def grouped_by_range(rows: list[dict[str, Any]]) -> Iterator[dict[str, Any]]:
    """Rows of parameters; those that differ only in the number in their name become one row."""
    for facts, group in groupby(rows, lambda row: {key: value for key, value in row.items() if key != "name"}):
        yield from (facts | {"name": name} for name in ranges(row["name"] for row in group))
