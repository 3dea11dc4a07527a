"""MATLAB files: v5 by SciPy, v7.3 as HDF5. Structs by their path, elements of a struct array counted from 1."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.readers.table import Column, Table
from pzt_ident.data.record import Source

SUFFIXES = (".mat",)
MAGIC = (b"MATLAB ",)


def read(path: Path, source: Source) -> Table:
    with path.open("rb") as file:
        version = file.read(10)
    if version == b"MATLAB 7.3":
        from pzt_ident.data.formats import hdf5

        return hdf5.tables(path, transposed=True)
    from scipy.io import loadmat

    content = loadmat(path, struct_as_record=False, squeeze_me=True)
    leaves = [leaf for name, value in content.items() if not name.startswith("__") for leaf in _leaves(name, value)]
    return Table(path, [Column(name, partial(np.asarray, value)) for name, value in leaves])


def _leaves(name: str, value: Any) -> Iterator[tuple[str, NDArray[Any]]]:
    array = np.asarray(value)
    if hasattr(value, "_fieldnames"):
        for field in value._fieldnames:
            yield from _leaves(f"{name}/{field}", getattr(value, field))
    elif array.dtype.kind in "biufc" and array.size:
        yield name, array
    elif array.dtype.kind == "O" and array.dtype.names is None and array.ndim == 1:
        for number, element in enumerate(array, start=1):
            yield from _leaves(f"{name}/{number}", element)
