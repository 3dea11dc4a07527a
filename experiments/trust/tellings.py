"""One measurement told in other words: other units, other names, another order, another clock, every second sample."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from experiments.trust.good import Array, Columns, table

JOB = """\
name: told
records:
{records}
channels:
  time: "{time}"
  axes:
{axes}
{model}optimizers:
  - {{name: pso, population: 30, generations: 40}}
seed: {seed}
"""
USES = {"a": "identify", "b": "validate", "c": "identify"}
"""Of the records of a job."""
AXES = {"x": ("u [V]", "x [um]"), "y": ("v [V]", "y [um]")}
"""Columns of the drive and of the response of an axis."""
PLAIN_UNITS = ("s", "V", "um")
SI = {"s": 1.0, "ms": 1e-3, "V": 1.0, "kV": 1e3, "mV": 1e-3, "um": 1e-6, "m": 1.0, "nm": 1e-9, "": 1.0, "1": 1.0}


@dataclass(frozen=True)
class Telling:
    """units: of time, drives and responses. columns, axes: other names. backwards: `records` or `axes`. every: of so
    many samples one is told. clock: the time of the first sample, s, which rounds no other to more than 1e-11 s."""

    name: str
    units: tuple[str, str, str] = PLAIN_UNITS
    columns: Mapping[str, str] = field(default_factory=dict)
    axes: Mapping[str, str] = field(default_factory=dict)
    backwards: str = ""
    every: int = 1
    clock: float = 0.0

    def header(self, plain: str) -> str:
        word, unit = plain.rstrip("]").split(" [")
        return f"{self.columns.get(word, word)} [{self.units[PLAIN_UNITS.index(unit)]}]"

    def values(self, plain: str, values: Array) -> Array:
        old, new = (header.rstrip("]").split(" [")[1] for header in (plain, self.header(plain)))
        begun = self.clock if old == "s" else 0.0
        return (begun + values[:: self.every]) * (SI[old] / SI[new])

    def write(self, folder: Path, records: Mapping[str, Columns], model: str, seed: int) -> Path:
        """A job and its records into a new folder, which is returned. model: further lines of the job."""
        folder.mkdir(parents=True)
        for name, columns in records.items():
            told = {self.header(header): self.values(header, values) for header, values in columns.items()}
            (folder / f"{name}.csv").write_text(table(told), encoding="utf-8")
        axes = [
            f'    {self.axes.get(axis, axis)}: {{drive: "{self.header(drive)}", response: "{self.header(response)}"}}'
            for axis, (drive, response) in AXES.items()
            if all(response in columns for columns in records.values())
        ]
        lines = [f"  - {{file: {name}.csv, use: {USES[name]}}}" for name in records]
        job = JOB.format(
            records="\n".join(lines[::-1] if self.backwards == "records" else lines),
            time=self.header("time [s]"),
            axes="\n".join(axes[::-1] if self.backwards == "axes" else axes),
            model=model,
            seed=seed,
        )
        (folder / "job.yaml").write_text(job, encoding="utf-8")
        return folder


PLAIN = Telling("plain")
ALL_UNITS = Telling("kV, m and ms", ("ms", "kV", "m"))
RECORDS_BACKWARDS = Telling("records in another order", backwards="records")
AXES_BACKWARDS = Telling("axes in another order", backwards="axes")
OTHERWISE = (
    Telling("kV", ("s", "kV", "um")),
    Telling("mV", ("s", "mV", "um")),
    Telling("m", ("s", "V", "m")),
    Telling("nm", ("s", "V", "nm")),
    Telling("ms", ("ms", "V", "um")),
    ALL_UNITS,
    RECORDS_BACKWARDS,
    Telling("an axis of another name", axes={"x": "piezo"}),
    Telling("a clock that has run for hours", clock=2.0**15),
    Telling("columns of other names", columns={"time": "t", "u": "drive", "x": "path"}),
)
OF_TWO_AXES = (
    ALL_UNITS,
    RECORDS_BACKWARDS,
    AXES_BACKWARDS,
    Telling("axes of other names", axes={"x": "z"}),
)
THINNED = Telling("every second sample", every=2)
