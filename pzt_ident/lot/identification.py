"""The devices of a lot on their way to the folder of a fleet: tasks, notes and rows."""

from __future__ import annotations

import hashlib
import json
import shutil
from collections.abc import Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from time import monotonic
from typing import Any

from pzt_ident.errors import DamagedError, InputError, LostError, printable
from pzt_ident.files import write_files, write_sealed
from pzt_ident.job.schema import Job
from pzt_ident.lot.device import Given, Orders, identify_device
from pzt_ident.lot.devices import Device
from pzt_ident.lot.table import (
    FOR_PARQUET,
    check_whole,
    folder_of,
    has_parquet,
    read_devices,
    read_row,
    some,
    write_devices,
    write_table,
)
from pzt_ident.run.events import Listen
from pzt_ident.run.place import Place

AGAIN = 10.0  # s, at least, after which the table is written again as devices are done
SHARE = 0.05  # of the time, at most, for that


@dataclass
class Identification:
    """The devices of a fleet on their way to its folder."""

    folder: Path
    devices: list[Device]
    job: Job
    orders: Orders
    listen: Listen
    by_name: dict[str, Device] = field(init=False)
    sha256: dict[str, str] = field(default_factory=dict)  # of the data of devices that are at work
    first: dict[str, str] = field(default_factory=dict)  # device with data of this hash
    reasons: dict[str, list[str]] = field(default_factory=dict)  # the devices that are broken for each
    untold: list[str] = field(default_factory=list)  # devices that are broken for a reason that was told of another
    done: int = 0
    kept: int = 0
    broken: int = 0
    due: float = field(default_factory=lambda: monotonic() + AGAIN)  # when the table is written again

    def identify(self, place: Place) -> Path:
        self.by_name = {device.name: device for device in self.devices}
        shutil.rmtree(self.folder / "devices" / ".new", ignore_errors=True)
        self.tell_gone()
        write_devices(self.folder, self.devices)
        self.tell({})
        try:
            place.run_all(identify_device, (self.orders,), self.tasks(place), self.note, self.keep)
        except (KeyboardInterrupt, LostError, OSError):
            with suppress(OSError):
                write_table(self.folder, self.devices)
            raise
        shutil.rmtree(self.folder / "devices" / ".new", ignore_errors=True)
        write_table(self.folder, self.devices)
        self.tell_untold()
        if self.kept:
            sentence = f"{self.kept} of {len(self.devices)} devices were done before and are as they were"
            self.listen({"event": "kept", "said": sentence})
        if not has_parquet():
            self.listen({"event": "table", "said": f"the table is not written as Parquet: that needs {FOR_PARQUET}"})
        return self.folder

    def tell_gone(self) -> None:
        """Name the devices of the fleet that are none any more."""
        try:
            gone = [device.name for device in read_devices(self.folder) if device.name not in self.by_name]
        except DamagedError:
            return
        if gone:
            verb = "is no device" if len(gone) == 1 else "are no devices"
            where = f"is left in {self.folder / 'devices'}"
            sentence = f"{some(gone)} {verb} any more: left out of the table; what was identified {where}"
            self.listen({"event": "gone", "said": sentence})

    def tasks(self, place: Place) -> Iterator[tuple[str, tuple[Any, ...]]]:
        """The devices that are not done, read one by one as there is room for them."""
        for index, device in enumerate(self.devices):
            home = folder_of(self.folder, device.name)
            try:
                if device.fault:
                    raise InputError(device.fault)
                contents = {file: read(path) for file, path in device.files.items()}
            except InputError as error:
                if self.is_done(home):
                    kept = printable(f"{in_a_line(str(error))}; what was identified before is kept")
                    self.devices[index] = replace(device, fault=kept)
                    self.keep_old(f"{device.name}: {kept}")
                else:
                    self.break_(device.name, str(error))
                continue
            self.sha256[device.name] = sha256_of(contents.values())
            self.tell_alike(device.name)
            key = self.key(self.sha256[device.name])
            if self.is_done(home, self.sha256[device.name]):
                del self.sha256[device.name]
                self.keep_old()
                continue
            given = Given(
                device.name,
                key,
                self.sha256[device.name],
                home.absolute(),
                device.files,
                None if place.shares_disk else contents,
            )
            yield device.name, (given,)

    def tell_alike(self, name: str) -> None:
        """Warn of a device whose files are those of one before it to the last byte."""
        first = self.first.setdefault(self.sha256[name], name)
        if first != name:
            self.listen({"event": "alike", "said": f"{name} has the same data as {first}: is one of them a copy?"})

    def keep_old(self, reason: str = "") -> None:
        """Leave the results of a device as they are. reason: why its data were not looked at."""
        self.done += 1
        self.kept += 1
        if reason:
            self.listen({"event": "stale", "said": reason})

    def is_done(self, home: Path, data: str | None = None) -> bool:
        """Whether a device was identified as it is asked, on these data, by their hash, or on any; where its results
        are damaged, that is told."""
        if not home.exists():
            return False
        try:
            row = read_row(home)
            if row["state"] != "done" or row["key"] != self.key(data or row["sha256"]):
                return False
            check_whole(home, row)
        except DamagedError as error:
            self.listen({"event": "damaged", "said": f"{error.where} {error.message}; the device is identified again"})
            return False
        return True

    def key(self, data: str) -> str:
        """What the result of a device is a function of: what was asked, and its data, by their hash."""
        asked = [self.job.hash, self.orders.improve, self.orders.budget if self.orders.improve else None]
        return hashlib.sha256(json.dumps([asked, data]).encode()).hexdigest()

    def keep(self, name: str, files: dict[str, bytes]) -> None:
        """Put a device's files into its folder, all of them or none."""
        self.done += 1
        del self.sha256[name]
        home = folder_of(self.folder, name)
        new = self.folder / "devices" / ".new" / home.name
        write_files(new, files)
        shutil.rmtree(home, ignore_errors=True)
        home.parent.mkdir(parents=True, exist_ok=True)
        new.rename(home)
        self.refresh_table()
        self.tell({"device": name})

    def break_(self, name: str, reason: str) -> None:
        """Write down why a device could not be identified."""
        reason = printable(in_a_line(reason))
        self.broken += 1
        self.reasons.setdefault(self.without_paths(name, reason), []).append(name)
        home = folder_of(self.folder, name)
        shutil.rmtree(home, ignore_errors=True)
        row = {"device": name, "key": "", "sha256": self.sha256.pop(name, ""), "state": "broken", "reason": reason}
        write_sealed(home / "device.json", row)
        self.refresh_table()
        if self.all_fail_alike:
            self.untold.append(name)
            self.tell({"device": name})
        else:
            self.tell({"device": name, "failed": reason})

    def without_paths(self, name: str, reason: str) -> str:
        """A reason as it would be of any other device."""
        device = self.by_name[name]
        for path in sorted({device.where, *map(str, device.files.values())} - {""}, key=len, reverse=True):
            reason = reason.replace(printable(path), "")
        return reason

    @property
    def all_fail_alike(self) -> bool:
        """Whether several devices are broken and all for one reason, which may be the job's."""
        return not self.done and len(self.reasons) == 1 and self.broken > 1

    def tell_untold(self) -> None:
        """Name the devices that are broken as the first one is."""
        if not self.untold:
            return
        first = next(iter(self.reasons.values()))[0]
        verb = "is" if len(self.untold) == 1 else "are"
        where = "" if self.done else ": is it the job that is at fault?"
        sentence = f"{some(self.untold)} {verb} broken for the same reason as {first}{where}"
        self.listen({"event": "untold", "said": sentence})

    def refresh_table(self) -> None:
        """Write the table as it is by now, if it is due: a kill that nothing can be done after leaves it so."""
        begun = monotonic()
        if begun >= self.due:
            write_table(self.folder, self.devices)
            self.due = monotonic() + max(AGAIN, (monotonic() - begun) / SHARE)

    def note(self, event: dict[str, Any]) -> None:
        """Events of the workers; those of single searches are not told on."""
        if event["event"] == "failed":
            self.break_(event["run"], event["reason"])
        elif event["event"] in ("again", "cluster"):
            self.listen(event)

    def tell(self, more: dict[str, Any]) -> None:
        counts = {"of": len(self.devices), "done": self.done, "broken": self.broken, "folder": str(self.folder)}
        self.listen({"event": "devices", **counts, **more})


def sha256_of(contents: Iterable[bytes]) -> str:
    """That of the files of a device: of their own, one after the other in the order of the job."""
    return hashlib.sha256(b"".join(hashlib.sha256(content).digest() for content in contents)).hexdigest()


def in_a_line(reason: str) -> str:
    """A message and its remedy."""
    return reason.replace("\n  ", "; ")


def read(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:
        raise InputError(error.strerror or "cannot be read", where=str(path)) from None
