"""The table of all devices: a row each, as Parquet and as CSV."""

from __future__ import annotations

import sys
from collections.abc import Collection, Iterator, Sequence
from hashlib import sha256
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import quote

from pzt_ident.data.units import factor, same_kind
from pzt_ident.errors import DamagedError
from pzt_ident.files import check_digest, damaged, read_sealed, replaced, write_sealed
from pzt_ident.lot.cells import Value
from pzt_ident.lot.dates import dates_of
from pzt_ident.lot.devices import Device

if TYPE_CHECKING:
    import pandas as pd

Row = dict[str, Any]
CSV, PARQUET = "devices.csv", "devices.parquet"
FOR_PARQUET = "pip install 'pzt-ident[parquet]'"
LONGEST = 120  # characters of a folder's name
RMSE = {"rmse": "{} RMSE", "rmse_improved": "improved {} RMSE"}


def folder_of(fleet: Path, name: str) -> Path:
    """Where the results of a device are: a folder of its own below `devices`, whatever the name. A name that no file
    system would take is put into letters that all take."""
    safe = quote(name, safe=" +,=@()[]", errors="surrogatepass") or "%"
    if len(safe) > LONGEST:
        safe = f"{safe[:LONGEST]}~{sha256(name.encode(errors='surrogatepass')).hexdigest()[:8]}"
    return fleet / "devices" / (f"%2E{safe[1:]}" if safe.startswith(".") else safe)


def read_row(folder: Path) -> Row:
    """The row of a device. Raises DamagedError where its folder holds none that is whole."""
    return read_sealed(folder / "device.json", "device", "key", "state", "reason")


def check_whole(folder: Path, row: Row) -> None:
    """Raises DamagedError where a file of a device that was done is not as it was written."""
    for name, digest in row.get("written", {}).items():
        check_digest(folder / name, digest)


def has_parquet() -> bool:
    """Whether a table is written as Parquet, too."""
    return find_spec("pyarrow") is not None


def tables_in(folder: Path) -> list[str]:
    """The files of the table of a fleet; of one that has none yet those that it will have."""
    if (folder / CSV).exists():
        return [name for name in (CSV, PARQUET) if (folder / name).exists()]
    return [CSV, *[PARQUET] * has_parquet()]


def write_devices(folder: Path, devices: Sequence[Device]) -> None:
    """Write `devices.json`: which devices there are, and what is known of them."""
    listed = [{"device": device.name, "columns": dict(device.columns), "fault": device.fault} for device in devices]
    write_sealed(folder / "devices.json", {"devices": listed})


def read_devices(folder: Path) -> list[Device]:
    """The devices, less their files. Raises DamagedError where `devices.json` does not say."""
    devices = read_sealed(folder / "devices.json", "devices")["devices"]
    try:
        return [Device(device["device"], {}, dict(device["columns"]), device.get("fault", "")) for device in devices]
    except (KeyError, TypeError, ValueError):
        raise damaged(folder / "devices.json", "lists no devices") from None


def some(names: Sequence[str], most: int = 5) -> str:
    """Names in a sentence, the first of them where there are many."""
    return ", ".join(names[:most]) + (f" and {len(names) - most} more" if len(names) > most else "")


def write_table(folder: Path, devices: Sequence[Device]) -> None:
    """Write the devices, and the table as it is by now."""
    write_devices(folder, devices)
    frame = frame_of(rows_of(folder, devices))
    if has_parquet():
        known = {name for device in devices for name in device.columns}
        with replaced(folder / PARQUET) as path:
            with_dates(frame, known).to_parquet(path, index=False, engine="pyarrow")
    else:
        (folder / PARQUET).unlink(missing_ok=True)  # an older one would say otherwise than the CSV
    with replaced(folder / CSV) as path:
        frame.to_csv(path, index=False, lineterminator="\n")


def with_dates(frame: pd.DataFrame, known: Collection[str]) -> pd.DataFrame:
    """The table with times in the columns of dates among those that were known of the devices."""
    cells = frame.astype(object).where(frame.notna(), None)
    headings = [heading for heading in frame if str(heading).removesuffix(GIVEN) in known]
    dates = {heading: found for heading in headings if (found := dates_of(cells[heading].tolist()))}
    return frame.assign(**dates)  # type: ignore[arg-type]


def rows_of(folder: Path, devices: Sequence[Device]) -> Iterator[Row]:
    """The row of each device with its columns; one that was not begun is `not done`. The fault of one that was done
    before is its reason."""
    for device in devices:
        try:
            row = read_row(folder_of(folder, device.name))
        except DamagedError:
            row = {"device": device.name, "state": "not done", "reason": ""}
        reason = device.fault if row["state"] == "done" and device.fault else row["reason"]
        yield row | {"columns": dict(device.columns), "reason": reason}


GIVEN = " (given)"  # behind the heading of a user's column that the table has itself


def frame_of(rows: Iterator[Row]) -> pd.DataFrame:
    """A line a device; numbers of all devices in the unit of the first, which stands in the heading. What is known of a
    device under a heading that the table has itself stands under that heading and ` (given)`."""
    import pandas as pd

    units: dict[str, str] = {}
    columns: dict[tuple[str, bool], list[Value]] = {}
    kinds: dict[tuple[tuple[str, bool], ...], None] = {}
    count = 0
    for count, row in enumerate(rows, 1):
        known = {(name, True): value for name, value in row["columns"].items()}
        line = {(name, False): value for name, value in line_of(row, units).items()}
        line = {DEVICE: line[DEVICE]} | known | line
        kinds.setdefault(tuple(line))
        for key, value in line.items():
            column = columns.setdefault(key, [])
            column += [None] * (count - 1 - len(column))
            column.append(sys.intern(value) if isinstance(value, str) else value)
    keys = in_order(dict.fromkeys(key for kind in sorted(kinds, key=len, reverse=True) for key in kind))
    cells = {key: of_one_kind(columns[key] + [None] * (count - len(columns[key]))) for key in keys}
    return pd.DataFrame({heading: cells[key] for key, heading in _headings(list(keys)).items()})


def in_order(keys: Collection[tuple[str, bool]]) -> list[tuple[str, bool]]:
    """The columns as a device has them, those of effects that were added by name behind them, and the last ones last:
    whatever devices there are, and in which order."""

    def is_added(key: tuple[str, bool]) -> bool:
        name = key[0].removeprefix(IMPROVED)
        return not key[1] and name != key[0] and (name, False) not in keys

    last = [key for key in keys if not key[1] and key[0] in LAST]
    added = sorted((key for key in keys if is_added(key)), key=lambda key: _place(key[0]))
    return [*(key for key in keys if key not in last and key not in added), *added, *last]


DEVICE = ("device", False)
IMPROVED = "improved "
LAST = "cpu [s]", "sha256", "folder", "reason"
CELLS = " low [", " high [", " verdict"  # of a parameter, behind that of its value


def _place(heading: str) -> tuple[str, int]:
    """The parameter of a cell, and which of its cells it is."""
    number = next((number for number, cell in enumerate(CELLS, 1) if cell in heading), 0)
    return heading.partition(CELLS[number - 1] if number else " [")[0], number


def _headings(keys: Sequence[tuple[str, bool]]) -> dict[tuple[str, bool], str]:
    """The heading of each column, no two alike."""
    taken = {name for name, given in keys if not given}
    headings = {}
    for name, given in keys:
        heading = name
        while given and heading in taken:
            heading += GIVEN
        taken.add(heading)
        headings[name, given] = heading
    return headings


def of_one_kind(cells: list[Value]) -> Any:
    """The cells of a column of a table, which has one kind: numbers as text where others are words, whole numbers as
    such where others are missing."""
    import pandas as pd

    known = [cell for cell in cells if cell is not None]
    if any(isinstance(cell, str) for cell in known):
        return [str(cell).removesuffix(".0") if isinstance(cell, int | float) else cell for cell in cells]
    return pd.array(cells, "Int64") if known and all(isinstance(cell, int) for cell in known) else cells


def line_of(row: Row, units: dict[str, str]) -> dict[str, Value]:
    """What was found, under its headings. units: that of each quantity so far, which the row adds to."""
    line: dict[str, Value] = {"device": row["device"], "state": row["state"]}
    if row["state"] != "done":
        return line | {"sha256": row.get("sha256") or None, "reason": row["reason"]}
    line |= {"verdict": row["verdict"], "effects": ", ".join(row["effects"]), "suspects": ", ".join(row["suspects"])}
    faults = faults_in(row)
    line |= {"missing": ", ".join(missing_in(row)), "faults of the set-up": ", ".join(faults)}
    line |= {"remedy of the set-up": " ".join(faults.values()), "readings": "; ".join(readings_in(row))}
    for key, heading in RMSE.items():
        for use, value in (row[key] or {}).items():
            line |= _cell(heading.format(use), "", value, row["unit"], units)
    line |= _cell("noise floor", "", row["noise_floor"], row["unit"], units)
    for name, parameter in row["parameters"].items():
        line |= _interval(name, parameter, units) | {f"{name} verdict": parameter["verdict"]}
    for name, parameter in row.get("improved", {}).items():
        line |= _interval(f"{IMPROVED}{name}", parameter, units)
        line |= {f"{IMPROVED}{name} verdict": parameter.get("verdict")}
    for amount in row.get("amounts") or []:
        line |= _cell(f"improved {amount['axis']} {amount['effect']} rms", "", amount["rms"], amount["unit"], units)
    folder = folder_of(Path(), row["device"]).as_posix()
    return line | {"cpu [s]": row["cpu_seconds"], "sha256": row["sha256"], "folder": folder, "reason": row["reason"]}


def missing_in(row: Row) -> list[str]:
    """What a device misses, or `A or B` where its data cannot tell them apart."""
    return row.get("missing") or row["effects"]


def readings_in(row: Row) -> list[str]:
    """What looks wrong with a device's readings."""
    return row.get("readings") or []


def faults_in(row: Row) -> dict[str, str]:
    """The faults of a device's set-up, and how they are mended."""
    return row.get("faults") or {}


def _interval(name: str, parameter: Row, units: dict[str, str]) -> dict[str, Value]:
    """The cells of a parameter: its value and the ends of its interval."""
    line: dict[str, Value] = {}
    for end in ("value", "low", "high"):
        line |= _cell(name, "" if end == "value" else f" {end}", parameter[end], parameter["unit"], units)
    return line


def _cell(name: str, end: str, value: float | None, unit: str, units: dict[str, str]) -> dict[str, Value]:
    shown = units.setdefault(name, unit)
    return {f"{name}{end} [{shown or '1'}]": in_unit(value, unit, shown)}


def in_unit(value: float | None, unit: str, shown: str) -> float | None:
    """A value in another unit; as it is where the two are of different kinds."""
    if value is None or unit == shown or not same_kind(unit, shown):
        return value
    return value * factor(unit) / factor(shown)
