"""Which files are whose: the devices that a pattern or a table names."""

from __future__ import annotations

import glob
import os
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from pzt_ident.data.notation import counted
from pzt_ident.errors import InputError, printable
from pzt_ident.job.files import channel_files, record_files
from pzt_ident.job.schema import Job
from pzt_ident.lot.cells import Value

HOW = "give folders ('lot/*/'), files ('lot/*.csv') or a table with a column `file` or `folder`"


@dataclass(frozen=True)
class Device:
    """files: where each file of the job is of this device. columns: what is known of it beside its data. fault: why it
    cannot be identified, from its files alone. where: the line of a list or the path that names it."""

    name: str
    files: Mapping[str, Path]
    columns: Mapping[str, Value] = field(default_factory=dict)
    fault: str = ""
    where: str = ""


def devices_of(patterns: Sequence[str], job: Job) -> list[Device]:
    """The devices that patterns or tables name, in the order of their names.

    Raises InputError where there is none that can be identified, or a pattern or a table leaves open what is meant.
    """
    from pzt_ident.lot.listed import is_table, listed_devices

    tables = list(dict.fromkeys(Path(pattern) for pattern in patterns if is_table(Path(pattern), job)))
    devices = [device for table in tables for device in listed_devices(table, job)]
    paths = matched([pattern for pattern in patterns if Path(pattern) not in tables])
    faults = odd_folder(paths, patterns)
    for name, path in zip(names_of(paths), paths, strict=True):
        device = device_at(path, name, {}, job)
        devices.append(replace(device, fault=faults.get(path, device.fault)))
    devices = _apart([_printable(device) for device in devices])
    if not devices or all(device.fault for device in devices):
        _reject(patterns, devices)
    return sorted(devices, key=lambda device: device.name)


def _printable(device: Device) -> Device:
    """The device with all that is told of it as a terminal, a table and a page can show it."""
    columns = {
        printable(name): printable(value) if isinstance(value, str) else value for name, value in device.columns.items()
    }
    return replace(
        device,
        name=printable(device.name),
        columns=columns,
        fault=printable(device.fault),
        where=printable(device.where),
    )


def matched(patterns: Sequence[str]) -> list[Path]:
    """The folders or files that the patterns match, each once, less folders of results; of a link and what it leads to
    the latter, with a warning. Raises InputError where a pattern matches nothing."""
    paths = dict.fromkeys(path for pattern in patterns for path in matches_of(pattern, alone=len(patterns) == 1))
    by_place: dict[Path, Path] = {}
    for path in sorted(paths, key=_links):
        first = by_place.setdefault(real(path) if os.path.exists(path) else path, path)
        if _links(path) > _links(first):
            warnings.warn(f"{printable(str(path))} leads to {printable(str(first))}: it is one device", stacklevel=2)
    return [path for path in by_place.values() if not os.path.isfile(path / "fleet.json")]


def odd_folder(paths: Sequence[Path], patterns: Sequence[str]) -> Mapping[Path, str]:
    """The only folder among files, with its fault; empty where all are of one kind. Raises InputError where it is open
    which of both are the devices."""
    folders, files = ([path for path in paths if is_kind(path)] for is_kind in (os.path.isdir, os.path.isfile))
    if len(folders) == 1 < len(files):
        return {folders[0]: f"{folders[0]}: is a folder, the other devices are files"}
    if folders and files:
        suffixes = {path.suffix for path in files}
        alone = len(suffixes) == 1 and not suffixes & {"", *(path.suffix for path in folders)}
        taking = f"one that ends with *{suffixes.pop()}" if alone else "a list of devices with a column `file`"
        problem = f"{counted(len(folders), 'folder')} and {counted(len(files), 'file')} are matched"
        remedy = f"a pattern that ends with / takes the folders alone, {taking} the files"
        raise InputError(problem, where=" ".join(map(repr, patterns)), remedy=remedy)
    return {}


def matches_of(pattern: str, alone: bool = True) -> list[Path]:
    """What a pattern matches: the path that it is, letter by letter, or what it is a pattern of, with links that lead
    nowhere. Raises InputError where that is nothing; a path that is not `alone` need not be there."""
    if os.path.lexists(pattern) or not (alone or glob.has_magic(pattern)):
        return [Path(pattern)]
    names = glob.glob(pattern, recursive=True)
    if pattern.endswith("/"):
        names += [name for name in glob.glob(pattern.rstrip("/"), recursive=True) if not os.path.exists(name)]
    if not names:
        raise InputError("matches nothing", where=repr(pattern), remedy=_nearby(pattern))
    return [Path(name) for name in sorted(names)]


def _links(path: Path) -> int:
    return sum(map(os.path.islink, (path, *path.parents)))


def _nearby(pattern: str) -> str:
    """A remedy for a pattern that matches nothing: what is where it stops to match."""
    parts = Path(pattern).parts
    for count in range(len(parts) - 1, 0, -1):
        place = Path(*parts[:count])
        if glob.glob(str(place)):
            inside = sorted(name for match in glob.glob(str(place)) for name in _listed(Path(match)))
            return f"in {place} there is {_some(inside)}"
    return f"there is no {parts[0] if parts else 'such file'} in {Path.cwd()}"


def real(path: Path) -> Path:
    """Where a path leads past all links, as far as that can be told."""
    try:
        return Path(os.path.realpath(path))
    except ValueError:  # no path holds a NUL
        return path.absolute()


def names_of(paths: Sequence[Path]) -> list[str]:
    """The last parts of the paths, as many as make them distinct; of files without the suffix where that does."""
    stems = [path if os.path.isdir(path) else path.with_suffix("") for path in paths]
    for parts in ([path.parts for path in stems], [real(path).parts for path in paths]):
        for count in range(1, max(map(len, parts), default=0) + 1):
            names = [printable("-".join(part for part in path[-count:] if part != "/")) for path in parts]
            if len(set(names)) == len(names):
                return names
    return [f"{path}" for path in paths]


def device_at(path: Path, name: str, columns: Mapping[str, Value], job: Job) -> Device:
    """The device of a folder that holds the files of the job's records by name, or of the one file of all of them."""
    wanted = record_files(job)
    folder = path if os.path.isdir(path) else path.parent
    if folder == path:
        files, fault = _in_folder(path, wanted)
    else:
        files, fault = dict.fromkeys(wanted, path), fault_of(path)
        if not fault and len(wanted) > 1:
            fault = (
                f"{path}: the job has records in {len(wanted)} files, {', '.join(wanted)}, the device is one file: "
                "put its files into a folder, or list them in a CSV file with a column `folder` or one for each of them"
            )
    return Device(name, files | channels_beside(folder, job), columns, fault, str(path))


def fault_of(path: Path) -> str:
    """Why a path is no file that can be read; empty where it is one."""
    if os.path.isfile(path):
        return "" if os.access(path, os.R_OK) else f"{path}: permission denied"
    if os.path.islink(path) and not os.path.exists(path):
        return f"{path}: is a link that leads nowhere"
    if os.path.isdir(path):
        return f"{path}: is a folder, not a file"
    return f"{path}: is no file but a pipe or a device" if os.path.exists(path) else f"{path}: no such file"


def _in_folder(folder: Path, wanted: Sequence[str]) -> tuple[dict[str, Path], str]:
    """Where each file is in a folder, by its path in the job or its name alone; and why one of them is not there."""
    files: dict[str, Path] = {}
    for file in wanted:
        places = list(_places(folder, file))
        path = next(filter(os.path.isfile, places), None) or next(filter(os.path.lexists, places), None)
        if path is None:
            return files, f"{folder}: {_missing(folder, Path(file).name)}"
        if fault := fault_of(path):
            return files, fault
        if other := next((other for other, place in files.items() if place == path), None):
            remedy = "give the files of the job's records different names, or keep them in folders as the job does"
            return files, f"{other} and {file} of the job are the same file {path}: {remedy}"
        files[file] = path
    return files, ""


def _missing(folder: Path, name: str) -> str:
    """What a folder holds in place of a file: one of almost its name, one in a folder below, else all that it holds."""
    if not os.access(folder, os.R_OK | os.X_OK):
        return "permission denied"
    inside = _listed(folder)
    below = [f"{place}/{inner}" for place in inside for inner in _listed(folder / place)]
    alike = [path for path in [*inside, *below] if Path(path).name.lower() == name.lower()]
    if len(alike) == 1:
        return f"holds no {name}: it holds {alike[0]}, which must be there as {name}"
    return f"holds no {name}: it holds {_some(inside)}"


def _listed(folder: Path) -> list[str]:
    """The names in a folder; none where it is no folder or cannot be looked into."""
    try:
        return sorted(os.listdir(folder))
    except OSError:
        return []


def _some(names: Sequence[str]) -> str:
    return printable(", ".join(names[:5])) + ", ..." * (len(names) > 5) if names else "nothing"


def _places(folder: Path, file: str) -> Iterator[Path]:
    if not Path(file).is_absolute() and ".." not in Path(file).parts:
        yield folder / file
    yield folder / Path(file).name


def channels_beside(folder: Path, job: Job) -> dict[str, Path]:
    """Where the files of single channels are: in the device's folder, else where the job has them."""
    places = {}
    for file in channel_files(job):
        beside = (path for path in _places(folder, file) if os.path.isfile(path))
        places[file] = next(beside, job.folder / file)
    return places


def _apart(devices: Sequence[Device]) -> list[Device]:
    """The devices, each once. Where several have one name or one file, nobody can tell which is meant: each has a fault
    that says where the other is, and a name of its own. Raises InputError where that is taken, too."""
    devices = _once(devices)
    by_name, by_data = _groups(devices, lambda device: device.name), _groups(devices, _data)
    apart = []
    for device in devices:
        if other := next((other for other in by_name[device.name] if other is not device), None):
            remedy = "give each a name of its own; what they share belongs into a column such as `serial`"
            fault = f"the device {device.name!r} is in {other.where}, too: {remedy}"
            device = replace(device, name=f"{device.name} ({device.where})", fault=device.fault or fault)
        elif other := next((other for other in by_data[_data(device)] if other is not device), None):
            fault = f"{device.where}: names the same data as {other.where}: leave one of them out"
            device = replace(device, fault=fault)
        apart.append(device)
    if doubled := next(
        (names for names in _groups(apart, lambda device: device.name).values() if len(names) > 1), None
    ):
        remedy = "give each its own name, in a table in the column `device`"
        raise InputError(f"the device {doubled[0].name!r} is there {len(doubled)} times", remedy=remedy)
    return apart


def _once(devices: Sequence[Device]) -> list[Device]:
    """The devices, less those of a name and data that another has, of which nothing more is known."""
    first: dict[Any, Device] = {}
    alike = [(device, first.setdefault((device.name, _data(device)), device)) for device in devices]
    return [device for device, other in alike if device is other or device.columns not in ({}, other.columns)]


def _groups(devices: Sequence[Device], key: Callable[[Device], Any]) -> dict[Any, list[Device]]:
    groups: dict[Any, list[Device]] = {}
    for device in devices:
        groups.setdefault(key(device), []).append(device)
    return groups


def _data(device: Device) -> tuple[Any, ...]:
    """What no other device has: its files, or where it is named if they have a fault."""
    return (device.where,) if device.fault else tuple(map(real, device.files.values()))


def _reject(patterns: Sequence[str], devices: Sequence[Device]) -> None:
    if len(patterns) == 1 and os.path.isfile(patterns[0]) and not os.path.getsize(patterns[0]):
        remedy = "write a header with a column `file` or `folder` into a list, and a row for each device"
        raise InputError("the file is empty", where=patterns[0], remedy=remedy)
    if not devices:
        raise InputError("no device", where=" ".join(map(repr, patterns)), remedy=HOW)
    remedy = "in the folder of a device, files have the names that they have in the job"
    parents = (
        pattern for pattern in patterns if any(os.path.isdir(Path(pattern) / name) for name in _listed(Path(pattern)))
    )
    if inside := next(parents, None):
        remedy = f"did you mean {f'{Path(inside)}/*/'!r}? {remedy.capitalize()}"
    problem = f"no device can be identified. The first, {devices[0].name}: {devices[0].fault}"
    raise InputError(problem, where=" ".join(map(repr, patterns)), remedy=remedy)
