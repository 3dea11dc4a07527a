"""Good jobs on good measurements, small ones, by NumPy alone: what is broken, killed and turned round elsewhere."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from experiments.coverage.stage import bouc_wen

Array = NDArray[np.float64]
Columns = dict[str, Array]
RATE = 500.0  # Hz
TRUTH = {"gain": 0.08, "alpha": 0.4, "beta": 0.04, "gamma": 0.005}


def measurement(seed: int, use: str, samples: int = 150) -> Columns:
    """Time, the drives of two axes and the displacement of the first, between rests."""
    rng = np.random.default_rng([seed, use == "validate"])
    heights = rng.uniform(60, 100) * np.array([0, 0, 1, 0.1, 0.8, 0.2, 0.6, 0, 0.7, 0, 0])
    u = np.interp(np.linspace(0, heights.size - 1, samples), np.arange(heights.size), heights)
    t = np.arange(samples) / RATE
    v = 20 * (1 - np.cos(2 * np.pi * 5 * t))
    x = bouc_wen(u, **TRUTH) + 0.01 * rng.standard_normal(samples)
    return {"time [s]": t, "u [V]": u.round(4), "v [V]": v.round(4), "x [um]": x.round(5)}


def table(columns: Mapping[str, Array], delimiter: str = ",") -> str:
    """As CSV."""
    rows = zip(*(values.tolist() for values in columns.values()), strict=True)
    lines = [delimiter.join(columns), *(delimiter.join(map(repr, row)) for row in rows)]
    return "\n".join(lines) + "\n"


PLAIN = """\
name: plain
records:
  - {file: a.csv, use: identify}
  - {file: b.csv, use: validate, settle: 0.02 s}
channels:
  time: "time [s]"
  axes:
    x: {drive: "u [V]", response: "x [um]"}
model: [bouc_wen]
parameters:
  bouc_wen.alpha: {bounds: [0, 1]}
optimizers:
  - {name: pso, population: 8, generations: 6}
repeats: 2
seed: 3
"""
COUPLED = """\
# Two axes, of which one is measured.
name: coupled
records:
  - file: a.csv
    use: identify
    time: [0 s, 0.25 s]
  - file: b.csv
    use: validate
    name: later
channels:
  time: "time [s]"
  axes:
    x:
      drive: "u [V]"
      response: {name: "x [um]"}
    y:
      drive: "v [V]"
model:
  - bouc_wen
  - lumped
effects: [cross_coupling]
rule_out: [encoder_cyclic_error]
shared: [lumped.mass]
parameters:
  x.bouc_wen.gain: {bounds: [0.01, 0.2]}
  lumped.mass: {value: 0.1}
optimizers:
  - name: differential_evolution
    population: 10
    generations: 4
  - name: least_squares
repeats: 1
seed: 11
stop: {evaluations: 60, target: 0.001 um}
limits: {drive: [-10, 120], slew: 4000, duration: 10}
"""
BARE = """\
name: bare
records:
  - {file: bare.txt, use: identify, sample_rate: 500 Hz, rows: [0, 100]}
  - {file: bare.txt, use: validate, sample_rate: 500 Hz, rows: [100, 150], settle: 10 ms}
channels:
  axes:
    x: {drive: {column: 1, unit: V}, response: {file: x.npy, unit: um}}
model: [prandtl_ishlinskii]
optimizers:
  - {name: rga, population: 8, generations: 5}
polish: false
seed: 5
"""
JOBS = {"plain": PLAIN, "coupled": COUPLED, "bare": BARE}


def write_good(folder: Path, seed: int, kind: str = "plain") -> Path:
    """One of the good jobs, with its measurement, into a folder; returns the job."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, use in (("a", "identify"), ("b", "validate")):
        (folder / f"{name}.csv").write_text(table(measurement(seed, use)), encoding="utf-8")
    bare = measurement(seed, "identify")
    np.savetxt(folder / "bare.txt", np.column_stack([bare["u [V]"], bare["v [V]"]]))
    np.save(folder / "x.npy", bare["x [um]"])
    job = folder / "job.yaml"
    job.write_text(JOBS[kind], encoding="utf-8")
    return job
