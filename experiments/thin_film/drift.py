"""What the drift of the charge is, and whether reversal curves wipe out what went before: tables and figure of README.

python -m experiments.thin_film.drift
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from experiments.tables import number, table

Array = NDArray[np.float64]
OUT = Path(__file__).parents[2] / "results" / "reference" / "thin_film"
FILES = {
    "B, 5 V": "RTWhiteB_FORC/RTWhiteB 0Hz 5V 1Average Table1.tsv",
    "A, 7 V": "RTWhiteA_FORC/RT WhiteA 0Hz 7V 1Average Table2.tsv",
}
AREA = 1e-4  # cm^2


class Curves(NamedTuple):
    """Time in s, voltage, current in A, charge in uC/cm2, and the samples of saturation, at which every curve begins
    and ends."""

    time: Array
    voltage: Array
    current: Array
    charge: Array
    tops: list[int]

    @property
    def cycles(self) -> list[slice]:
        return [slice(a, b + 1) for a, b in pairwise(self.tops)]


def load(name: str) -> Curves:
    path = Path(os.environ["PZT_IDENT_DATA"]) / "thinfilm_forc_rate" / FILES[name]
    time, voltage, current, charge = np.loadtxt(
        path, delimiter="\t", skiprows=1, usecols=(0, 1, 3, 4), encoding="latin-1"
    ).T
    high = np.flatnonzero(voltage > 0.97 * voltage.max())
    groups = np.split(high, np.flatnonzero(np.diff(high) > 3) + 1)
    tops = [int(group[np.argmax(voltage[group])]) for group in groups]
    return Curves(time, voltage, current, charge, tops)


def closures(curves: Curves) -> tuple[Array, Array, Array]:
    """Of each cycle from saturation to saturation: its charge, which a capacitor gives back, and the integrals over
    time of one and of the voltage."""
    t, v, q = curves.time, curves.voltage, curves.charge
    rows = [(q[own][-1] - q[own][0], t[own][-1] - t[own][0], np.trapezoid(v[own], t[own])) for own in curves.cycles]
    return tuple(np.array(rows).T)  # type: ignore[return-value]


def explained(charge: Array, columns: Sequence[Array]) -> tuple[Array, float]:
    """Amounts of least squares, and what they leave, rms."""
    basis = np.array(columns).T
    amounts = np.linalg.lstsq(basis, charge, rcond=None)[0]
    return amounts, float(np.sqrt(np.mean((charge - basis @ amounts) ** 2)))


def corrected(curves: Curves, slope: float) -> Array:
    """The charge without what flows in proportion to the voltage; slope in uC/cm2/(V s)."""
    steps = np.diff(curves.time) * (curves.voltage[1:] + curves.voltage[:-1]) / 2
    return np.asarray(curves.charge - slope * np.concatenate([[0], np.cumsum(steps)]))


def falling(curves: Curves, charge: Array, low: float) -> tuple[Array, Array]:
    """Voltages from just below saturation down to `low`, and the charge lost since saturation on the way down there,
    one row for each cycle that comes as far."""
    voltages, found = np.linspace(0.9 * curves.voltage.max(), low, 60), []
    for own in curves.cycles:
        v, q = curves.voltage[own], charge[own] - charge[own][0]
        bottom = int(np.argmin(v))
        if v[bottom] < low:
            found.append(np.interp(voltages, v[bottom::-1], q[bottom::-1]))
    return voltages, np.array(found)


def text() -> str:
    drifts, wiped = [], []
    for name in FILES:
        curves = load(name)
        charge, seconds, volts = closures(curves)
        (slope,), left = explained(charge, [volts])
        _, constant = explained(charge, [seconds])
        both, least = explained(charge, [volts, seconds])
        rms = np.sqrt(np.mean(charge**2))
        drifts.append([name, *(number(value, 3) for value in (rms, constant, left, least, slope, *both))])
        drifts[-1].append(number(1e-3 / (slope * AREA), 3))
        for what, used in (("as measured", curves.charge), ("corrected", corrected(curves, slope))):
            rows = falling(curves, used, 0.0)[1]
            ends = np.array([used[own][-1] - used[own][0] for own in curves.cycles])
            cells = (np.std(rows, axis=0).max(), np.abs(ends).max(), np.ptp(used[curves.cycles[-1]]))
            wiped.append([f"{name}, {what}", len(rows), *(number(value, 3) for value in cells)])
    header = ["film", "charge left over a cycle, rms [uC/cm2]", "less a constant current", "less one that follows V"]
    header += ["less both", "slope [uC/cm2/(V s)]", "with both: slope", "constant [uC/cm2/s]", "as a resistor [GOhm]"]
    said = ["film", "cycles below 0 V", "spread of their falls to 0 V [uC/cm2]", "largest not closed", "of a loop"]
    return "\n\n".join([table(header, drifts), table(said, wiped)])


def figure() -> None:
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    fig, axes = plt.subplots(1, 3, figsize=(180 / 25.4, 70 / 25.4), layout="constrained")
    for name, colour in zip(FILES, ("#D55E00", "#0072B2"), strict=True):
        charge, seconds, volts = closures(load(name))
        mean = volts / seconds
        (slope,), _ = explained(charge, [volts])
        axes[0].plot(mean, charge / seconds, "o", ms=3, color=colour, label=name)
        axes[0].plot(mean, slope * mean, color=colour, lw=1)
    curves = load("B, 5 V")
    charge, _, volts = closures(curves)
    (slope,), _ = explained(charge, [volts])
    for place, used, title in (
        (axes[1], curves.charge, "B as measured"),
        (axes[2], corrected(curves, slope), "B corrected"),
    ):
        place.plot(curves.voltage, used, color="0.3", lw=0.6)
        place.set_title(title, fontsize=9)
        place.set_xlabel("V (V)", fontsize=8)
        place.set_ylabel("P (µC/cm²)", fontsize=8)
    axes[0].set_xlabel("mean voltage of the cycle (V)", fontsize=8)
    axes[0].set_ylabel("drift (µC/cm²/s)", fontsize=8)
    axes[0].legend(fontsize=7, frameon=False)
    for place in axes:
        place.tick_params(labelsize=7)
        place.grid(alpha=0.25, lw=0.5)
    OUT.mkdir(parents=True, exist_ok=True)
    for kind in ("svg", "pdf", "png"):
        fig.savefig(OUT / f"drift.{kind}", dpi=160)


if __name__ == "__main__":
    figure()
    found = text()
    (OUT / "drift.md").write_text(found + "\n", encoding="utf-8")
    print(found)
