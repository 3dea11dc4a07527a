"""A campaign by chance: the stage, two records to identify from, one that is not seen, and the noise."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.signal import lfilter

from experiments.coverage.stage import MASS, Array, Truth, displacement

RATE, SAMPLES = 5000.0, 2000
NOISE = 0.01  # um, of a stroke of some 10 um
COLOURS = ("white", "coloured", "mixture")


class Campaign(NamedTuple):
    """drives: V; readings of the first two; clean: displacements without noise, um."""

    truth: Truth
    drives: list[Array]
    readings: list[Array]
    clean: list[Array]


def draw(seed: int, colour: str) -> Campaign:
    """One seed is one stage and one set of drives, whatever the colour."""
    rng = np.random.default_rng(seed)
    truth = stage(rng)
    drives = [loops(rng), tones(rng), mixed(rng)]
    clean = [displacement(u, 1 / RATE, truth) for u in drives]
    own = np.random.default_rng([seed, COLOURS.index(colour)])
    return Campaign(truth, drives, [y + NOISE * noise(own, SAMPLES, colour) for y in clean[:2]], clean)


def stage(rng: np.random.Generator) -> Truth:
    omega, ratio = 2 * np.pi * rng.uniform(200, 400), rng.uniform(0.02, 0.06)
    truth = {"gain": rng.uniform(0.08, 0.12), "alpha": rng.uniform(0.3, 0.6)}
    truth |= {"beta": rng.uniform(0.02, 0.05), "gamma": rng.uniform(-0.01, 0.015)}
    return truth | {"stiffness": MASS * omega**2, "damping": 2 * ratio * omega * MASS}


def noise(rng: np.random.Generator, size: int, colour: str) -> Array:
    """Of unit variance. coloured: AR(1) of memory 0.9; mixture: half white, half AR(1) of memory 0.98."""
    if colour == "white":
        return rng.standard_normal(size)
    if colour == "coloured":
        return autoregressive(rng, size, 0.9)
    return np.sqrt(0.5) * (rng.standard_normal(size) + autoregressive(rng, size, 0.98))


def autoregressive(rng: np.random.Generator, size: int, memory: float) -> Array:
    run_in = int(10 / (1 - memory))
    return np.sqrt(1 - memory**2) * lfilter([1], [1, -memory], rng.standard_normal(size + run_in))[run_in:]


def loops(rng: np.random.Generator) -> Array:
    """Triangles to falling heights, from 0 V."""
    turns = [0.0, 100.0, *rng.uniform((0, 60, 10, 50), (20, 90, 40, 70)), 0.0]
    way = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(turns)))])
    return np.interp(np.linspace(0, way[-1], SAMPLES), way, turns)


def tones(rng: np.random.Generator) -> Array:
    """A dozen tones up to 600 Hz about 50 V, faded in."""
    t = np.arange(SAMPLES) / RATE
    pitches = np.geomspace(5, 600, 12) * rng.uniform(0.9, 1.1, 12)
    wave = sum(np.sin(2 * np.pi * f * t + rng.uniform(0, 6.28)) / np.sqrt(f) for f in pitches)
    rise = 0.5 - 0.5 * np.cos(np.pi * np.clip(t / 0.05, 0, 1))
    return rise * (50 + 30 * wave / np.abs(wave).max())


def mixed(rng: np.random.Generator) -> Array:
    """Slow triangles with a fast tone on them."""
    t = np.arange(SAMPLES) / RATE
    turns = [0.0, 90.0, *rng.uniform((0, 50), (40, 90)), 0.0]
    return np.interp(t, np.linspace(0, t[-1], 5), turns) + rng.uniform(2, 5) * np.sin(
        2 * np.pi * rng.uniform(20, 150) * t
    )
