"""Devices from a list: a row says which file or folder is which device, and what else is known of it."""

from __future__ import annotations

import csv
import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from io import StringIO
from pathlib import Path

from pzt_ident.data.formats._layout import COMMENTS
from pzt_ident.data.formats.text import decode
from pzt_ident.errors import InputError
from pzt_ident.job.files import record_files
from pzt_ident.job.schema import Job
from pzt_ident.lot.devices import Device, Value, channels_beside, device_at, fault_of, names_of, real

SUFFIXES = (".csv", ".tsv", ".txt")
NAMES = ("device", "name")
PLACES = ("file", "folder")
BEGINNING = 65536  # bytes that hold the header of a list
SEPARATOR = re.compile(r'"?sep=([,;|:\t])"?\s*', re.IGNORECASE)  # as spreadsheets write it above the header


@dataclass(frozen=True)
class Listing:
    """A list as it is written. rows: the line and the cells of each that is not empty, as many cells as the header."""

    path: Path
    delimiter: str
    header: list[str]
    rows: list[tuple[int, list[str]]]


def is_table(path: Path, job: Job) -> bool:
    """Whether a file lists devices: a column is `file`, `folder` or one of the job's files."""
    if path.suffix.lower() not in SUFFIXES or not os.path.isfile(path):
        return False
    try:
        with path.open("rb") as file:
            header = read_listing(path, file.read(BEGINNING), whole=False).header
    except (OSError, InputError):
        return False
    return any(name.lower() in PLACES for name in header) or bool(_file_columns(header, job))


def read_listing(path: Path, content: bytes, whole: bool = True) -> Listing:
    """The list of a file with this content; no rows where that is not the whole. Raises InputError where it is none."""
    try:
        lines = StringIO(decode(content, whole), newline="").readlines()
    except UnicodeDecodeError:
        raise InputError("is no text", where=str(path), remedy="save the list as CSV in UTF-8") from None
    first = next((place for place, line in enumerate(lines) if not _is_above(line)), 0)
    marks = [mark[1] for line in lines[:first] if (mark := SEPARATOR.fullmatch(line))]
    delimiter = marks[0] if marks else max(",;\t", key="".join(lines[first : first + 1]).count)
    reader = csv.reader(lines[first:], delimiter=delimiter)
    try:
        header = [name.strip() for name in next(reader, [])]
        cells = [(first + reader.line_num, row) for row in reader if any(map(str.strip, row))] if whole else []
    except csv.Error as error:
        where = f"{path}:{first + reader.line_num}"
        raise InputError(f"is no list of devices: {error}", where=where, remedy="is a quote missing?") from None
    return Listing(path, delimiter, header, [(line, _as_long(row, header)) for line, row in cells])


def _is_above(line: str) -> bool:
    """Whether a line above the header is no part of a list."""
    return not line.strip() or line.startswith(COMMENTS) or bool(SEPARATOR.fullmatch(line))


def _as_long(row: Sequence[str], header: Sequence[str]) -> list[str]:
    """The cells of a row, as many as the header has; more where they are not empty."""
    surplus = row[len(header) :] if any(map(str.strip, row[len(header) :])) else []
    return [*row[: len(header)], *[""] * (len(header) - len(row)), *surplus]


def listed_devices(path: Path, job: Job) -> list[Device]:
    """A device a row. Raises InputError where a row names no file, or one that another row names too."""
    try:
        listing = read_listing(path, path.read_bytes())
    except OSError as error:
        raise InputError(error.strerror or "cannot be read", where=str(path)) from None
    header, rows = listing.header, listing.rows
    if long := next(((line, row) for line, row in rows if len(row) > len(header)), None):
        problem = f"has {len(long[1])} cells, the header {len(header)}"
        raise InputError(problem, where=f"{path}:{long[0]}", remedy="put text with commas in quotes")
    if not rows:
        raise InputError("lists no device", where=str(path), remedy="write a row for each device below its header")
    named = next((place for place, name in enumerate(header) if name.lower() in NAMES), None)
    at = next((place for place, name in enumerate(header) if name.lower() in PLACES), None)
    by_file = _file_columns(header, job)
    used = {named, at, *by_file.values()}
    known = _known(header, rows, [place for place in range(len(header)) if place not in used])
    devices = []
    for (line, row), columns in zip(rows, known, strict=True):
        where = f"{path}:{line}"
        if at is not None:
            device = device_at(_path(path, row[at], where), "", columns, job)
        else:
            files = {file: _path(path, row[place], where) for file, place in by_file.items()}
            fault = next(filter(None, map(fault_of, files.values())), "")
            device = Device("", files | channels_beside(path.parent, job), columns, fault)
        devices.append(replace(device, name=row[named].strip() if named is not None else ""))
    _check_rows(path, rows, devices)
    places = [
        _path(path, row[at], "") if at is not None else next(iter(device.files.values()))
        for (_, row), device in zip(rows, devices, strict=True)
    ]
    devices = [
        replace(device, name=device.name or name) for device, name in zip(devices, names_of(places), strict=True)
    ]
    return devices


def _file_columns(header: Sequence[str], job: Job) -> dict[str, int]:
    """The column of each file of the job: by its path, its name with or without suffix, or the name of a record."""
    places = {name.lower(): place for place, name in enumerate(header)}
    columns = {}
    for file in record_files(job):
        records = [source.name or "" for source in job.records if source.file == file]
        words = filter(None, (file, Path(file).name, Path(file).stem, *records))
        place = next((places[word.lower()] for word in words if word.lower() in places), None)
        if place is None:
            return {}
        columns[file] = place
    return columns


def _path(table: Path, cell: str, where: str) -> Path:
    if not cell.strip():
        raise InputError("names no file", where=where, remedy="fill the cell, or leave the row out")
    return table.parent / cell.strip()


def _known(
    header: Sequence[str], rows: Sequence[tuple[int, list[str]]], places: Sequence[int]
) -> list[Mapping[str, Value]]:
    """The other columns of each row, numbers where all cells of a column are numbers or empty."""
    kinds = {place: _are_numbers([row[place] for _, row in rows]) for place in places}

    def value(cell: str, number: bool) -> Value:
        return (float(cell) if number else cell.strip()) if cell.strip() else None

    return [
        {header[place] or f"column {place + 1}": value(row[place], kinds[place]) for place in places} for _, row in rows
    ]


def _are_numbers(cells: Sequence[str]) -> bool:
    try:
        return bool([float(cell) for cell in cells if cell.strip()])
    except ValueError:
        return False


def _check_rows(path: Path, rows: Sequence[tuple[int, list[str]]], devices: Sequence[Device]) -> None:
    names: dict[str, int] = {}
    files: dict[tuple[Path, ...], int] = {}
    for (line, _), device in zip(rows, devices, strict=True):
        paths = () if device.fault else tuple(map(real, device.files.values()))
        if device.name and device.name in names:
            problem = f"the device {device.name!r} is in line {names[device.name]} already"
            remedy = "give each row a name of its own; what rows share belongs into a column such as `serial`"
            raise InputError(problem, where=f"{path}:{line}", remedy=remedy)
        if paths and paths in files:
            problem = f"names the same data as line {files[paths]}"
            raise InputError(problem, where=f"{path}:{line}", remedy="leave one of the rows out")
        names[device.name], files[paths] = line, line
