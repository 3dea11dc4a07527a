"""A lot as nobody would wish it: whatever lies in its folder, each entry is named once, good or broken."""

import csv
import os
from pathlib import Path
from tempfile import TemporaryDirectory

from hypothesis import given, settings
from hypothesis import strategies as st

from lot.test_devices import ONE, TWO, job, touch
from pzt_ident.errors import InputError
from pzt_ident.lot.devices import devices_of
from pzt_ident.lot.table import folder_of

LETTERS = [b"a", b"B", b"1", b" ", b"[", b"]", b"*", b"?", b"-", b"~", b"#", b",", b";", b'"', b"\\", b"%"]
LETTERS += [b"\xff", b"\n", b"\x1b", "é".encode(), "é".encode(), "漢".encode(), "\u202e".encode(), b"x.csv"]
NAMES = st.lists(st.sampled_from(LETTERS), min_size=1, max_size=4).map(b"".join).map(os.fsdecode)
CONTENTS = ["good", "none", "empty", "folder", "garbage", "pipe", "dangling", "loop", "denied", "elsewhere"]
LOTS = st.dictionaries(NAMES, st.sampled_from(CONTENTS), max_size=6)


def make(place: Path, content: str) -> None:
    """A device of one file at this place."""
    if content == "folder":
        place.mkdir()
    elif content == "pipe":
        os.mkfifo(place)
    elif content in ("dangling", "loop"):
        place.symlink_to("gone" if content == "dangling" else place.name)
    elif content != "none":
        touch(place)
        place.write_bytes({"empty": b"", "garbage": b"\0\xff\n\0,file" * 9}.get(content, place.read_bytes()))
        place.chmod(0 if content == "denied" else 0o644)


def make_folder(place: Path, content: str) -> None:
    """A device of a folder with two files, the first of which is as it is."""
    if content in ("dangling", "loop"):
        make(place, content)
    else:
        touch(place / "slow.csv")
        make(place / ("raw" if content == "elsewhere" else "loops.csv"), content)
        place.chmod(0 if content == "denied" else 0o755)


def ways(lot: dict[str, str], folders: bool) -> list[list[str]]:
    """How a user may name the devices."""
    with open("lot.csv", "w", newline="", encoding="utf-8", errors="surrogateescape") as file:
        table = csv.writer(file)
        table.writerow(["serial", "folder"])
        table.writerows([place, f"lot/{name}"] for place, name in enumerate(lot))
    expanded = [f"lot/{name}{'/' * (folders and kind not in ('dangling', 'loop'))}" for name, kind in lot.items()]
    pattern = ["lot/*/" if folders else "lot/*"]
    return [pattern] * ("*" not in lot) + [expanded, ["lot.csv"]]  # a path is taken letter by letter


@settings(max_examples=40, deadline=None)
@given(LOTS, st.booleans())
def test_each_entry_of_any_lot_is_named_once(lot, folders):
    before = Path.cwd()
    with TemporaryDirectory() as here:
        os.chdir(here)
        try:
            Path("lot").mkdir()
            for name, content in lot.items():
                (make_folder if folders else make)(Path("lot", name), content)
            lot = {name: content for name, content in lot.items() if os.path.lexists(f"lot/{name}")}
            for patterns in ways(lot, folders):
                check(patterns, lot, folders, here)
        finally:
            os.chdir(before)


def check(patterns: list[str], lot: dict[str, str], folders: bool, here: str) -> None:
    try:
        devices = devices_of(patterns, job(TWO if folders else ONE, Path(here)))
    except InputError as error:
        assert error.remedy and all(part.isprintable() for part in str(error).split("\n  "))
        kinds = {os.path.isdir(f"lot/{name}") for name in lot if os.path.exists(f"lot/{name}")}
        assert "good" not in lot.values() or len(kinds) > 1 or patterns == ["lot.csv"]  # its cells are stripped
        return
    names = [device.name for device in devices]
    assert len({folder_of(Path(), name) for name in names}) == len(names) == len(lot)
    assert all(name.isprintable() and device.fault.isprintable() for name, device in zip(names, devices, strict=True))
    for device in devices:
        assert device.fault or all(os.path.isfile(path) for path in device.files.values())
