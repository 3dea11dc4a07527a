"""A good measurement in every format that a library here writes, and read by another reader than the package's."""

from __future__ import annotations

import csv
import io
import zipfile
from xml.etree import ElementTree

import h5py
import numpy as np
import pyarrow.parquet
import scipy.io
from nptdms import ChannelObject, TdmsFile, TdmsWriter

from experiments.trust.good import Array, Columns, measurement

HEADED = '{time: "time [s]", axes: {x: {drive: "u [V]", response: "x [um]"}}}'
NAMED = (
    "{time: {name: measured/t, unit: s}, "
    "axes: {x: {drive: {name: measured/u, unit: V}, response: {name: measured/x, unit: um}}}}"
)
STORED = "{time: {dataset: t, unit: s}, axes: {x: {drive: {dataset: u, unit: V}, response: {dataset: x, unit: um}}}}"
COUNTED = "{time: {column: 1, unit: s}, axes: {x: {drive: {column: 2, unit: V}, response: {column: 3, unit: um}}}}"
FORMATS = {
    "csv": HEADED,
    "tsv": HEADED,
    "txt": COUNTED,
    "dat": COUNTED,
    "npy": COUNTED,
    "mat": STORED,
    "h5": STORED,
    "parquet": HEADED,
    "tdms": NAMED,
    "xlsx": HEADED,
}
TEXTS = ("csv", "tsv", "txt", "dat")
JOB = """\
name: data
records: [{{file: "{file}"}}]
channels: {channels}
model: [bouc_wen]
optimizers: [{{name: pso, population: 5, generations: 2}}]
polish: false
"""
Cells = list[list[str]]


def good(seed: int) -> Columns:
    """Time, drive and response."""
    columns = measurement(seed, "identify", 80)
    return {name: columns[name] for name in ("time [s]", "u [V]", "x [um]")}


def job_for(form: str, file: str) -> str:
    return JOB.format(file=file, channels=FORMATS[form])


def cells_of(columns: Columns, form: str) -> Cells:
    rows = [[repr(value) for value in row] for row in zip(*(v.tolist() for v in columns.values()), strict=True)]
    return ([list(columns)] if form in ("csv", "tsv") else []) + rows


def delimiter_of(form: str) -> str:
    return {"csv": ",", "tsv": "\t", "txt": " ", "dat": "\t"}[form]


def text_of(cells: Cells, delimiter: str) -> str:
    return "".join(delimiter.join(row) + "\n" for row in cells)


def raw(columns: Columns, form: str) -> bytes:
    """The file of a good measurement."""
    if form in TEXTS:
        return text_of(cells_of(columns, form), delimiter_of(form)).encode()
    return binary(columns, form)


def binary(columns: Columns, form: str) -> bytes:
    file, short = io.BytesIO(), dict(zip("tux", columns.values(), strict=True))
    if form == "npy":
        np.save(file, np.column_stack(list(columns.values())))
    elif form == "mat":
        scipy.io.savemat(file, short)
    elif form == "h5":
        with h5py.File(file, "w") as store:
            for name, values in short.items():
                store[name] = values
    elif form == "tdms":
        with TdmsWriter(file) as writer:
            writer.write_segment([ChannelObject("measured", name, values) for name, values in short.items()])
    elif form == "xlsx":
        write_workbook(file, columns)
    else:
        pyarrow.parquet.write_table(pyarrow.table(dict(columns)), file)
    return file.getvalue()


MAIN = "http://schemas.openxmlformats.org/spreadsheetml/2006/main"
OFFICE = "http://schemas.openxmlformats.org/officeDocument/2006/relationships"
PACKAGE = "http://schemas.openxmlformats.org/package/2006"
KIND = "application/vnd.openxmlformats-officedocument.spreadsheetml"


def write_workbook(file: io.BytesIO, columns: Columns) -> None:
    """The smallest workbook: one sheet, a header and numbers."""
    rows = [[f'<c t="inlineStr"><is><t>{name}</t></is></c>' for name in columns]]
    rows += [
        [f"<c><v>{value!r}</v></c>" for value in row]
        for row in zip(*(v.tolist() for v in columns.values()), strict=True)
    ]
    cells = "".join(f"<row>{''.join(row)}</row>" for row in rows)
    related = f'<Relationships xmlns="{PACKAGE}/relationships"><Relationship Id="r1" Type="{OFFICE}/'
    parts = {
        "[Content_Types].xml": f'<Types xmlns="{PACKAGE}/content-types"><Default Extension="rels" ContentType='
        '"application/vnd.openxmlformats-package.relationships+xml"/><Override PartName="/xl/workbook.xml" '
        f'ContentType="{KIND}.sheet.main+xml"/><Override PartName="/xl/s1.xml" ContentType="{KIND}.worksheet+xml"/>'
        "</Types>",
        "_rels/.rels": related + 'officeDocument" Target="xl/workbook.xml"/></Relationships>',
        "xl/workbook.xml": f'<workbook xmlns="{MAIN}" xmlns:r="{OFFICE}"><sheets>'
        '<sheet name="loop" sheetId="1" r:id="r1"/></sheets></workbook>',
        "xl/_rels/workbook.xml.rels": related + 'worksheet" Target="s1.xml"/></Relationships>',
        "xl/s1.xml": f'<worksheet xmlns="{MAIN}"><sheetData>{cells}</sheetData></worksheet>',
    }
    with zipfile.ZipFile(file, "w") as book:
        for name, text in parts.items():
            book.writestr(name, text)


def read(content: bytes, form: str) -> Array | None:
    """(samples, 3) as another reader has it: the format's own library, or `csv` and `float`; None where it cannot."""
    try:
        if form == "npy":
            return np.atleast_2d(np.load(io.BytesIO(content))).astype(float)
        if form == "mat":
            stored = scipy.io.loadmat(io.BytesIO(content))
            return np.column_stack([np.ravel(stored[name]) for name in "tux"]).astype(float)
        if form == "h5":
            with h5py.File(io.BytesIO(content)) as store:
                return np.column_stack([np.ravel(store[name][()]) for name in "tux"]).astype(float)
        if form == "tdms":
            group = TdmsFile.read(io.BytesIO(content))["measured"]
            return np.column_stack([group[name][:] for name in "tux"]).astype(float)
        if form == "xlsx":
            with zipfile.ZipFile(io.BytesIO(content)) as book:
                rows = ElementTree.fromstring(book.read("xl/s1.xml")).iter(f"{{{MAIN}}}row")
            return np.array([[float(cell.findtext(f"{{{MAIN}}}v")) for cell in row] for row in list(rows)[1:]])
        if form == "parquet":
            table = pyarrow.parquet.read_table(io.BytesIO(content))
            return np.column_stack([table.column(name).to_numpy() for name in ("time [s]", "u [V]", "x [um]")])
        return read_text(content, form)
    except Exception:
        return None


def read_text(content: bytes, form: str) -> Array | None:
    text = content.decode("utf-16" if content[:2] in (b"\xff\xfe", b"\xfe\xff") else "utf-8-sig")
    rows = [row for row in csv.reader(io.StringIO(text), delimiter=delimiter_of(form)) if row]
    if form in ("csv", "tsv"):
        names = [name.strip() for name in rows[0]]
        order = [names.index(name) for name in ("time [s]", "u [V]", "x [um]")]
        return np.array([[float(row[i]) for i in order] for row in rows[1:]])
    return np.array([[float(cell) for cell in row[:3]] for row in rows])
