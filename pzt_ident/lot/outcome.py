"""What a fleet came to, read from its folder: the rows of its devices, and what stands out among them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from pzt_ident.data.notation import counted
from pzt_ident.errors import DamagedError, InputError
from pzt_ident.lot.identify import read_statement
from pzt_ident.lot.measured import unlike_others
from pzt_ident.lot.statistics import (
    FEWEST,
    Difference,
    Finding,
    Quantity,
    Trend,
    differences,
    farthest,
    out_of_line,
    trends,
)
from pzt_ident.lot.table import Row, faults_in, in_unit, missing_in, read_devices, readings_in, rows_of, some

DETERMINED = "determined"
MOST_TOLD = 5  # devices whose readings look wrong


@dataclass(frozen=True)
class Lot:
    """statement: what was asked for. rows: one a device, in the order of the names."""

    folder: Path
    statement: dict[str, Any]
    rows: list[Row]

    @cached_property
    def done(self) -> list[Row]:
        return [row for row in self.rows if row["state"] == "done"]

    @cached_property
    def broken(self) -> list[Row]:
        return [row for row in self.rows if row["state"] == "broken"]

    @cached_property
    def quantities(self) -> list[Quantity]:
        """What is compared between devices: the parameters, and what the model leaves; of the improved model where
        there is one. First those of the model as given, then those of effects, of the most devices first."""
        given = dict.fromkeys(name for row in self.done for name in row["parameters"])
        count = Counter(name for row in self.done for name in parameters_of(row))
        added = [name for name, _ in count.most_common() if name not in given]
        names = [*(name for name in given if name in count), *added]
        return [*(self._parameter(name) for name in names), *self._errors()]

    def _parameter(self, name: str) -> Quantity:
        parameters = [parameters_of(row).get(name) for row in self.done]
        shown = next(parameter["unit"] for parameter in parameters if parameter)

        def column(key: str) -> np.ndarray:
            return np.array(
                [_number(parameter and in_unit(parameter[key], parameter["unit"], shown)) for parameter in parameters]
            )

        known = np.array([bool(parameter) and is_determined(parameter) for parameter in parameters])
        return Quantity(name, shown, column("value"), column("low"), column("high"), known)

    def _errors(self) -> list[Quantity]:
        """Errors and noise are out of line where they are large, not where they are small."""
        shown = next((row["unit"] for row in self.done), "")
        quantities = []
        for name, get in ERRORS.items():
            values = np.array([_number(in_unit(get(row), row["unit"], shown)) for row in self.done])
            if np.isfinite(values).any():
                none = np.full(values.size, np.nan)
                quantities.append(Quantity(name, shown, values, none, none, np.isfinite(values), one_sided=True))
        return quantities

    @cached_property
    def columns(self) -> dict[str, list[Any]]:
        """What is known of each device that was done, by column; columns that say nothing are left out."""
        names = dict.fromkeys(name for row in self.done for name in row["columns"])
        columns = {name: [row["columns"].get(name) for row in self.done] for name in names}
        return {name: values for name, values in columns.items() if len(set(values) - {None}) > 1}

    @cached_property
    def trends(self) -> list[Trend]:
        return trends(self.quantities, self.columns)

    @cached_property
    def group_differences(self) -> list[Difference]:
        return differences(self.quantities, self.columns, len(self.done))

    @cached_property
    def findings(self) -> list[Finding]:
        """Devices out of line, the furthest first."""
        return out_of_line([row["device"] for row in self.done], self.quantities, self.trends, self.columns)

    def reach(self, quantity: Quantity) -> float:
        """How many spreads from the median chance takes one of the devices."""
        judged = sum(int(other.usable.sum()) >= FEWEST for other in self.quantities)
        return farthest(int(quantity.usable.sum()), max(judged, 1))

    @property
    def ill_fitted(self) -> list[str]:
        """The devices that the model fits worse than usual and than the noise, the worst first."""
        at_noise = {row["device"] for row in self.done if row["verdict"] == "adequate"}
        names = dict.fromkeys(finding.device for finding in self.findings if finding.of_fit)
        return [name for name in names if name not in at_noise]

    @property
    def odd(self) -> list[str]:
        """The other devices out of line, the furthest first: the model fits them, but with unusual parameters."""
        ill = set(self.ill_fitted)
        return [name for name in dict.fromkeys(finding.device for finding in self.findings) if name not in ill]

    @property
    def effects(self) -> dict[str, list[str]]:
        """The devices whose models have each effect added, the most frequent effect first."""
        return self._devices_by(lambda row: row["effects"])

    @property
    def missing(self) -> dict[str, list[str]]:
        """The devices that miss each effect, or `A or B` where their data cannot tell them apart, as `effects`."""
        return self._devices_by(missing_in)

    @property
    def faults(self) -> dict[str, list[str]]:
        """The devices by the fault of their set-up that accounts for their misfit, and its remedy, as `effects`."""
        return self._devices_by(lambda row: [f"{word}. {remedy}" for word, remedy in faults_in(row).items()])

    def _devices_by(self, words: Callable[[Row], Iterable[str]]) -> dict[str, list[str]]:
        devices: dict[str, list[str]] = {}
        for row in self.done:
            for word in words(row):
                devices.setdefault(word, []).append(row["device"])
        return dict(sorted(devices.items(), key=lambda item: -len(item[1])))

    @property
    def verdicts(self) -> dict[str, int]:
        return dict(Counter(row["verdict"] for row in self.done).most_common())

    @property
    def misread(self) -> dict[str, list[str]]:
        """What looks wrong with the readings of each device of which anything does."""
        return {row["device"]: told for row in self.done if (told := readings_in(row))}

    @cached_property
    def unlike(self) -> dict[str, list[str]]:
        """How each device was measured that was measured unlike the others."""
        return unlike_others({row["device"]: row.get("measured") or [] for row in self.done})

    def of_units(self) -> list[str]:
        """A sentence on each of the first devices that were measured unlike the others, and one on how many more."""
        unlike = "was measured unlike the others"
        lines = [f"{device} {unlike}: {'; '.join(far)}. Are the units right?" for device, far in self.unlike.items()]
        more = len(lines) - MOST_TOLD
        return [*lines[:MOST_TOLD], *[f"So were {more} more."] * (more > 0)]

    def of_readings(self) -> list[str]:
        """A sentence on each of the first devices whose readings look wrong, and one on how many more there are."""
        lines = [f"The readings of {device} look wrong: {'; '.join(told)}." for device, told in self.misread.items()]
        more = len(lines) - MOST_TOLD
        return [*lines[:MOST_TOLD], *[f"So do those of {more} more: see `readings` in the table."] * (more > 0)]

    @property
    def same_data(self) -> list[list[str]]:
        """Devices whose files are the same to the last byte."""
        by_hash: dict[str, list[str]] = {}
        for row in self.rows:
            if row.get("sha256"):
                by_hash.setdefault(row["sha256"], []).append(row["device"])
        return [names for names in by_hash.values() if len(names) > 1]

    def summary(self) -> dict[str, Any]:
        return {
            "devices": len(self.rows),
            "done": len(self.done),
            "broken": [{"device": row["device"], "reason": row["reason"]} for row in self.broken],
            "verdicts": self.verdicts,
            "effects": {effect: len(names) for effect, names in self.effects.items()},
            "missing": self.missing,
            "faults": [
                {"device": row["device"], "fault": word, "remedy": remedy}
                for row in self.done
                for word, remedy in faults_in(row).items()
            ],
            "readings": self.misread,
            "unlike": self.unlike,
            "same_data": self.same_data,
            "out_of_line": [{"device": finding.device, "reason": finding.sentence} for finding in self.findings],
        }

    def sentences(self) -> list[str]:
        """What the lot came to, in a few lines."""
        waiting = len(self.rows) - len(self.done) - len(self.broken)
        counts = [f"{len(self.done)} of {counted(len(self.rows), 'device')} identified"]
        counts += [f"{len(self.broken)} broken"] * bool(self.broken) + [f"{waiting} not done"] * bool(waiting)
        lines = [", ".join(counts) + "."]
        if self.verdicts:
            lines.append(
                "Verdicts: " + ", ".join(f"{count} {verdict}" for verdict, count in self.verdicts.items()) + "."
            )
        for effect, names in self.missing.items():
            lines.append(f"Missing in {len(names)}: {effect} ({some(names)}).")
        for fault, names in self.faults.items():
            lines.append(f"Fault of the set-up in {len(names)} ({some(names)}): {fault}")
        lines += self.of_readings() + self.of_units()
        for reason, names in (
            ("The model fits worse than usual", self.ill_fitted),
            ("Parameters out of line", self.odd),
        ):
            if names:
                lines.append(f"{reason}: {len(names)} ({some(names)}).")
        return lines


def parameters_of(row: Row) -> dict[str, Any]:
    """Those of a device's last model."""
    return row.get("improved") or row["parameters"]


def is_determined(parameter: Any) -> bool:
    """Whether the data hold a parameter; of an improved model that is whether it has an interval."""
    return parameter["verdict"] == DETERMINED if "verdict" in parameter else parameter["low"] is not None


ERRORS = {
    "identification RMSE": lambda row: (row["rmse_improved"] or row["rmse"])["identify"],
    "validation RMSE": lambda row: (row["rmse_improved"] or row["rmse"])["validate"],
    "noise floor": lambda row: row["noise_floor"],
}


def _number(value: Any) -> float:
    return float("nan") if value is None else float(value)


def read_lot(folder: Path) -> Lot:
    """The fleet in a folder, finished or not. Raises InputError where there is none."""
    statement = read_statement(folder)
    try:
        known = read_devices(folder)
    except DamagedError:
        remedy = f"`pzt-ident resume {folder}` goes on with it"
        raise InputError(
            "the fleet has not been begun, or its devices.json is damaged", where=str(folder), remedy=remedy
        ) from None
    return Lot(folder, statement, list(rows_of(folder, known)))
