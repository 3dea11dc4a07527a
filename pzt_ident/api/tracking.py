"""How well a stage follows a reference: by a line, by its inverse, and with a controller around it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from pzt_ident.api.arguments import Array, Signals, path_of, writable
from pzt_ident.api.drive import Followed, drive, limits_of, middles, reference_of
from pzt_ident.api.printed import Noted
from pzt_ident.api.record import Record
from pzt_ident.api.tuning import substeps, tune
from pzt_ident.control.identified import Identified
from pzt_ident.control.loop import PI, Tracking, closed_loop
from pzt_ident.data.notation import quantity
from pzt_ident.data.units import factor
from pzt_ident.errors import InputError
from pzt_ident.model.block import Coupling

if TYPE_CHECKING:
    from matplotlib.figure import Figure

OPEN, ALONE, INVERSE, LOOP, MEASURED = (
    "open loop",
    "feedforward, each axis alone",
    "feedforward",
    "feedforward and PI",
    "measured",
)


@dataclass(frozen=True)
class Way(Followed):
    """One way to follow: displacement, error (displacement minus reference) and drive by axis, in the units of the
    data; the root mean square of the error at each frequency of the comparison."""

    drive: Mapping[str, Array]
    displacement: Mapping[str, Array]
    error: Mapping[str, Array]
    spectrum: Mapping[str, Array]


@dataclass(frozen=True, repr=False)
class Comparison(Noted):
    """Ways to follow one reference, by name, on the virtual stage: the identified model with a drive that is held from
    sample to sample. gains: of the PI controller, (Kp, Ki) by axis in drive per response, per second."""

    t: Array
    frequency: Array
    reference: Mapping[str, Array]
    ways: Mapping[str, Way]
    gains: Mapping[str, tuple[float, float]]
    drive_units: Mapping[str, str]
    units: Mapping[str, str]
    notes: tuple[str, ...]

    @property
    def facts(self) -> dict[str, Any]:
        """What `control.json` holds."""
        return {
            "units": dict(self.units),
            "drive_units": dict(self.drive_units),
            "ways": {name: {"rmse": way.rmse, "peak": way.peak} for name, way in self.ways.items()},
            "gains": {axis: {"kp": kp, "ki": ki} for axis, (kp, ki) in self.gains.items()},
            "notes": list(self.notes),
        }

    def save(self, folder: str | Path) -> Path:
        """Write control.json, control.csv with all signals, and tracking.svg and .pdf into a folder."""
        from pzt_ident.files import replaced, write_columns, write_json
        from pzt_ident.report.control_figures import tracking_files

        folder = path_of(folder, "save")
        with writable(folder):
            folder.mkdir(parents=True, exist_ok=True)
            write_json(folder / "control.json", self.facts)
            write_columns(folder / "control.csv", self._columns())
            for name, content in tracking_files(self).items():
                with replaced(folder / name) as new:
                    new.write_bytes(content)
        return folder

    def plot(self, width: float = 180) -> Figure:
        """Reference and displacement, errors over time, and their spectra, a row an axis. width: mm."""
        from pzt_ident.api.drawing import shown
        from pzt_ident.report.control_figures import tracking_plate

        return shown(tracking_plate(self), width)

    def _columns(self) -> dict[str, Array]:
        columns = {"time [s]": self.t}
        for axis, reference in self.reference.items():
            columns[f"{axis}, reference [{self.units[axis]}]"] = reference
            for name, way in self.ways.items():
                columns[f"{axis}, {name} [{self.units[axis]}]"] = way.displacement[axis]
                if axis in way.drive:
                    columns[f"u_{axis}, {name} [{self.drive_units[axis]}]"] = way.drive[axis]
        return columns

    def _table(self) -> tuple[list[str], list[list[str]]]:
        rows = [
            [axis, name, *(quantity(error[axis], unit) for error in (way.rmse, way.peak))]
            for axis, unit in self.units.items()
            for name, way in self.ways.items()
        ]
        return ["axis", "way", "RMSE", "largest error"], rows


def control(
    identified: Identified,
    t: ArrayLike | str | Record,
    reference: Signals | None = None,
    *,
    measured: Record | None = None,
    delay: int = 1,
    count: float = 0.0,
    kp: float | None = None,
    ki: float | None = None,
    limits: tuple[float, float] | None = None,
    slew: float | None = None,
    **options: Any,
) -> Comparison:
    """How well the stage follows a reference: in open loop, by its inverse, with each axis inverted alone, and with a
    PI controller around the inverse, at the rate of the reference.

    t, reference, limits, slew, options: see `drive`. measured: a record of the displacement that the stage took, put
    beside them, its mean error taken off. delay: samples from a reading to the drive that answers it. count: of the
    sensor, in the unit of the response. kp, ki: gains of every axis; those of `tune` unless given.
    """
    if (kp is None) != (ki is None):
        raise InputError("one gain without the other", where="kp, ki", remedy="give both, or none to have them tuned")
    wanted, dt, stamps = reference_of(identified, t, reference)
    follow = Following(identified, wanted, dt, delay, count, limits, slew)
    best = drive(identified, t, reference, limits=limits, slew=slew, **options)
    feedforward = follow.in_si(best.drive)
    ways = {OPEN: follow.by(follow.line(feedforward))}
    if any(issubclass(block, Coupling) for block in identified.chain.blocks) and len(identified.axes) > 1:
        alone = drive(identified, t, reference, limits=limits, slew=slew, **(options | {"decoupled": False}))
        ways[ALONE] = follow.by(follow.in_si(alone.drive))
    ways[INVERSE] = follow.by(feedforward)
    notes, gains = list(best.notes), {}
    try:
        gains = follow.gains(kp, ki)
        ways[LOOP] = follow.by(feedforward, gains)
    except InputError as error:
        notes.append(f"without PI: {error.where}: {error.message}; {error.remedy}")
    by_name = {name: follow.in_units(tracking) for name, tracking in ways.items()}
    if measured is not None:
        by_name[MEASURED] = follow.of(measured, stamps)
    frequency = ways[OPEN].spectrum[0]
    units = best.drive_units, best.units
    return Comparison(stamps, frequency, best.reference, by_name, gains, *units, tuple(notes))


class Following:
    """One reference (axes, samples) in SI units, and the virtual stage that is to follow it."""

    def __init__(
        self,
        identified: Identified,
        wanted: Array,
        dt: float,
        delay: int,
        count: float,
        limits: tuple[float, float] | None,
        slew: float | None,
    ) -> None:
        self.identified, self.wanted, self.dt, self.delay = identified, wanted, dt, delay
        self.steps = substeps(1 / dt)
        self.stage = identified.stage(dt / self.steps)
        self.limits = limits_of(identified, limits, slew)
        self.counts = np.array([count * identified.scale(place)[1] for place in range(len(wanted))])

    def in_si(self, drives: Mapping[str, Array]) -> Array:
        """Drives of every axis (axes, samples); of one that is not measured as given."""
        signals = self.wanted.copy()
        for place, axis in enumerate(self.identified.chain.axes):
            if axis in drives:
                signals[place] = drives[axis] * factor(self.identified.drive_units[place])
        return signals

    def line(self, drives: Array) -> Array:
        """The drive of an open loop: the reference over the slope of a line through zero, displacement over drive."""
        straight = drives.copy()
        for place in self.identified.outputs:
            slope = drives[place] @ self.wanted[place] / (drives[place] @ drives[place] or 1.0)
            straight[place] = self.wanted[place] / (slope or 1.0)
        return self.limits.clip(straight, self.dt)

    def gains(self, kp: float | None, ki: float | None) -> dict[str, tuple[float, float]]:
        if kp is not None and ki is not None:
            return dict.fromkeys(self.identified.axes, (kp, ki))
        tuning = tune(self.identified, 1 / self.dt, self.delay)
        return {axis: (tuning[axis].kp, tuning[axis].ki) for axis in self.identified.axes}

    def by(self, feedforward: Array, gains: Mapping[str, tuple[float, float]] | None = None) -> Tracking:
        """The stage under a feedforward that is held from sample to sample, with a PI controller around it."""
        scales = np.zeros((2, len(self.wanted)))
        for place, axis in enumerate(self.identified.chain.axes):
            if axis in (gains or {}):
                drive, response = self.identified.scale(place)
                scales[:, place] = np.array(gains[axis]) * drive / response  # type: ignore[index]
        options: dict[str, Any] = {"substeps": self.steps, "delay": self.delay, "quantum": self.counts}
        return closed_loop(self.stage, self.wanted, PI(*scales), middles(feedforward), limits=self.limits, **options)

    def in_units(self, tracking: Tracking) -> Way:
        def by_axis(rows: Array, kind: int) -> dict[str, Array]:
            model = self.identified
            return {model.chain.axes[place]: rows[place] / model.scale(place)[kind] for place in model.outputs}

        responses = tracking.displacement, tracking.error, tracking.spectrum[1]
        return Way(by_axis(tracking.drive, 0), *(by_axis(rows, 1) for rows in responses))

    def of(self, measured: Record, stamps: Array) -> Way:
        """What a record of the stage has at the times of the reference, without its mean error."""
        rows, dt, times = reference_of(self.identified, measured, None)
        moved = np.array([np.interp(stamps - stamps[0], times - times[0], row) for row in rows])
        error = moved - self.wanted
        error -= error.mean(axis=1, keepdims=True)
        if (times[-1] - times[0]) < (stamps[-1] - stamps[0]) - max(dt, self.dt):
            raise InputError("is shorter than the reference", where="record", remedy="record all of it")
        way = self.in_units(Tracking(self.dt, self.wanted, self.wanted + error, rows, np.zeros(rows.shape)))
        return Way({}, way.displacement, way.error, way.spectrum)
