"""Devices from a table: a row says which file or folder is which device, and what else is known of it."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from pzt_ident.errors import InputError
from pzt_ident.job.files import record_files
from pzt_ident.job.schema import Job
from pzt_ident.lot.devices import Device, Value, channels_beside, device_at, fault_of, names_of, real

SUFFIXES = (".csv", ".tsv", ".txt")
NAMES = ("device", "name")
PLACES = ("file", "folder")


def is_table(path: Path, job: Job) -> bool:
    """Whether a file lists devices: a column is `file`, `folder` or one of the job's files."""
    if path.suffix.lower() not in SUFFIXES or not path.is_file():
        return False
    header, _ = _rows(path, 0)
    return any(name.lower() in PLACES for name in header) or bool(_file_columns(header, job))


def listed_devices(path: Path, job: Job) -> list[Device]:
    """A device a row. Raises InputError where a row names no file, or one that another row names too."""
    header, rows = _rows(path)
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


def _rows(path: Path, most: int | None = None) -> tuple[list[str], list[tuple[int, list[str]]]]:
    """The header, and line and cells of each row that is not empty, all as long as the header."""
    try:
        text = path.read_text(encoding="utf-8-sig", errors="strict")
    except UnicodeDecodeError:
        text = path.read_text(encoding="latin-1")
    lines = text.splitlines()
    first = lines[0] if lines else ""
    delimiter = max(",;\t", key=first.count)
    reader = csv.reader(lines[: None if most is None else most + 1], delimiter=delimiter)
    header = [name.strip() for name in next(reader, [])]
    rows = []
    for row in reader:
        if any(cell.strip() for cell in row):
            if len(row) > len(header):
                problem = f"has {len(row)} cells, the header {len(header)}"
                raise InputError(problem, where=f"{path}:{reader.line_num}", remedy="put text with commas in quotes")
            rows.append((reader.line_num, row + [""] * (len(header) - len(row))))
    return header, rows


def _file_columns(header: Sequence[str], job: Job) -> dict[str, int]:
    """The column of each file of the job: by its path, its name with or without suffix, or the name of a record."""
    places = {name.lower(): place for place, name in enumerate(header)}
    columns = {}
    for file in record_files(job):
        records = [source.name or "" for source in job.records if source.file == file]
        words = (file, Path(file).name, Path(file).stem, *records)
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
