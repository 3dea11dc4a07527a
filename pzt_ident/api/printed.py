"""Results as a table in a terminal and in a notebook."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

STYLE = "text-align: left; padding: 0.15em 1em 0.15em 0"


class Noted:
    """Prints its table, and `notes` below it."""

    notes: tuple[str, ...]

    def _table(self) -> tuple[list[str], list[list[str]]]:
        """Header and rows."""
        raise NotImplementedError

    def __str__(self) -> str:
        return "\n".join([table_text(*self._table()), *(f"note: {note}" for note in self.notes)])

    __repr__ = __str__

    def _repr_html_(self) -> str:
        return html("\n".join(self.notes), *self._table())


def table_text(header: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Columns under their headings."""
    widths = [max(map(len, column)) for column in zip(header, *rows, strict=True)]
    lines = [header, *rows]
    return "\n".join(
        "  ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)).rstrip() for line in lines
    )


def html(headline: str, header: Sequence[str], rows: Sequence[Sequence[str]], foot: str = "") -> str:
    """The same as a notebook shows it."""
    paragraphs = "".join(f"<p>{escape(line)}</p>" for line in headline.splitlines())
    head = "".join(f'<th style="{STYLE}">{escape(cell)}</th>' for cell in header)
    body = "".join(
        "<tr>" + "".join(f'<td style="{STYLE}">{escape(cell)}</td>' for cell in row) + "</tr>" for row in rows
    )
    end = "".join(f"<p>{escape(line)}</p>" for line in foot.splitlines())
    return f"{paragraphs}<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>{end}"
