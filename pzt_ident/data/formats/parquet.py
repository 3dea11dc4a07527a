"""Parquet files; units in the column names or in the fields' metadata `units` or `unit`. Needs the extra `parquet`."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from pzt_ident.data.readers.table import Column, Table
from pzt_ident.data.record import Source
from pzt_ident.errors import InputError

SUFFIXES = (".parquet",)
MAGIC = (b"PAR1",)


def read(path: Path, source: Source) -> Table:
    try:
        from pyarrow.parquet import read_schema
    except ImportError as error:
        raise InputError(
            "reading Parquet needs pyarrow", where=str(path), remedy="pip install 'pzt-ident[parquet]'"
        ) from error
    return Table(
        path, [Column(field.name, partial(_values, path, field.name), _unit(field)) for field in read_schema(path)]
    )


def _values(path: Path, name: str) -> NDArray[Any]:
    from pyarrow.parquet import ParquetFile

    with ParquetFile(path) as file:
        return file.read(columns=[name]).column(0).to_numpy()


def _unit(field: Any) -> str | None:
    metadata = field.metadata or {}
    unit = metadata.get(b"units", metadata.get(b"unit"))
    return unit.decode() if unit else None
