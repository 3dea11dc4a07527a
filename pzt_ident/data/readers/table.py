"""What every reader returns: the columns of a file, loaded when they are needed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from pzt_ident.data.units import TIME, dimension, is_unit, split_header

SUFFIXED = TIME, dimension("m"), dimension("V")  # kinds of units that may end a name


@dataclass(frozen=True)
class Column:
    """One signal or array. `header` is its text in the file, unit included, or its path `group/name`.

    `load` returns the values; text that is no number stays text. `place` names a row in messages: `line 17`.
    `sample_time`: s, where the file states one for the column.
    """

    header: str
    load: Callable[[], NDArray[Any]]
    given_unit: str | None = None
    place: Callable[[int], str] = "row {}".format
    sample_time: float | None = None

    @property
    def name(self) -> str:
        return split_header(self.header)[0]

    @property
    def unit(self) -> str | None:
        return self.given_unit or split_header(self.header)[1]


@dataclass(frozen=True)
class Table:
    """What one file holds: columns, numbered from 1, and scalars that are taken by name only (a sample rate). `content`
    is that of a table which was made of arrays, not of a file."""

    path: Path
    columns: Sequence[Column]
    scalars: Sequence[Column] = ()
    content: bytes | None = None


def unit_of(column: Column) -> str | None:
    """The unit from the header, or from the end of the name: nm of `disp_nm`; None where there is none."""
    if column.unit:
        return column.unit if is_unit(column.unit) else None
    end = column.name.rpartition("_")[2]
    is_suffix = end != column.name and is_unit(end) and dimension(end) in SUFFIXED
    return end if is_suffix else None
