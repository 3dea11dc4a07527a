"""How far a linear response goes below 400 Hz at each level of the drive, and how gain and lag grow with the level.

python -m experiments.steering_mirror.levels
"""

from __future__ import annotations

import os
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from experiments.tables import table

DATA = Path(os.environ.get("PZT_IDENT_DATA", ".")) / "fsm_piezo_mimo"
RATE, BAND, LOW = 6400.0, (2.0, 400.0), 60.0
EDGES = (2.0, 30.0, 60.0, 120.0, 200.0, 300.0, 400.0)
RAYLEIGH = 4 / (3 * np.pi)  # growth of the loss angle over that of the gain: y = a E0 E -+ a (E0^2 - E^2) / 2
Lines = NDArray[np.complex128]


def spectra(level: int, chosen: slice = slice(None)) -> tuple[Lines, Lines, NDArray[np.float64]]:
    """Drives in V and responses in um, (lines, axes, realisations), amplitudes; Hz. Mean of both periods."""
    both = [np.load(DATA / f"{which}_{level}mV_train.npy").mean(axis=-1)[..., chosen] for which in "uy"]
    samples = len(both[0])
    hertz = np.arange(samples // 2 + 1) * RATE / samples
    inside = (hertz > BAND[0]) & (hertz < BAND[1])
    drive, response = (2 / samples * np.fft.rfft(each, axis=0)[inside] for each in both)
    return drive, 1e6 * response, hertz[inside]


def rms(lines: Lines) -> float:
    """Over time, axes and realisations, of amplitudes (lines, axes, realisations)."""
    return float(np.sqrt(np.sum(np.abs(lines) ** 2, axis=0).mean() / 2))


def linear(level: int, chosen: slice = slice(None)) -> tuple[Lines, NDArray[np.float64]]:
    """Best linear response, (lines, axes, axes) in um/V; Hz."""
    drive, response, hertz = spectra(level, chosen)
    return response @ np.linalg.pinv(drive), hertz


def leaves() -> str:
    rows, small = [], linear(100)[0]
    for level in (100, 200, 300):
        drive, response, hertz = spectra(level)
        own = linear(level)[0]
        gains = [np.abs(each[hertz < LOW].mean(axis=0).real).sum() for each in (own, small)]
        errors = (rms(response), rms(response - own @ drive), rms(response - small @ drive))
        rows.append([f"{level} mV", *(f"{error:.4f}" for error in errors), f"{gains[0] / gains[1] - 1:+.1%}"])
    titles = ["level", "response [um]", "own linear response leaves", "that of 100 mV leaves", "gain below 60 Hz"]
    return table(titles, rows)


def growth(level: int, chosen: slice, low: float, high: float) -> np.complex128:
    """The response of a level over that of 100 mV in a band, one factor for all axes."""
    (small, hertz), (own, _) = linear(100, chosen), linear(level, chosen)
    inside = (hertz > low) & (hertz < high)
    return np.vdot(small[inside], own[inside]) / np.vdot(small[inside], small[inside])


def lags() -> str:
    """Growth of gain and lag; they are uncertain by half the difference of both blocks of three realisations."""
    rows = []
    for low, high in pairwise(EDGES):
        row = [f"{low:g} to {high:g}"]
        for level in (200, 300):
            one, two = (growth(level, chosen, low, high) for chosen in (slice(0, 3), slice(3, 6)))
            gains, angles = (np.array([part(one), part(two)]) for part in (np.abs, np.angle))
            lag, apart = -1e3 * angles.mean(), 1e3 * abs(np.diff(angles)[0]) / 2
            row += [f"{gains.mean() - 1:+.1%}", f"{lag:.1f} +- {apart:.1f}"]
        rows.append([*row, f"{-angles.mean() / (gains.mean() - 1):.2f}"])
    titles = ["band [Hz]", "gain at 200 mV", "lag [mrad]", "gain at 300 mV", "lag [mrad]", "lag over gain, 300 mV"]
    return table(titles, rows)


if __name__ == "__main__":
    print(leaves(), lags(), f"Rayleigh's law: {RAYLEIGH:.2f}", sep="\n\n")
