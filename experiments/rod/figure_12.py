"""What a distributed rod differs from a lumped one by, and what its time stepping: Smith et al., Fig. 12.

python -m experiments.rod.figure_12
"""

from __future__ import annotations

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

from experiments.simulate import Array, keep, named, simulate
from experiments.tables import table
from pzt_ident.model.registry import blocks

PRINTED = {"density": 7600.0, "area": 2.5e-5, "length": 0.02, "modulus": 7e10, "viscosity": 5e6}
PRINTED |= {"end_mass": 4.015, "end_damping": 440.0, "end_stiffness": 8.49e-5}
REPAIRED = PRINTED | {"viscosity": 1.2125e8, "end_mass": 4.2062}
RODS = {"Table 1, eq. 22": PRINTED, "repaired": REPAIRED}
LOOP = {"bouc_wen.gain": 1.55e-8, "bouc_wen.alpha": 0.5, "bouc_wen.beta": 3e-4, "bouc_wen.gamma": 1e-4}
"""m per V/m, 1, m/V, m/V: a loop of some 100 um over 0 to 8 kV/m, as in Fig. 3."""
RATES = ((0.279, 1e-3), (0.5, 1e-3), (1.0, 1e-3), (27.9, 1e-4))  # Hz, s


def one_element(rod: dict[str, float]) -> dict[str, float]:
    """Eq. 22 as a rod of one element without mass of its own, to be stepped by the trapezoid too."""
    mass = rod["density"] * rod["area"] * rod["length"] + rod["end_mass"]
    return rod | {"density": 1e-9, "end_mass": mass}


def field(hertz: float, dt: float) -> Array:
    """Four periods of a sine from 0 to 8 kV/m."""
    return 4000 * (1 - np.cos(2 * np.pi * hertz * dt * np.arange(round(4 / (hertz * dt)))))


def end(word: str, rod: dict[str, float], hertz: float, dt: float, **settings: int) -> Array:
    chain = ["bouc_wen", blocks[word].make(**settings)]
    return simulate(chain, LOOP | named(word, rod), field(hertz, dt), dt)


def differences(rod: dict[str, float], hertz: float, dt: float) -> list[Array]:
    """Distributed less lumped by the same trapezoid, by trapezoid less exact, both exact; two elements less eight."""
    distributed, exact = end("rod_trapezoid", rod, hertz, dt), end("rod", rod, hertz, dt)
    lumped = end("lumped_rod", rod, hertz, dt)
    return [
        distributed - end("rod_trapezoid", one_element(rod), hertz, dt, elements=1),
        distributed - lumped,
        exact - lumped,
        end("rod", rod, hertz, dt, elements=2) - exact,
    ]


def text() -> str:
    header = ["rod", "Hz", "step [ms]", "same trapezoid [m]", "trapezoid, lumped exact [m]"]
    header += ["both exact [m]", "2 and 8 elements [m]"]
    rows = [
        [name, hertz, 1e3 * dt, *(f"{np.abs(each).max():.1e}" for each in differences(rod, hertz, dt))]
        for name, rod in RODS.items()
        for hertz, dt in RATES
    ]
    return table(header, rows)


def draw() -> plt.Figure:
    figure, (left, middle, right) = plt.subplots(1, 3, figsize=(11, 3.3), layout="constrained")
    for hertz, dt in (RATES[0], RATES[-1]):
        drive, loop = field(hertz, dt), end("rod", REPAIRED, hertz, dt)
        left.plot(drive / 1e3, 1e6 * loop, linewidth=1, label=f"{hertz:g} Hz")
    left.set(xlabel="field [kV/m]", ylabel="displacement of the end [µm]", title="the rod behind Bouc-Wen (repaired)")
    left.legend(frameon=False)
    for axes, (hertz, dt) in ((middle, RATES[0]), (right, RATES[2])):
        same, stepped, _, _ = differences(REPAIRED, hertz, dt)
        time = dt * np.arange(same.size)
        axes.plot(time, stepped, linewidth=0.8, label="trapezoid less exact")
        axes.plot(time, same, linewidth=0.8, label="the same trapezoid")
        for limit in (-5e-10, 5e-10):
            axes.axhline(limit, color="0.6", linewidth=0.8, linestyle=":")
        axes.set(xlabel="time [s]", ylabel="distributed less lumped [m]", title=f"{hertz:g} Hz, {1e3 * dt:g} ms")
    middle.legend(frameon=False, loc="lower right")
    return figure


if __name__ == "__main__":
    keep("rod", "figure_12", draw(), text())
