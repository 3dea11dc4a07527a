"""An identified model for other programs: C99, FMU, MATLAB, tables, JSON."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from pzt_ident.control.identified import Identified
from pzt_ident.errors import InputError, nearest
from pzt_ident.files import replaced

PRECISIONS = ("double", "float")


def export(identified: Identified, folder: Path, to: str, precision: str = "double") -> list[Path]:
    """Write a model into a folder; the files that were written.

    to: c, fmu, matlab, csv or json. precision: of the C. Raises InputError for another format or precision, and for a
    block that cannot be written in it.
    """
    if to not in FORMATS:
        raise InputError(f"unknown format {to!r}", where="export", remedy=nearest(to, FORMATS))
    if precision not in PRECISIONS:
        raise InputError(f"unknown precision {precision!r}", where="export", remedy=nearest(precision, PRECISIONS))
    written = []
    for name, content in FORMATS[to](identified, precision).items():
        with replaced(folder / name) as beside:
            beside.write_bytes(content if isinstance(content, bytes) else content.encode())
        written.append(folder / name)
    return written


def _c(identified: Identified, precision: str) -> dict[str, str]:
    from pzt_ident.control.export import c

    return c.files(identified, precision)


def _fmu(identified: Identified, precision: str) -> dict[str, bytes]:
    from pzt_ident.control.export import fmu

    return fmu.files(identified, precision)


def _matlab(identified: Identified, precision: str) -> dict[str, str]:
    from pzt_ident.control.export import matlab

    return matlab.files(identified)


def _csv(identified: Identified, precision: str) -> dict[str, str]:
    from pzt_ident.control.export import tables

    return tables.csv_files(identified)


def _json(identified: Identified, precision: str) -> dict[str, str]:
    from pzt_ident.control.export import tables

    return tables.json_files(identified)


FORMATS: dict[str, Callable[[Identified, str], dict[str, str] | dict[str, bytes]]] = {
    "c": _c,
    "fmu": _fmu,
    "matlab": _matlab,
    "csv": _csv,
    "json": _json,
}
