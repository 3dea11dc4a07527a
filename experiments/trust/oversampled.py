"""Smooth records that are sampled many times more often than what is in them asks for, so that every second sample
tells the same physics."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.signal import lfilter

from experiments.coverage.stage import bouc_wen, displacement
from experiments.trust.good import TRUTH, Array, Columns

RATE, SAMPLES, FINER = 8000.0, 1600, 4
NOISE = 0.01  # um
MECHANICS = {"stiffness": 3e5, "damping": 60.0}  # N/m, N s/m
Stage = Callable[[Array, float], Array]
"""The displacement, um, under a drive, V, of so many seconds between samples."""


def drive(seed: int, use: str) -> Array:
    """Tones from 10 to 150 Hz about 50 V, faded in from a rest, FINER than it is recorded."""
    rng = np.random.default_rng([seed, use == "validate"])
    t = np.arange(FINER * SAMPLES) / (FINER * RATE)
    pitches = np.geomspace(10, 150, 6) * rng.uniform(0.9, 1.1, 6)
    wave = sum(np.sin(2 * np.pi * pitch * t + rng.uniform(0, 6.28)) / np.sqrt(pitch) for pitch in pitches)
    rise = 0.5 - 0.5 * np.cos(np.pi * np.clip((t - 0.02) / 0.05, 0, 1))
    return rise * (50 + 45 * wave / np.abs(wave).max())


def record(seed: int, use: str, stage: Stage) -> Columns:
    u = drive(seed, use)
    noise = np.random.default_rng([seed, 7, use == "validate"]).standard_normal(SAMPLES)
    x = stage(u, 1 / (FINER * RATE))[::FINER] + NOISE * noise
    return {"time [s]": np.arange(SAMPLES) / RATE, "u [V]": u[::FINER], "x [um]": x}


def coupled_record(seed: int, use: str) -> Columns:
    """Of two axes, each of which moves the other one."""
    x, y = record(seed, use, plain), record(seed + 500, use, plain)
    own, other = x["x [um]"], y["x [um]"]
    return x | {"x [um]": own + 0.02 * other, "v [V]": y["u [V]"], "y [um]": other - 0.03 * own}


def with_mechanics(u: Array, dt: float) -> Array:
    return displacement(u, dt, TRUTH | MECHANICS)


def plain(u: Array, dt: float) -> Array:
    return bouc_wen(u, **TRUTH)


def with_quadratic_gain(u: Array, dt: float) -> Array:
    x = plain(u, dt)
    return x + 0.02 * x**2


def with_lag(u: Array, dt: float) -> Array:
    return first_order(plain(u, dt), dt, 1e-3)


def with_creep(u: Array, dt: float) -> Array:
    x = plain(u, dt)
    return x + 0.15 * first_order(x, dt, 0.05)


def first_order(x: Array, dt: float, tau: float) -> Array:
    stay = np.exp(-dt / tau)
    return lfilter([1 - stay], [1, -stay], x)


HIDDEN: dict[str, Stage] = {
    "nothing": plain,
    "a quadratic gain": with_quadratic_gain,
    "a lag": with_lag,
    "creep": with_creep,
}


def step_error(u: Array, stage: Stage) -> float:
    """Standard deviation of what becomes of a response where it is simulated from every second sample of a drive."""
    return float(np.std(stage(u[::2], 2 / RATE) - stage(u, 1 / RATE)[::2]))
