"""Drives, and responses that follow them, for the tests of what is wrong with a measurement."""

import numpy as np

import rig

DT = 1e-2
T = np.arange(600) * DT
TRIANGLE = 50 * (1 - np.abs((T / 2) % 2 - 1))
MOTIONS = {
    "triangle": TRIANGLE,
    "sine": 40 * (1 - np.cos(3 * T)),
    "steps": 10.0 * np.floor(T),
    "rest": 0 * T,
    "ringing": 20 * np.exp(-T) * np.cos(60 * T),
    "sawtooth": 20 * (T % 1),
    "pulses": 30 * ((T % 1) < 0.05),
    "noise": np.random.default_rng(0).normal(0, 20, T.size),
}


def measured(kind, seed, noise=1e-8, step=0.0):
    """A record of a response that follows its drive, with noise and counts."""
    return followed(MOTIONS[kind], seed, noise, step)


def followed(drive, seed, noise=1e-8, step=0.0, law=lambda drive: 1e-7 * drive):
    response = law(drive) + np.random.default_rng(seed).normal(0, noise, drive.size)
    return rig.record(drive, dt=DT, response=[step * np.round(response / step) if step else response])
