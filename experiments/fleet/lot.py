"""A lot as it comes from production, by NumPy and SciPy alone: stages of one kind that vary, at several temperatures,
some out of line, some with an effect that the job does not have, some with files that are broken."""

from __future__ import annotations

import csv
import json
from collections.abc import Iterator
from datetime import date, timedelta
from pathlib import Path
from typing import Any

import numpy as np

from experiments.coverage.stage import MASS, Array, Truth, displacement

RATE, NOISE = 5000.0, 0.01  # Hz, um
MEANS = {"gain": 0.10, "alpha": 0.45, "beta": 0.035, "gamma": 0.004}
SPREADS = {"gain": 0.02, "alpha": 0.03, "beta": 0.04, "gamma": 0.2}
PER_KELVIN = 0.0015  # of the gain
JOB = """\
name: lot
records:
  - {{file: loops.csv, use: identify}}
  - {{file: tones.csv, use: validate}}
channels:
  time: "time [s]"
  axes:
    x: {{drive: "u [V]", response: "x [um]"}}
model: [bouc_wen, lumped]
parameters:
  bouc_wen.gain: {{bounds: [0.05, 0.2]}}
  bouc_wen.alpha: {{bounds: [0, 1]}}
  bouc_wen.beta: {{bounds: [0.005, 0.2]}}
  bouc_wen.gamma: {{bounds: [-0.05, 0.05]}}
  lumped.mass: {{value: {mass}}}
  lumped.stiffness: {{bounds: [1e5, 1e6]}}
  lumped.damping: {{bounds: [0, 100]}}
optimizers:
  - {{name: pso, population: {population}, generations: {generations}}}
seed: 1
"""
HIDDEN = ("creep", "quadratic_gain")
BROKEN = ("empty", "short", "text", "gap", "missing", "constant", "not text")


def write_lot(
    folder: Path,
    devices: int,
    seed: int,
    *,
    hidden: float = 0.0,
    broken: float = 0.0,
    outliers: float = 0.0,
    samples: int = 2000,
    swarm: tuple[int, int] = (70, 250),
) -> Path:
    """Write `job.yaml`, `lot.csv`, a folder a device below `lot` and, apart, `truth.json`; returns the job.

    hidden, broken, outliers: shares of the devices. swarm: particles and generations.
    """
    rng = np.random.default_rng(seed)
    drives = {"loops": loops(samples), "tones": tones(samples)}
    truths, rows = {}, []
    for number, kind in enumerate(kinds(rng, devices, hidden, broken, outliers)):
        name = f"d{number:05d}"
        facts = known(rng, number)
        truth = stage(rng, facts["temperature [K]"], kind)
        at = folder / "lot" / name
        at.mkdir(parents=True)
        for record, u in drives.items():
            x = measured(rng, u, truth, kind)
            write_record(at / f"{record}.csv", u, x)
        if kind in BROKEN:
            spoil(at / "loops.csv", kind)
        truths[name] = {"kind": kind, **truth}
        rows.append({"folder": f"lot/{name}", **facts})
    with (folder / "lot.csv").open("w", newline="") as file:
        table = csv.DictWriter(file, list(rows[0]))
        table.writeheader()
        table.writerows(rows)
    (folder / "truth.json").write_text(json.dumps(truths, indent=1))
    job = folder / "job.yaml"
    job.write_text(JOB.format(mass=MASS, population=swarm[0], generations=swarm[1]))
    return job


def kinds(rng: np.random.Generator, devices: int, hidden: float, broken: float, outliers: float) -> Iterator[str]:
    """What each device is, in an order by chance."""
    kinds = [*(HIDDEN[i % len(HIDDEN)] for i in range(round(hidden * devices)))]
    kinds += [BROKEN[i % len(BROKEN)] for i in range(round(broken * devices))]
    kinds += ["outlier"] * round(outliers * devices)
    kinds += ["plain"] * (devices - len(kinds))
    return (kinds[i] for i in rng.permutation(devices))


def known(rng: np.random.Generator, number: int) -> dict[str, Any]:
    return {
        "serial": f"PX-{1000 + number}",
        "temperature [K]": float(rng.choice([283.0, 295.0, 313.0, 333.0])),
        "date": (date(2026, 3, 2) + timedelta(days=number // 8)).isoformat(),
        "batch": "AB"[number % 2],
    }


def stage(rng: np.random.Generator, kelvin: float, kind: str) -> Truth:
    truth = {name: mean * (1 + SPREADS[name] * rng.standard_normal()) for name, mean in MEANS.items()}
    truth["gain"] *= 1 + PER_KELVIN * (kelvin - 295)
    omega, ratio = 2 * np.pi * 300 * (1 + 0.01 * rng.standard_normal()), 0.04 * (1 + 0.05 * rng.standard_normal())
    if kind == "outlier":
        truth["alpha"] *= 1.4
        omega *= 0.85
    return truth | {"stiffness": MASS * omega**2, "damping": 2 * ratio * omega * MASS}


def measured(rng: np.random.Generator, u: Array, truth: Truth, kind: str) -> Array:
    """um."""
    x = displacement(u, 1 / RATE, truth)
    if kind == "creep":
        x = x + 0.04 * lagged(x, 0.03) + 0.03 * lagged(x, 0.15)
    if kind == "quadratic_gain":
        x = x + 0.0006 * truth["gain"] * u**2
    return x + NOISE * rng.standard_normal(u.size)


def lagged(x: Array, seconds: float) -> Array:
    """What follows x with a time constant, from rest."""
    out, share = np.zeros(x.size), -np.expm1(-1 / (RATE * seconds))
    for i in range(1, x.size):
        out[i] = out[i - 1] + share * (x[i - 1] - out[i - 1])
    return out


def loops(samples: int) -> Array:
    """Triangles to falling heights, a step and a hold."""
    way = np.array([0, 100, 10, 80, 20, 60, 0, 70, 70, 70, 0.0])
    return np.interp(np.linspace(0, way.size - 1, samples), np.arange(way.size), way)


def tones(samples: int) -> Array:
    """A dozen tones up to 600 Hz about 50 V, faded in."""
    rng, t = np.random.default_rng(5), np.arange(samples) / RATE
    wave = sum(np.sin(2 * np.pi * f * t + rng.uniform(0, 6.28)) / np.sqrt(f) for f in np.geomspace(5, 600, 12))
    rise = 0.5 - 0.5 * np.cos(np.pi * np.clip(t / 0.05, 0, 1))
    return rise * (50 + 30 * wave / np.abs(wave).max())


def write_record(path: Path, u: Array, x: Array) -> None:
    rows = "\n".join(f"{i / RATE:.5f},{a:.4f},{b:.4f}" for i, (a, b) in enumerate(zip(u, x, strict=True)))
    path.write_text(f"time [s],u [V],x [um]\n{rows}\n")


def spoil(path: Path, how: str) -> None:
    lines = path.read_text().splitlines()
    middle = len(lines) // 2
    if how == "missing":
        path.unlink()
        return
    if how == "not text":
        path.write_bytes(bytes(range(256)) * 40)
        return
    spoilt = {
        "empty": [],
        "short": lines[:3],
        "text": [*lines[:middle], "0.2,ERROR,0.0", *lines[middle + 1 :]],
        "gap": [*lines[:middle], f"{lines[middle].rpartition(',')[0]},", *lines[middle + 1 :]],
        "constant": [lines[0], *(f"{line.rpartition(',')[0]},0.0" for line in lines[1:])],
    }[how]
    path.write_text("".join(f"{line}\n" for line in spoilt))
