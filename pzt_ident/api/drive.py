"""The drive under which a stage follows a reference."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from pzt_ident.api.arguments import Array, Signals, path_of, writable
from pzt_ident.api.printed import Noted
from pzt_ident.api.record import Record
from pzt_ident.api.statement import uniform
from pzt_ident.control.identified import Identified
from pzt_ident.control.inverse import GAIN, Feedforward, Inverse
from pzt_ident.control.limits import Limits
from pzt_ident.control.notes import Notes
from pzt_ident.data.notation import quantity
from pzt_ident.data.units import factor, same_kind
from pzt_ident.errors import InputError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

AGAIN = 8  # times that a drive is made again for effects that depend on its own range


class Followed:
    """Sizes of the error of each axis, displacement minus reference."""

    error: Mapping[str, Array]

    @property
    def rmse(self) -> dict[str, float]:
        """Root mean square."""
        return {axis: float(np.sqrt(np.mean(error**2))) for axis, error in self.error.items()}

    @property
    def peak(self) -> dict[str, float]:
        """Largest magnitude."""
        return {axis: float(np.abs(error).max()) for axis, error in self.error.items()}


@dataclass(frozen=True, repr=False)
class Drive(Followed, Noted):
    """The drive of each axis for a reference, and what the model does under it, each (samples,) by axis in the units
    of the data. error: displacement minus reference. notes: sentences on what this drive does not do."""

    t: Array
    drive: Mapping[str, Array]
    reference: Mapping[str, Array]
    displacement: Mapping[str, Array]
    error: Mapping[str, Array]
    drive_units: Mapping[str, str]
    units: Mapping[str, str]
    notes: tuple[str, ...]

    def save(self, path: str | Path) -> Path:
        """Write time and drive of each axis as CSV, to be played out."""
        from pzt_ident.files import write_columns

        path = path_of(path, "save")
        with writable(path):
            drives = {f"u_{axis} [{self.drive_units[axis]}]": u for axis, u in self.drive.items()}
            write_columns(path, {"time [s]": self.t} | drives)
        return path

    def plot(self, width: float = 180) -> Figure:
        """Reference, drive and error of each axis over time. width: mm."""
        from pzt_ident.api.drawing import shown
        from pzt_ident.report.control_figures import drive_plate

        return shown(drive_plate(self), width)

    def _table(self) -> tuple[list[str], list[list[str]]]:
        rows = []
        for axis, u in self.drive.items():
            ends = (quantity(float(end), self.drive_units[axis]) for end in (u.min(), u.max()))
            errors = (quantity(error[axis], self.units[axis]) for error in (self.rmse, self.peak))
            rows.append([axis, " to ".join(ends), *errors])
        return ["axis", "drive", "RMSE, predicted", "largest error"], rows


def drive(
    identified: Identified,
    t: ArrayLike | str | Record,
    reference: Signals | None = None,
    *,
    limits: tuple[float, float] | None = None,
    slew: float | None = None,
    decoupled: bool = True,
    noise_gain: float = GAIN,
    held: bool = False,
) -> Drive:
    """The drive under which a stage follows a reference, and what the model says will be left.

    t, reference: as a `Record` has time and drive, the displacement of each measured axis in the unit of its data, and
    the drive of one that is not measured, zero unless given; or t is a `Record` of these. The stage is at rest at the
    first sample. limits, slew: lowest and highest drive, and its largest change in a second, in the units of the drive;
    those of the job unless given. decoupled: make up for what acts from axis to axis. noise_gain: the most by which
    dynamics are made up for, see `control.inverse`. held: for a converter that holds each sample until the next one,
    which is late by half a sample; else the drive is linear between its samples, and so it is in what the model says.

    Raises InputError where the reference is in another unit, lacks an axis, or is not uniform in time.
    """
    if not noise_gain >= 1:
        raise InputError(f"{noise_gain:g} is no noise gain", where="noise_gain", remedy="give 1 or more, such as 10")
    wanted, dt, stamps = reference_of(identified, t, reference)
    amplifier = limits_of(identified, limits, slew)
    spans, peaks = identified.spans, identified.peaks
    largest = float(identified.peaks.max())
    for _ in range(AGAIN):
        inverse = Inverse(identified.stage(dt, spans, peaks), largest, amplifier, noise_gain, decoupled)
        feedforward = inverse(wanted)
        now = np.ptp(feedforward.drive, axis=1), np.abs(feedforward.drive).max(axis=1)
        if not depends_on_range(identified) or np.allclose(now, (spans, peaks), rtol=1e-9):
            break
        spans, peaks = now
    notes = Notes(inverse, feedforward, identified).sentences()
    if held:
        feedforward = replace(feedforward, drive=middles(feedforward.drive))
    return in_units(identified, stamps, feedforward, notes)


def middles(drive: Array) -> Array:
    """A drive (axes, samples) halfway to its next sample: held until then, it is not late."""
    return (drive + np.hstack([drive[:, 1:], drive[:, -1:]])) / 2


def depends_on_range(identified: Identified) -> bool:
    """Whether the model asks for the range of the drive of a record."""
    return any({"span", "peak"} & set(block.arguments()) for block in identified.chain.blocks)


def in_units(identified: Identified, stamps: Array, feedforward: Feedforward, notes: tuple[str, ...]) -> Drive:
    model = identified.chain
    drive_units = {model.axes[a]: identified.drive_units[a] for a in model.measured}
    units = {axis: identified.inputs[axis] for axis in identified.axes}

    def by_axis(signals: Array, units: Mapping[str, str]) -> dict[str, Array]:
        return {model.axes[a]: signals[a] / factor(units[model.axes[a]]) for a in model.measured}

    return Drive(
        stamps,
        by_axis(feedforward.drive, drive_units),
        by_axis(feedforward.reference, units),
        by_axis(feedforward.displacement, units),
        by_axis(feedforward.error, units),
        drive_units,
        units,
        notes,
    )


def reference_of(identified: Identified, t: Any, reference: Signals | None) -> tuple[Array, float, Array]:
    """The reference of every axis (axes, samples) in SI units, of one that is not measured its drive, zero unless
    given; its sample time and its time stamps."""
    model, units = identified.chain, identified.inputs
    known = ", ".join(f"{axis} in {unit}" for axis, unit in units.items())
    for axis in t.axes if isinstance(t, Record) else reference if isinstance(reference, Mapping) else ():
        if axis not in units:
            raise InputError(f"axis {axis!r} is not in the result", where="reference", remedy=f"give {known}")
    given = t if isinstance(t, Record) else Record(t, reference, drive=dict(units), name="reference")
    for axis in given.axes:
        if not same_kind(given.drive[axis], units[axis]):
            message = f"axis {axis} is in {given.drive[axis]}, not in {units[axis]}"
            raise InputError(message, where="reference", remedy=f"give it in a unit such as {units[axis]}")
    for axis in identified.axes:
        if axis not in given.axes:
            raise InputError(f"axis {axis!r} is missing", where="reference", remedy=f"give {known}")
    record = uniform(given.with_name(given.name or "reference"), given.axes)
    wanted = np.zeros((len(model.axes), record.samples))
    for place, axis in enumerate(record.axes):
        wanted[model.axes.index(axis)] = record.drive[place]
    return wanted, record.dt, record.time


def limits_of(identified: Identified, limits: tuple[float, float] | None, slew: float | None) -> Limits:
    """In SI units, of every axis; those of the job unless given."""
    stated, stated_slew = identified.limits
    low, high = limits or stated or (-np.inf, np.inf)
    fastest = slew if slew is not None else stated_slew or np.inf
    if not fastest > 0:
        raise InputError(f"{fastest:g} is no slew rate", where="slew", remedy="give drive units per second above zero")
    if not low < high:
        raise InputError(f"{low:g} to {high:g} are no limits", where="limits", remedy="give (lowest, highest)")
    units = np.array([factor(unit) for unit in identified.drive_units])
    return Limits(np.outer(units, [low, high]), units * fastest)
