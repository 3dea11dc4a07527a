"""Data files of a record: a column is a name, its unit and its samples."""

import h5py
import numpy as np
import pandas as pd
from nptdms import ChannelObject, TdmsWriter
from scipy.io import savemat

SEPARATORS = {"csv": ",", "semicolons": ";", "commas": ",", "tabs": "\t", "spaces": " "}
WITHOUT_HEADINGS = ("commas", "spaces")
ENDINGS = {"semicolons": "csv", "commas": "txt", "tabs": "tsv", "spaces": "dat", "mat73": "mat"}
USER_BLOCK = b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124, b" ") + b"\x00\x02IM"


def file_name(record, form):
    return f"{record}.{ENDINGS.get(form, form)}"


def _text(path, columns, form):
    digits = ["%.8g" if name == "time" else "%.9g" for name, *_ in columns]
    with open(path, "w") as file:
        if form not in WITHOUT_HEADINGS:
            file.write(SEPARATORS[form].join(f"{name} [{unit}]" for name, unit, _ in columns) + "\n")
        table = np.column_stack([samples for *_, samples in columns])
        np.savetxt(file, table, fmt=digits, delimiter=SEPARATORS[form])


def _mat(path, columns):
    savemat(path, {name: samples for name, _, samples in columns})


def _mat73(path, columns):
    with h5py.File(path, "w", userblock_size=512) as file:
        for name, _, samples in columns:
            file.create_dataset(name, data=samples.reshape(1, -1)).attrs["MATLAB_class"] = np.bytes_("double")
    with open(path, "r+b") as raw:
        raw.write(USER_BLOCK)


def _h5(path, columns):
    with h5py.File(path, "w") as file:
        for name, unit, samples in columns:
            file.create_dataset(name, data=samples).attrs["unit"] = unit


def _tdms(path, columns):
    with TdmsWriter(path) as file:
        file.write_segment([ChannelObject("log", name, y, properties={"unit_string": u}) for name, u, y in columns])


def _parquet(path, columns):
    table = {f"{name} [{unit}]": samples for name, unit, samples in columns}
    pd.DataFrame(table).to_parquet(path, index=False)


WRITERS = {"mat": _mat, "mat73": _mat73, "h5": _h5, "tdms": _tdms, "parquet": _parquet}


def save(path, columns, form):
    """Write the columns of a record as a file of that format."""
    if form in SEPARATORS:
        _text(path, columns, form)
    else:
        WRITERS[form](path, columns)


def channels(signals, form):
    """{name of a signal: its channel in the job}, of names and units in the order of the columns."""
    out = {}
    for number, (name, unit) in enumerate(signals, 1):
        if form in WITHOUT_HEADINGS:
            out[name] = f"{{column: {number}, unit: {unit}}}"
        elif form in ("mat", "mat73", "h5"):
            out[name] = f"{{dataset: {name}, unit: {unit}}}"
        elif form == "tdms":
            out[name] = f"{{name: log/{name}, unit: {unit}}}"
        else:
            out[name] = f'"{name} [{unit}]"'
    return out
