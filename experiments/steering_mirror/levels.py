"""How far a linear response goes below 400 Hz at each level of the drive, and how the gain grows with the level.

python -m experiments.steering_mirror.levels
"""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from experiments.tables import table

DATA = Path(os.environ.get("PZT_IDENT_DATA", ".")) / "fsm_piezo_mimo"
RATE, BAND, LOW = 6400.0, (2.0, 400.0), 60.0
Lines = NDArray[np.complex128]


def spectra(level: int) -> tuple[Lines, Lines, NDArray[np.float64]]:
    """Drives in V and responses in um, (lines, axes, realisations), amplitudes; Hz. Mean of both periods."""
    both = [np.load(DATA / f"{which}_{level}mV_train.npy").mean(axis=-1) for which in "uy"]
    samples = len(both[0])
    hertz = np.arange(samples // 2 + 1) * RATE / samples
    chosen = (hertz > BAND[0]) & (hertz < BAND[1])
    drive, response = (2 / samples * np.fft.rfft(each, axis=0)[chosen] for each in both)
    return drive, 1e6 * response, hertz[chosen]


def rms(lines: Lines) -> float:
    """Over time, axes and realisations, of amplitudes (lines, axes, realisations)."""
    return float(np.sqrt(np.sum(np.abs(lines) ** 2, axis=0).mean() / 2))


def main() -> None:
    rows, small = [], None
    for level in (100, 200, 300):
        drive, response, hertz = spectra(level)
        linear = response @ np.linalg.pinv(drive)
        gain = linear[hertz < LOW].mean(axis=0).real
        first, lowest = small = small or (linear, gain)
        growth = np.abs(gain).sum() / np.abs(lowest).sum() - 1
        errors = (rms(response), rms(response - linear @ drive), rms(response - first @ drive))
        rows.append([f"{level} mV", *(f"{error:.4f}" for error in errors), f"{growth:+.1%}"])
    titles = ["level", "response [um]", "own linear response leaves", "that of 100 mV leaves", "gain below 60 Hz"]
    print(table(titles, rows))


if __name__ == "__main__":
    main()
