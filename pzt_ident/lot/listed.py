"""Devices from a list: a row says which file or folder is which device, and what else is known of it."""

from __future__ import annotations

import csv
import os
import re
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from io import StringIO
from pathlib import Path

from pzt_ident.data.formats._layout import COMMENTS
from pzt_ident.data.formats.text import decode
from pzt_ident.errors import InputError, printable
from pzt_ident.job.files import record_files
from pzt_ident.job.schema import Job
from pzt_ident.lot.cells import Value, odd_cells, values_of
from pzt_ident.lot.devices import Device, channels_beside, device_at, fault_of, names_of

SUFFIXES = (".csv", ".tsv", ".txt")
NAMES = ("device", "name")
PLACES = ("file", "folder", "path", "filename", "directory")
BEGINNING = 65536  # bytes that hold the header of a list
SEPARATOR = re.compile(r'"?sep=([,;|:\t])"?\s*', re.IGNORECASE)  # as spreadsheets write it above the header


@dataclass(frozen=True)
class Listing:
    """A list as it is written. rows: the line and the cells of each that is not empty, as many cells as the header."""

    path: Path
    delimiter: str
    header: list[str]
    rows: list[tuple[int, list[str]]]

    def places(self, names: Sequence[str]) -> list[int]:
        """The columns with one of these headings."""
        return [place for place, name in enumerate(self.header) if name.lower() in names]


def is_table(path: Path, job: Job) -> bool:
    """Whether a file lists devices: a column is `file`, `folder` or one of the job's files."""
    if path.suffix.lower() not in SUFFIXES or not os.path.isfile(path):
        return False
    try:
        with path.open("rb") as file:
            listing = read_listing(path, file.read(BEGINNING), whole=False)
    except (OSError, InputError):
        return False
    return bool(listing.places(PLACES) or _file_columns(listing.header, job))


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
    """A device a row: its folder or file, or, where that cell is empty, a column for each file of the job. One whose
    row names no file is a device with a fault. Raises InputError where the list cannot be read, lists no device, or
    leaves open what a column is."""
    try:
        listing = read_listing(path, path.read_bytes())
    except OSError as error:
        raise InputError(error.strerror or "cannot be read", where=str(path)) from None
    _check(listing)
    named, at = listing.places(NAMES)[:1], listing.places(PLACES)
    by_place = {"": at[0]} if at else {}
    by_file = _file_columns(listing.header, job)
    used = {*named, *by_place.values(), *by_file.values()}
    known = _known(listing, [place for place in range(len(listing.header)) if place not in used])
    ways = [by_place if by_place and (row[at[0]].strip() or not by_file) else by_file for _, row in listing.rows]
    files = [
        {file: path.parent / row[place].strip() for file, place in way.items() if row[place].strip()}
        for way, (_, row) in zip(ways, listing.rows, strict=True)
    ]
    own = iter(names_of([next(iter(places.values())) for places in files if places]))
    devices = []
    for (line, row), way, places, columns in zip(listing.rows, ways, files, known, strict=True):
        name = next(own) if places else f"line {line}"
        name = next((row[place].strip() for place in named if row[place].strip()), name)
        device = _device(name, places, path.parent, job)
        fault, where = _fault(row, len(listing.header), len(places) == len(way)), f"{path}:{line}"
        devices.append(
            replace(device, columns=columns, where=where, fault=f"{where}: {fault}" if fault else device.fault)
        )
    return devices


def _check(listing: Listing) -> None:
    where = str(listing.path)
    if not listing.rows:
        raise InputError("lists no device", where=where, remedy="write a row for each device below its header")
    if len(places := listing.places(PLACES)) > 1:
        problem = f"has the columns {' and '.join(f'`{listing.header[place]}`' for place in places)}"
        remedy = "where a device is belongs into one of them: its folder, or its file with the folder"
        raise InputError(problem, where=where, remedy=remedy)
    for place, name in enumerate(listing.header):
        if name and name in listing.header[:place]:
            problem = f"the columns {listing.header.index(name) + 1} and {place + 1} have the same heading {name!r}"
            raise InputError(problem, where=where, remedy="give each column a heading of its own")


def _fault(row: Sequence[str], headings: int, named: bool) -> str:
    """What is wrong with a row itself; empty where nothing is."""
    if len(row) > headings:
        return f"has {len(row)} cells, the header {headings}: put text with commas in quotes"
    return "" if named else "names no file: fill the cell, or leave the row out"


def _device(name: str, files: dict[str, Path], beside: Path, job: Job) -> Device:
    """The device of a row. files: by those of the job, or the one place of all of them by an empty name."""
    if "" in files:
        return device_at(files[""], name, {}, job)
    fault = next(filter(None, map(fault_of, files.values())), "")
    return Device(name, files | channels_beside(beside, job), {}, fault)


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


def _known(listing: Listing, places: Sequence[int]) -> list[Mapping[str, Value]]:
    """The other columns of each row, less those that have neither a heading nor a cell."""
    cells = {
        listing.header[place] or f"column {place + 1}": [row[place] for _, row in listing.rows] for place in places
    }
    shown = {name for name in cells if name in listing.header or any(map(str.strip, cells[name]))}
    decimal = ".," if listing.delimiter != "," else "."
    columns = {name: values_of(cells[name], decimal) for name in shown}
    for name in sorted(shown):
        if odd := odd_cells(cells[name], decimal):
            sentence = odd.sentence(name, [f"line {line}" for line, _ in listing.rows])
            warnings.warn(printable(f"{listing.path}: {sentence}. {odd.remedy}"), stacklevel=2)
    return [{name: columns[name][row] for name in cells if name in shown} for row in range(len(listing.rows))]
