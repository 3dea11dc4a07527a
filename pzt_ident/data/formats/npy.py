"""NumPy files: one array, the fields of a structured array, or the arrays of an archive (npz)."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import numpy as np

from pzt_ident.data.readers.table import Column, Table
from pzt_ident.data.record import Source

SUFFIXES = (".npy", ".npz")
MAGIC = (b"\x93NUMPY",)


def read(path: Path, source: Source) -> Table:
    array = np.load(path, mmap_mode="r", allow_pickle=False)
    if isinstance(array, np.lib.npyio.NpzFile):
        return Table(path, [Column(name, partial(array.__getitem__, name)) for name in array.files])
    if array.dtype.names:
        return Table(path, [Column(name, partial(array.__getitem__, name)) for name in array.dtype.names])
    return Table(path, [Column(path.stem, partial(np.asarray, array))])
