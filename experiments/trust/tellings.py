"""One measurement told in other words: other units, other names, another order, every second sample."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from experiments.trust.good import Columns, table

JOB = """\
name: told
records:
{records}
channels:
  time: "{time}"
  axes:
    {axis}: {{drive: "{drive}", response: "{response}"}}
model: [{model}]
optimizers:
  - {{name: pso, population: 30, generations: 40}}
seed: {seed}
"""
USES = {"a": "identify", "b": "validate", "c": "identify"}
"""Of the records of a job."""


@dataclass(frozen=True)
class Telling:
    """scales: of the columns of a file. headers: their names there. every: of so many samples one is told."""

    name: str
    scales: tuple[float, float, float] = (1, 1, 1)
    headers: tuple[str, str, str] = ("time [s]", "u [V]", "x [um]")
    axis: str = "x"
    backwards: bool = False
    every: int = 1

    def write(self, folder: Path, records: Mapping[str, Columns], model: str, seed: int) -> Path:
        """A job and its records into a new folder, which is returned."""
        folder.mkdir(parents=True)
        for name, columns in records.items():
            values = (columns[key][:: self.every] for key in PLAIN.headers)
            told = [column * scale for column, scale in zip(values, self.scales, strict=True)]
            text = table(dict(zip(self.headers, told, strict=True)))
            (folder / f"{name}.csv").write_text(text, encoding="utf-8")
        time, drive, response = self.headers
        lines = [f"  - {{file: {name}.csv, use: {USES[name]}}}" for name in records]
        job = JOB.format(
            records="\n".join(lines[::-1] if self.backwards else lines),
            time=time,
            drive=drive,
            response=response,
            axis=self.axis,
            model=model,
            seed=seed,
        )
        (folder / "job.yaml").write_text(job, encoding="utf-8")
        return folder


PLAIN = Telling("plain")
OTHERWISE = (
    Telling("kV", (1, 1e-3, 1), ("time [s]", "u [kV]", "x [um]")),
    Telling("mV", (1, 1e3, 1), ("time [s]", "u [mV]", "x [um]")),
    Telling("m", (1, 1, 1e-6), ("time [s]", "u [V]", "x [m]")),
    Telling("nm", (1, 1, 1e3), ("time [s]", "u [V]", "x [nm]")),
    Telling("ms", (1e3, 1, 1), ("time [ms]", "u [V]", "x [um]")),
    Telling("kV, m and ms", (1e3, 1e-3, 1e-6), ("time [ms]", "u [kV]", "x [m]")),
    Telling("records in another order", backwards=True),
    Telling("an axis of another name", axis="piezo"),
    Telling("columns of other names", headers=("t [s]", "drive [V]", "path [um]")),
)
THINNED = Telling("every second sample", every=2)
