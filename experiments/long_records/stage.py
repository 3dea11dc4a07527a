"""Long records of a virtual stage, and the problem of finding its parameters again."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import numpy as np
from numpy.typing import NDArray

from pzt_ident.data.record import Record
from pzt_ident.engine.simulator import simulate
from pzt_ident.model.chain import Chain
from pzt_ident.model.registry import blocks
from pzt_ident.search.problem import Problem

Array = NDArray[np.float64]

RATE, NOISE = 1e3, 5e-9
WORDS = ("bouc_wen", "lumped")
TRUTH = {
    "bouc_wen.gain": 8.1947e-8,
    "bouc_wen.alpha": 0.5590,
    "bouc_wen.beta": 0.0148,
    "bouc_wen.gamma": 0.0552,
    "lumped.mass": 0.1566,
    "lumped.damping": 5.0,
    "lumped.stiffness": 7.0028e7,
}
BOUNDS = {  # Lin & Lin (2012), Table 2, X axis
    "bouc_wen.gain": (0, 0.5),
    "bouc_wen.alpha": (0, 1),
    "bouc_wen.beta": (0, 1),
    "bouc_wen.gamma": (0, 1),
    "lumped.mass": (0.15, 0.17),
    "lumped.damping": (0, 10),
    "lumped.stiffness": (7e7, 8e7),
}
AXES = "xyz"


def drive(samples: int, axis: int, record: int) -> Array:
    """A cosine from 0 V whose amplitude wanders, another one for each axis and record, V."""
    t = np.arange(samples) / RATE
    size = 40 + 25 * np.sin(2 * np.pi * (0.013 + 0.004 * axis) * t + record)
    return size * (1 - np.cos(2 * np.pi * (1 + 0.1 * axis) * t))


def model(axes: int) -> Chain:
    return Chain([blocks[word] for word in WORDS], list(AXES[:axes]), list(range(axes)))


def write(folder: Path, samples: int, records: int, axes: int) -> None:
    """The measurement, `samples` in all records together, a stretch of some seconds at a time."""
    chain = model(axes)
    theta = np.array([[TRUTH[f"{entry.block.name}.{entry.word}"] for entry in chain.entries]])
    for number in range(records):
        u = np.array([drive(samples // records, axis, number) for axis in range(axes)])
        y = simulate(chain, Record("r", "identify", 1 / RATE, u, np.zeros_like(u), axes=tuple(AXES[:axes])), theta)[0]
        y += np.random.default_rng(number).normal(0, NOISE, y.shape)
        np.save(folder / f"u{number}.npy", u)
        np.save(folder / f"y{number}.npy", y)


def read(folder: Path, records: int, axes: int) -> list[Record]:
    units = {"axes": tuple(AXES[:axes]), "drive_units": ("V",) * axes, "response_units": ("um",) * axes}
    return [
        Record(f"r{i}", "identify", 1 / RATE, np.load(folder / f"u{i}.npy"), np.load(folder / f"y{i}.npy"), **units)
        for i in range(records)
    ]


def density(folder: Path, records: int) -> Problem:
    """A free density of plays, 23 numbers that are solved for, and an interaction field, which is searched for."""
    block = blocks["homogenized_energy"].make(density="free")
    known = {"poled": 0.0, "bias": 0.0, "reach": 60.0}
    specs = {f"homogenized_energy.{word}": SimpleNamespace(bounds=None, value=value) for word, value in known.items()}
    return Problem(Chain([block], ["x"], [0]), read(folder, records, 1), specs)


def problem(folder: Path, records: int, axes: int, free: int) -> Problem:
    """The first `free` parameters are searched for, the others are known."""
    chain, specs = model(axes), {}
    for i, entry in enumerate(chain.entries):
        word = f"{entry.block.name}.{entry.word}"
        size = 1e-6 if entry.word == "gain" else 1
        fixed = SimpleNamespace(bounds=None, value=TRUTH[word] / size)
        specs[entry.name] = SimpleNamespace(bounds=BOUNDS[word], value=None) if i < free else fixed
    return Problem(chain, read(folder, records, axes), specs)
