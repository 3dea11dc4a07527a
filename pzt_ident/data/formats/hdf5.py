"""HDF5 files: every data set by its path; units from the attributes `units` or `unit`, scalar attributes by name.

Packed data are unpacked as the CF conventions (section 8.1) say: `scale_factor` times what is stored plus `add_offset`,
and a gap where that is `_FillValue`.
"""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.readers.table import Column, Table
from pzt_ident.data.record import Source

SUFFIXES = (".h5", ".hdf5", ".nc")
MAGIC = (b"\x89HDF\r\n\x1a\n",)


def read(path: Path, source: Source) -> Table:
    return tables(path, transposed=False)


def tables(path: Path, transposed: bool) -> Table:
    """The data sets of a file; `transposed` where it was written column by column."""
    import h5py

    columns: list[Column] = []
    scalars: list[Column] = []

    def visit(name: str, item: Any) -> None:
        if isinstance(item, h5py.Dataset) and not name.startswith("#"):
            columns.append(Column(name, partial(_values, path, name, transposed), _unit(item)))
        for key, value in item.attrs.items():
            if np.ndim(value) == 0 and np.issubdtype(np.asarray(value).dtype, np.number):
                scalars.append(Column(f"{name}/{key}", partial(np.asarray, value)))

    with h5py.File(path) as file:
        visit("", file)
        file.visititems(visit)
    return Table(path, columns, scalars)


def _values(path: Path, name: str, transposed: bool) -> NDArray[Any]:
    import h5py

    with h5py.File(path) as file:
        values = _unpacked(np.asarray(file[name][()]), file[name].attrs)
    if values.dtype.names == ("real", "imag"):
        values = values["real"] + 1j * values["imag"]
    return values.T if transposed else values


def _unpacked(values: NDArray[Any], attributes: Any) -> NDArray[Any]:
    packing = {key: attributes[key] for key in ("scale_factor", "add_offset", "_FillValue") if key in attributes}
    if not packing or values.dtype.kind not in "iuf":
        return values
    gaps = values == packing["_FillValue"] if "_FillValue" in packing else np.zeros(values.shape, bool)
    unpacked = values * np.float64(packing.get("scale_factor", 1.0)) + np.float64(packing.get("add_offset", 0.0))
    return np.where(gaps, np.nan, unpacked)


def _unit(item: Any) -> str | None:
    unit = item.attrs.get("units", item.attrs.get("unit"))
    return unit.decode() if isinstance(unit, bytes) else unit if isinstance(unit, str) else None
