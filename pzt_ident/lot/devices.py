"""Which files are whose: the devices that a pattern or a table names."""

from __future__ import annotations

import glob
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from pzt_ident.errors import InputError
from pzt_ident.job.files import channel_files, record_files
from pzt_ident.job.schema import Job

Value = float | str | None
HOW = "give folders ('lot/*/'), files ('lot/*.csv') or a table with a column `file` or `folder`"


@dataclass(frozen=True)
class Device:
    """files: where each file of the job is of this device. columns: what is known of it beside its data. fault: why it
    cannot be identified, from its files alone."""

    name: str
    files: Mapping[str, Path]
    columns: Mapping[str, Value] = field(default_factory=dict)
    fault: str = ""


def devices_of(patterns: Sequence[str], job: Job) -> list[Device]:
    """The devices that patterns or tables name, in the order of their names.

    Raises InputError where there is none, one is there twice, or the files of the job cannot be told apart.
    """
    from pzt_ident.lot.listed import is_table, listed_devices

    tables = [Path(pattern) for pattern in patterns if is_table(Path(pattern), job)]
    devices = [device for table in tables for device in listed_devices(table, job)]
    paths = matched([pattern for pattern in patterns if Path(pattern) not in tables])
    named = zip(names_of(paths), paths, strict=True)
    devices += [device_at(path, name, {}, job) for name, path in named]
    _check_twice(devices)
    if not devices or all(device.fault for device in devices):
        _reject(patterns, devices)
    return sorted(devices, key=lambda device: device.name)


def matched(patterns: Sequence[str]) -> list[Path]:
    """The folders or files that the patterns match. Raises InputError where one matches nothing, both or twice."""
    by: dict[Path, str] = {}
    matches: list[Path] = []
    for pattern in patterns:
        paths = [Path(name) for name in sorted(glob.glob(pattern, recursive=True))]
        if not paths:
            raise InputError("matches nothing", where=repr(pattern), remedy=_nearby(pattern))
        for path in paths:
            if path.resolve() in by:
                problem = f"{path} is there twice: by {by[path.resolve()]!r} and by {pattern!r}"
                raise InputError(problem, remedy="let one pattern match it")
            by[path.resolve()] = pattern
        matches += paths
    folders = [path for path in matches if path.is_dir()]
    if folders and len(folders) < len(matches):
        problem = f"{len(folders)} folders and {len(matches) - len(folders)} files are matched"
        remedy = "a pattern that ends with / takes the folders alone, one that ends with *.csv the files"
        raise InputError(problem, where=" ".join(map(repr, patterns)), remedy=remedy)
    return matches


def _nearby(pattern: str) -> str:
    """A remedy for a pattern that matches nothing: what is where it stops to match."""
    parts = Path(pattern).parts
    for count in range(len(parts) - 1, 0, -1):
        place = Path(*parts[:count])
        if glob.glob(str(place)):
            inside = sorted(path.name for match in glob.glob(str(place)) for path in Path(match).glob("*"))
            return f"in {place} there is {', '.join(inside[:5]) or 'nothing'}{', ...' if len(inside) > 5 else ''}"
    return f"there is no {parts[0] if parts else 'such file'} in {Path.cwd()}"


def names_of(paths: Sequence[Path]) -> list[str]:
    """The last parts of the paths, as many as make them distinct; of files without the suffix where that does."""
    stems = [path if path.is_dir() else path.with_suffix("") for path in paths]
    for parts in ([path.parts for path in stems], [path.resolve().parts for path in paths]):
        for count in range(1, max(map(len, parts), default=0) + 1):
            names = ["-".join(part for part in path[-count:] if part != "/") for path in parts]
            if len(set(names)) == len(names):
                return [name.encode("utf-8", "backslashreplace").decode() for name in names]
    return [f"{path}" for path in paths]


def device_at(path: Path, name: str, columns: Mapping[str, Value], job: Job) -> Device:
    """The device of a folder that holds the files of the job's records by name, or of the one file of all of them."""
    wanted = record_files(job)
    if path.is_dir():
        files, missing = _in_folder(path, wanted)
        fault = f"{path}: holds no {missing}: it holds {_content(path)}" if missing else ""
    else:
        files = dict.fromkeys(wanted, path)
        fault = "" if path.is_file() else f"{path}: no such file"
        if len(wanted) > 1:
            remedy = "put the files of a device into a folder, or list them in a table with a column for each of them"
            problem = f"the job has records in {len(wanted)} files, {', '.join(wanted)}, the device is one file"
            raise InputError(problem, where=str(path), remedy=remedy)
    return Device(name, files | channels_beside(path if path.is_dir() else path.parent, job), columns, fault)


def _in_folder(folder: Path, wanted: Sequence[str]) -> tuple[dict[str, Path], str]:
    """Where each file is in a folder, by its path in the job or its name alone; and the first that is not there."""
    files: dict[str, Path] = {}
    for file in wanted:
        path = next((place for place in _places(folder, file) if place.is_file()), None)
        if path is None:
            return files, Path(file).name
        files[file] = path
    same = Counter(files.values())
    if path := next((path for path, count in same.items() if count > 1), None):
        twice = " and ".join(file for file in wanted if files[file] == path)
        problem = f"{twice} of the job are the same file {path}"
        raise InputError(problem, remedy="give the files of the job's records different names")
    return files, ""


def _places(folder: Path, file: str) -> Iterator[Path]:
    if not Path(file).is_absolute() and ".." not in Path(file).parts:
        yield folder / file
    yield folder / Path(file).name


def channels_beside(folder: Path, job: Job) -> dict[str, Path]:
    """Where the files of single channels are: in the device's folder, else where the job has them."""
    places = {}
    for file in channel_files(job):
        beside = (path for path in _places(folder, file) if path.is_file())
        places[file] = next(beside, job.folder / file)
    return places


def _content(folder: Path) -> str:
    names = sorted(path.name for path in folder.iterdir())
    return ", ".join(names[:5]) + (", ..." if len(names) > 5 else "") if names else "nothing"


def _check_twice(devices: Sequence[Device]) -> None:
    for name, count in Counter(device.name for device in devices).items():
        if count > 1:
            remedy = "give each its own name, in a table in the column `device`"
            raise InputError(f"the device {name!r} is there {count} times", remedy=remedy)


def _reject(patterns: Sequence[str], devices: Sequence[Device]) -> None:
    if not devices:
        raise InputError("no device", where=" ".join(map(repr, patterns)), remedy=HOW)
    remedy = "in the folder of a device, files have the names that they have in the job"
    if inside := next(
        (pattern for pattern in patterns if any(path.is_dir() for path in Path(pattern).glob("*"))), None
    ):
        remedy = f"did you mean {f'{Path(inside)}/*/'!r}? {remedy.capitalize()}"
    problem = f"no device has the files of the job. The first: {devices[0].fault}"
    raise InputError(problem, where=" ".join(map(repr, patterns)), remedy=remedy)
